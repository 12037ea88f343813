"""What the catalogue says of a limit state: where it comes from, and how its pf is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from uqfold.inputs import joint_inputs
from uqfold.problems.base import Problem
from uqfold.problems.criterion import LIMIT_STATE_THRESHOLD, Criterion
from uqfold.problems.reference import Reference, ReferenceTable
from uqfold.typing import FloatArray

KINDS: Mapping[str, str] = {
    "design points": "several regions of failure at similar distances",
    "curved": "a strongly curved limit-state surface, for which FORM is far off",
    "flat": "a limit state that hardly changes, or misleads, where most of the inputs lie",
    "high dimension": "20 inputs or more",
    "rare": "pf below 2e-6",
    "frequent": "pf above 0.05",
    "bounded": "inputs within bounds",
    "series": "a series system: the smallest of several limit states",
    "parallel": "a parallel system, or one with parallel parts: the largest of several",
    "rough": "fine waves on the limit state, as of a noisy numerical model",
    "jump": "a limit state that jumps",
    "heavy tail": "inputs with tails heavier than exponential",
    "dependent": "inputs that depend on each other",
}
"""Kind of a limit state -> what it means."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A limit state of the literature.

    Attributes
    ----------
    source
        Author, year, title, and the place in it.
    kinds
        What makes it hard, by the keys of `KINDS`.
    limit_state
        g: takes X (n, d), returns (n,); failure when it is not positive.
    inputs
        Makes the inputs: their distributions by name, or a joint distribution.
    pf, error
        Failure probability and the bound, or standard error, of its own error.
    how
        How pf was found.
    reference
        Finds it again: returns pf and error.
    dear
        Whether that takes more than half a second.
    units
        Name of an input -> its unit; those without one are left out.
    published
        Who gave pf as the known one -> the value as printed.
    """

    source: str
    kinds: tuple[str, ...]
    limit_state: Callable[[FloatArray], FloatArray]
    inputs: Callable[[], Any]
    pf: float
    error: float
    how: str
    reference: Callable[[], tuple[float, float]]
    dear: bool = False
    units: Mapping[str, str] = field(default_factory=dict)
    published: Mapping[str, str] = field(default_factory=dict)

    def wrong(self) -> dict[str, float]:
        """Return who published a wrong pf -> how far it is off, relative to ours.

        Wrong is what lies further away than one unit of its last printed digit, and than our own
        error.
        """
        found = {}
        for who, printed in self.published.items():
            off = float(printed) - self.pf
            unit = float(Decimal((0, (1,), int(Decimal(printed).as_tuple().exponent))))
            if abs(off) > max(unit, 4.0 * self.error, 1e-9 * self.pf):
                found[who] = off / self.pf
        return found

    def problem(self, name: str) -> Problem:
        """Return the problem of one unit, with the reference for g <= 0."""
        failure = Criterion(LIMIT_STATE_THRESHOLD)
        inputs = joint_inputs(self.inputs())
        return Problem.from_limit_state(
            self.limit_state,
            inputs,
            name=name,
            version=f"catalogue/{name}",
            response="-g",
            input_units=[self.units.get(one, "") for one in inputs.names],
            references=ReferenceTable(
                problem=name,
                kind="integration",
                how=self.how,
                command=f"uqfold.problems.catalogue.entry({name!r}).reference()",
                entries={failure: Reference(failure, self.pf, self.error)},
            ),
        )
