"""What the reference scripts share: what is asked, and the file format.

A reference file is JSON with one row per line, so that a change shows as a readable difference.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from decimal import ROUND_UP, Context
from itertools import product
from pathlib import Path

from uqfold.problems.criterion import Binomial, Criterion, Missions
from uqfold.problems.reference import SCHEMA, Reference, parse_references
from uqfold.typing import FloatArray
from uqfold.writing import write_text

SHIPPED = Path(__file__).resolve().parents[2] / "uqfold" / "problems" / "references"
"""Where the references of the package live."""

# Fig. 15 (d) varies the number of planned flights at p = 0.5, Fig. 15 (e) varies p at ten flights
BINOMIAL_PROFILES: tuple[Missions, ...] = (
    *(Binomial(planned, 0.5) for planned in (2, 4, 6, 8, 10)),
    *(Binomial(10, p) for p in (0.3, 0.7, 0.9)),
)


@dataclass(frozen=True)
class Grid:
    """What is asked of a system: all combinations, arrays (taus, profiles, thresholds).

    Attributes
    ----------
    thresholds, taus, profiles
        T (finite), tau (None: not required) and mission profiles.
    units
        Number of units n.
    """

    thresholds: Sequence[float]
    taus: Sequence[float | None]
    profiles: Sequence[Missions]
    units: int = 4

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the arrays of answers."""
        return len(self.taus), len(self.profiles), len(self.thresholds)

    @property
    def criteria(self) -> list[Criterion]:
        """The criteria in the order of the arrays."""
        every = product(self.taus, self.profiles, self.thresholds)
        return [Criterion(threshold, tau, profile) for tau, profile, threshold in every]

    def references(self, pf: FloatArray, std_error: FloatArray) -> list[Reference]:
        """Return the answers with their errors as references."""
        answers = zip(self.criteria, pf.ravel(), std_error.ravel(), strict=True)
        return [Reference(criterion, float(p), float(error)) for criterion, p, error in answers]


def write(
    stem: str, how: str, command: str, references: Iterable[Reference], kind: str = "integration"
) -> None:
    """Write the reference file of the problem of that name into the package."""
    problem = stem.replace("_", "-")
    write_text(SHIPPED / f"{stem}.json", as_text(problem, kind, how, command, references))


def as_text(
    problem: str, kind: str, how: str, command: str, references: Iterable[Reference]
) -> str:
    """Return the text of a reference file, checked by the parser of the package.

    pf has 13 digits, its error is rounded up to two.
    """
    head = {"schema": SCHEMA, "problem": problem, "kind": kind, "how": how, "command": command}
    rows = [
        asdict(one.criterion)
        | {"pf": float(f"{one.pf:.12e}"), "std_error": rounded_up(one.std_error)}
        for one in references
    ]
    lines = ",\n".join(f"  {json.dumps(row)}" for row in rows)
    text = json.dumps(head, indent=1)[:-2] + f',\n "rows": [\n{lines}\n ]\n}}\n'
    parse_references(json.loads(text))
    return text


def rounded_up(value: float) -> float:
    """Round a positive number up to two significant digits."""
    return float(Context(prec=2, rounding=ROUND_UP).create_decimal(repr(float(value))))
