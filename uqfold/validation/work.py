"""What a case is handed when it measures: how thoroughly, with which fault, with which seeds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from uqfold.validation.case import Tier

Value = TypeVar("Value")


@dataclass(frozen=True)
class Work:
    """The order to measure one case.

    Attributes
    ----------
    tier
        How thoroughly.
    fault
        Name of the fault to plant, or None to measure honestly.
    seeds, settings
        What the case declares.
    progress
        Told of every finished part: how many are done, of how many (None: not known).
    """

    tier: Tier = "quick"
    fault: str | None = None
    seeds: tuple[int, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    progress: Callable[[int, int | None], None] = lambda _done, _total: None

    def pick(self, quick: Value, full: Value) -> Value:
        """Return the value that belongs to the tier."""
        return quick if self.tier == "quick" else full

    def parts(self, computations: Mapping[str, Callable[[], Value]]) -> dict[str, Value]:
        """Compute parts one by one, and tell of each; return name -> result."""
        results: dict[str, Value] = {}
        self.progress(0, len(computations))
        for name, compute in computations.items():
            results[name] = compute()
            self.progress(len(results), len(computations))
        return results
