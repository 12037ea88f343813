"""Response models that worker processes can import."""

import os
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from uqfold.inputs import normal
from uqfold.problems import Problem
from uqfold.testing.counting import RowCount
from uqfold.typing import FloatArray, Model

FATAL = 2.0
"""Samples with b above this kill, hang or raise."""


def quadratic(x: FloatArray) -> FloatArray:
    return x[:, 0] + 0.5 * x[:, 1] ** 2


def deadly(x: FloatArray) -> FloatArray:
    if (x[:, 1] > FATAL).any():
        os.kill(os.getpid(), signal.SIGKILL)
    return quadratic(x)


def hanging(x: FloatArray) -> FloatArray:
    if (x[:, 1] > FATAL).any():
        time.sleep(600.0)
    return quadratic(x)


def raising(x: FloatArray) -> FloatArray:
    if (x[:, 1] > FATAL).any():
        raise ArithmeticError("too far")
    return quadratic(x)


def returning_nan(x: FloatArray) -> FloatArray:
    return np.where(x[:, 1] > FATAL, np.nan, quadratic(x))


def scalar(x: FloatArray) -> float:
    if x[1] > FATAL:
        raise ArithmeticError("too far")
    return float(x[0] + 0.5 * x[1] ** 2)


@dataclass(frozen=True)
class DeadlyOnce:
    """Kills its process the first time that each of the given batches is run."""

    folder: Path
    every: int = 3

    def __call__(self, x: FloatArray) -> FloatArray:
        mark = self.folder / f"{x[0, 0]:.17g}"
        if int(abs(x[0, 0]) * 1e6) % self.every == 0 and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return quadratic(x)


@dataclass(frozen=True)
class Uneven:
    """Takes longer for some batches than for others, so that they finish in another order."""

    seconds: float = 0.02

    def __call__(self, x: FloatArray) -> FloatArray:
        time.sleep(self.seconds * (int(abs(x[0, 0]) * 1e6) % 4))
        return quadratic(x)


@dataclass(frozen=True)
class Counting:
    """Counts its rows; the counts are no parameters, and the model is one like any other."""

    model: Model = field(default=quadratic, compare=False)
    sizes: list[int] = field(default_factory=list, compare=False)
    count: RowCount = field(default_factory=RowCount, compare=False)

    def __call__(self, x: FloatArray) -> FloatArray:
        if self.count.add(x):
            self.sizes.append(len(x))
        return np.asarray(self.model(x))

    @property
    def rows(self) -> int:
        return sum(self.sizes)


def never(x: FloatArray) -> FloatArray:
    raise AssertionError("the model was run")


def problem(model: Model = quadratic, *, version: str | None = "1", units: int = 2) -> Problem:
    return Problem(
        model,
        shared={"a": normal(0.0, 1.0)},
        individual={"b": normal(0.0, 1.0)},
        units=units,
        name="quadratic",
        version=version,
    )


def with_one_bad_row(n: int) -> tuple[FloatArray, int]:
    """Give rows of which one is bad, and which."""
    x, bad = rows(n), n // 3
    x[:, 1] = np.clip(x[:, 1], -FATAL, FATAL)
    x[bad, 1] = 2.0 * FATAL
    return x, bad


def rows(n: int, seed: int = 0) -> FloatArray:
    return np.random.default_rng(seed).standard_normal((n, 2))


@dataclass(frozen=True)
class Starting:
    """Starts a program in a session of its own and waits for it."""

    command: tuple[str, ...]

    def __call__(self, x: FloatArray) -> FloatArray:
        subprocess.run(self.command, start_new_session=True, check=True)
        return x[:, 0]
