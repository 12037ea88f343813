"""What a hard problem is: a response, its inputs and the question, with the exact answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import special, stats

import uqfold
from uqfold.problems.criterion import Criterion
from validation.no_false_confidence.truths import average

Array = Any
ROOT_2 = math.sqrt(2.0)


@dataclass(frozen=True)
class Hard:
    """A problem, its question and its answer.

    Attributes
    ----------
    name, kind
        What it is, and the trouble that it holds.
    d
        Number of inputs.
    response
        Takes X (n, d), gives y (n,); it works while y <= T.
    threshold
        T.
    truth
        Computes pf.
    smooth
        Whether it is one for which a smooth surface is the right tool.
    inputs
        Builds the joint distribution; None: standard normals.
    units, missions, shared
        The system; the first `shared` inputs are shared.
    safe
        Computes pf with all failed runs safe; None: no run fails.
    """

    name: str
    kind: str
    d: int
    response: Callable[[Array], Array]
    threshold: float
    truth: Callable[[], float]
    smooth: bool = False
    inputs: Callable[[], Any] | None = None
    units: int = 1
    missions: int = 1
    shared: int = 0
    safe: Callable[[], float] | None = None

    @cached_property
    def pf(self) -> float:
        """The exact failure probability, failed runs counted as failures."""
        return self.truth()

    @cached_property
    def least(self) -> float:
        """The exact failure probability with failed runs safe."""
        return self.pf if self.safe is None else self.safe()

    @property
    def criterion(self) -> Criterion:
        """What is asked."""
        return Criterion(self.threshold, None, self.missions)

    def problem(self) -> uqfold.Problem:
        """Return the problem as a method takes it."""
        if self.inputs is not None:
            return uqfold.Problem(self.response, inputs=self.inputs(), name=self.name)
        marginals = [stats.norm() for _ in range(self.d)]
        return uqfold.Problem(
            self.response,
            shared=marginals[: self.shared] or None,
            individual=marginals[self.shared :],
            units=self.units,
            name=self.name,
            names=[f"u{i}" for i in range(self.d)],
        )


def given(
    name: str,
    kind: str,
    level: float,
    mean: Callable[..., Array],
    slopes: Sequence[float] | Callable[..., Sequence[Array]],
    *,
    known: Sequence[int] = (0,),
    breaks: Sequence[float] = (),
    **more: Any,
) -> Hard:
    """Return a response that is linear in all inputs but some: normal, once these are known.

    Parameters
    ----------
    name, kind, level
        Name, trouble and threshold.
    mean
        Function of the known inputs; NaN where a run fails.
    slopes
        Factor of each other input, or a function of the known ones that gives these.
    known
        Columns of the known inputs.
    breaks
        Where the mean or a slope has a kink or a step.
    more
        Further fields of `Hard`.
    """

    def slopes_at(u: Sequence[Array]) -> Sequence[Array]:
        return slopes(*u) if callable(slopes) else slopes

    def response(x: Array) -> Array:
        u, others = x[:, known].T, np.delete(x, known, axis=1).T
        return mean(*u) + sum(s * one for s, one in zip(slopes_at(u), others, strict=True))

    def pf(failed: float) -> float:
        def beyond(*u: Array) -> Array:
            middle, spread = mean(*u), np.sqrt(sum(slope**2 for slope in slopes_at(u)))
            works = special.log_ndtr((level - middle) / spread)
            trials = more.get("units", 1) * more.get("missions", 1)
            return np.where(np.isnan(middle), failed, -np.expm1(trials * works))

        return average(beyond, len(known), breaks)

    d = len(known) + len(slopes_at(np.zeros(len(known))))
    return Hard(name, kind, d, response, level, lambda: pf(1.0), safe=lambda: pf(0.0), **more)
