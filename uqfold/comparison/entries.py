"""What the header of a record says about methods, system and references.

Each entry is written by `dataclasses.asdict`; reading raises KeyError, TypeError or ValueError for
a field that is missing or of the wrong kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from uqfold.comparison.encoding import decoded, member
from uqfold.methods.theory import Equation, Theory
from uqfold.problems.base import Problem


@dataclass(frozen=True)
class MethodEntry:
    """One method of a comparison.

    Attributes
    ----------
    label, method, title
        Label in the comparison, registered name, and a few words for tables.
    settings
        The settings as text.
    theory
        What the method states of itself: idea, equations, references.
    """

    label: str
    method: str
    title: str
    settings: str
    theory: Theory = field(default_factory=Theory)

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> MethodEntry:
        """Read what `dataclasses.asdict` gave."""
        theory = document["theory"]
        references = [decoded(one, str, "references") for one in theory["references"]]
        equations = [Equation(**texts(one)) for one in theory["equations"]]
        return cls(
            **texts({name: value for name, value in document.items() if name != "theory"}),
            theory=Theory(member(theory, "summary", str), tuple(equations), tuple(references)),
        )


@dataclass(frozen=True)
class InputEntry:
    """One random input: name, unit and distribution as text; role ``shared`` or ``individual``."""

    name: str
    unit: str
    role: str
    distribution: str


@dataclass(frozen=True)
class SystemEntry:
    """The system in question.

    Attributes
    ----------
    units
        Number of units.
    structure
        How they make up the system, as text.
    inputs
        The random inputs, shared ones first.
    dependence
        ``independent``, or the name of the copula that joins the inputs.
    """

    units: int
    structure: str
    inputs: tuple[InputEntry, ...]
    dependence: str

    @classmethod
    def of(cls, problem: Problem) -> SystemEntry:
        """Describe a problem."""
        joint = problem.inputs
        roles = ["shared"] * joint.n_shared + ["individual"] * joint.n_individual
        described = zip(joint.names, problem.input_units, roles, joint.columns, strict=True)
        return cls(
            units=problem.n_units,
            structure=repr(problem.structure),
            inputs=tuple(
                InputEntry(name, unit, role, str(column)) for name, unit, role, column in described
            ),
            dependence="independent"
            if joint.independent
            else str(joint.distribution.getCopula().getName()),
        )

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> SystemEntry:
        """Read what `dataclasses.asdict` gave."""
        return cls(
            units=member(document, "units", int),
            structure=member(document, "structure", str),
            inputs=tuple(InputEntry(**texts(one)) for one in document["inputs"]),
            dependence=member(document, "dependence", str),
        )


@dataclass(frozen=True)
class ReferenceSource:
    """Where the references come from: kind, one sentence, and the command that makes them."""

    kind: str
    how: str
    command: str


def texts(document: Mapping[str, Any]) -> dict[str, str]:
    """Give a JSON object whose values all have to be texts."""
    return {name: member(document, name, str) for name in document}
