"""What a case is handed when it measures: how thoroughly, with which fault, with which seeds."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from uqfold.comparison.sealed import read_sealed, write_sealed
from uqfold.evidence.record import Tier

Value = TypeVar("Value")

Progress = Callable[[int, int | None], None]
"""Called with the parts done, and how many there are (None: not known)."""


def _unseen(_done: int, _total: int | None) -> None:
    pass


@dataclass(frozen=True)
class Work:
    """The order to measure one case.

    Attributes
    ----------
    tier
        How thoroughly.
    fault
        Name of the fault to plant, or None to measure honestly.
    seeds
        The seeds that the case declares.
    kept
        Folder in which finished parts outlive an interruption, or None.
    progress
        Told of every finished part.
    saved
        Seconds that parts read instead of computed once took.
    """

    tier: Tier = "quick"
    fault: str | None = None
    seeds: tuple[int, ...] = ()
    kept: Path | None = None
    progress: Progress = _unseen
    saved: list[float] = field(default_factory=list)

    def pick(self, quick: Value, default: Value, full: Value) -> Value:
        """Give the value that belongs to the tier."""
        return {"quick": quick, "default": default, "full": full}[self.tier]

    def parts(self, computations: Mapping[str, Callable[[], Any]]) -> dict[str, Any]:
        """Compute parts one by one; those that an interrupted run has finished are read instead.

        Parameters
        ----------
        computations
            Name of each part -> what computes it; the result has to be made of what JSON knows
            (numbers, texts, lists, dictionaries with text keys), and depend on nothing but the
            case's code, its tier and the name.

        Returns
        -------
        dict
            Name -> result, in order.
        """
        results: dict[str, Any] = {}
        total = len(computations)
        self.progress(0, total)
        for name, compute in computations.items():
            path = None if self.kept is None else self.kept / f"{_file_stem(name)}.json"
            part = None if path is None else read_sealed(path)
            if part is None:
                part = _computed(compute, path)
            else:
                self.saved.append(part["seconds"])
            results[name] = part["result"]
            self.progress(len(results), total)
        return results


def _computed(compute: Callable[[], Any], path: Path | None) -> Any:
    start = time.perf_counter()
    result = compute()
    part = {"result": result, "seconds": time.perf_counter() - start}
    # what is read after an interruption is the same to the last bit
    return json.loads(json.dumps(part)) if path is None else write_sealed(path, part)


def _file_stem(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()[:16]
