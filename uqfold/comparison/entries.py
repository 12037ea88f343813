"""Records as the reports still take them.

What the header of a record says about methods, system and references.

Each entry is written by `dataclasses.asdict`; reading raises KeyError, TypeError or ValueError for
a field that is missing or of the wrong kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from uqfold.comparison.columns import Row, rows_of, rows_to_frame
from uqfold.comparison.encoding import decoded, member
from uqfold.comparison.frames import checked_frame
from uqfold.comparison.header import ATTRIBUTE, decoded_criterion, encoded_criterion
from uqfold.methods.theory import Equation, Theory
from uqfold.problems.criterion import Criteria

if TYPE_CHECKING:
    import pandas as pd


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


@dataclass(frozen=True)
class RunHeader:
    """What was asked of the methods, and how they were run.

    Attributes
    ----------
    problem, response, response_unit
        Names of the problem and of its response, and the unit of response, T and tau.
    system
        Units, structure and inputs, or None where they are not recorded.
    criteria
        The grid that every method was to answer.
    methods
        The methods asked for, in order, whether or not they finished.
    seed
        Seed of every method.
    max_evals
        Budget of every method, or None.
    failed_runs
        Policy for failed runs.
    reference
        Where the references come from, or None if the problem has none.
    command
        The command as typed, without absolute paths; empty for a run from Python.
    date
        When the run began, UTC, ISO 8601.
    machine
        On what kind of machine; durations mean something only beside it. May be empty.
    versions
        Name -> version of uqfold, Python and the packages that the numbers depend on.
    """

    problem: str
    response: str
    response_unit: str
    system: SystemEntry | None
    criteria: Criteria
    methods: tuple[MethodEntry, ...]
    seed: int
    max_evals: int | None
    failed_runs: str
    reference: ReferenceSource | None
    command: str
    date: str
    machine: str
    versions: Mapping[str, str]

    def to_document(self) -> dict[str, Any]:
        """Give the header as JSON values."""
        return {
            "problem": self.problem,
            "response": self.response,
            "response_unit": self.response_unit,
            "system": None if self.system is None else asdict(self.system),
            "criteria": [encoded_criterion(criterion) for criterion in self.criteria],
            "methods": [asdict(entry) for entry in self.methods],
            "seed": self.seed,
            "max_evals": self.max_evals,
            "failed_runs": self.failed_runs,
            "reference": None if self.reference is None else asdict(self.reference),
            "command": self.command,
            "date": self.date,
            "machine": self.machine,
            "versions": dict(self.versions),
        }

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> RunHeader:
        """Read what `to_document` gave.

        Raises
        ------
        KeyError, TypeError, ValueError
            If a field is missing or of the wrong kind.
        """
        reference = document["reference"]
        return cls(
            problem=member(document, "problem", str),
            response=member(document, "response", str),
            response_unit=member(document, "response_unit", str),
            system=None
            if document["system"] is None
            else SystemEntry.from_document(document["system"]),
            criteria=Criteria(decoded_criterion(one) for one in document["criteria"]),
            methods=tuple(MethodEntry.from_document(entry) for entry in document["methods"]),
            seed=member(document, "seed", int),
            max_evals=None if document["max_evals"] is None else member(document, "max_evals", int),
            failed_runs=member(document, "failed_runs", str),
            reference=None if reference is None else ReferenceSource(**texts(reference)),
            command=member(document, "command", str),
            date=member(document, "date", str),
            machine=member(document, "machine", str),
            versions=texts(document["versions"]),
        )


@dataclass(frozen=True)
class Records:
    """A comparison as reports take it: how it was made, and its rows."""

    header: RunHeader
    rows: tuple[Row, ...]

    @property
    def finished(self) -> tuple[str, ...]:
        """Labels of the methods that have rows, in the order in which they ran."""
        return tuple(dict.fromkeys(row["label"] for row in self.rows))

    @property
    def complete(self) -> bool:
        """Whether every method that was asked for has its rows."""
        return self.finished == tuple(entry.label for entry in self.header.methods)

    def to_frame(self) -> pd.DataFrame:
        """Return the frame."""
        frame = rows_to_frame(self.rows)
        frame.attrs[ATTRIBUTE] = {
            **self.header.to_document(), "source": {}, "finished": list(self.finished)
        }  # fmt: skip
        return frame


def records_from_frame(frame: pd.DataFrame) -> Records:
    """Return the records of a frame."""
    checked = checked_frame(frame)
    header = RunHeader.from_document(checked.attrs[ATTRIBUTE])
    return Records(header, tuple(rows_of(checked)))
