"""How a check says that a promise was broken, and how closely it looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeVar

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import CriterionResult
from uqfold.problems.criterion import Criterion

Level = Literal["quick", "full"]
T = TypeVar("T")


class ContractError(AssertionError):
    """A method breaks the contract; the message says which promise and how."""


@dataclass(frozen=True)
class Settings:
    """How closely the checks look.

    Attributes
    ----------
    level
        ``full``: all systems, criteria, structures and seeds; ``quick``: the fewest that can still
        show that the promise is broken.
    tolerance
        Relative error allowed to methods that state no error.
    max_evals
        Budget of the checks of accuracy.
    """

    level: Level
    tolerance: float
    max_evals: int

    def choose(self, *, quick: T, full: T) -> T:
        """Return what belongs to the level."""
        return full if self.level == "full" else quick


def shown(
    method: ReliabilityMethod, criterion: Criterion, row: CriterionResult, what: str = ""
) -> str:
    """Return the method, the place, the criterion, the status and pf, as messages begin."""
    place = f", {what}" if what else ""
    return f"{method.name}{place}, {criterion}: {row.status} with pf = {row.pf:.6g}"


def demand(condition: bool, message: str) -> None:
    """Raise `ContractError` unless the condition holds (unlike ``assert``, also under ``-O``)."""
    if not condition:
        raise ContractError(message)
