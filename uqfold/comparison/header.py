"""How a comparison was made: the part of a record that stands above its rows."""

from __future__ import annotations

import datetime
import os
import platform
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import uqfold
from uqfold.comparison.encoding import decoded_criterion, encoded_criterion, member
from uqfold.comparison.entries import MethodEntry, ReferenceSource, SystemEntry, texts
from uqfold.comparison.run import ComparisonPlan
from uqfold.problems.criterion import Criteria

RECORDED_PACKAGES = ("numpy", "scipy", "numba", "openturns")


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

    @classmethod
    def of(cls, plan: ComparisonPlan, command: str = "") -> RunHeader:
        """Describe a plan that is about to be run, now and with the versions installed here."""
        problem, known = plan.problem, plan.problem.references
        return cls(
            problem=problem.name,
            response=problem.response,
            response_unit=problem.response_unit,
            system=SystemEntry.of(problem),
            criteria=plan.criteria,
            methods=tuple(
                MethodEntry(label, method.name, method.title, repr(method), method.theory)
                for label, method in plan.methods.items()
            ),
            seed=plan.seed,
            max_evals=plan.max_evals,
            failed_runs=plan.evaluator.failed_runs,
            reference=None
            if known is None
            else ReferenceSource(known.kind, known.how, known.command),
            command=command,
            date=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
            machine=machine_text(),
            versions=installed_versions(),
        )

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


def machine_text() -> str:
    """Say in a few words on what kind of machine this runs, without naming it."""
    processor = platform.machine() or "unknown processor"
    return f"{platform.system()}, {processor}, {os.cpu_count() or 1} processors"


def installed_versions(further: Iterable[str] = ()) -> dict[str, str]:
    """Give the versions of uqfold, Python, `RECORDED_PACKAGES` and further packages.

    None of them is imported.
    """
    versions = {"uqfold": uqfold.__version__, "python": platform.python_version()}
    for package in (*RECORDED_PACKAGES, *further):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    return versions


def shown_command(arguments: Sequence[str]) -> str:
    """Give a command line as typed, but without any absolute path of this machine.

    A path below the working directory becomes relative to it; of any other only the last part
    remains, after ``.../``.

    Parameters
    ----------
    arguments
        The words after the program's name.

    Examples
    --------
    >>> shown_command(["compare", "series", "--out=/home/someone/results"])
    'uqfold compare series --out=.../results'
    """
    return shlex.join(["uqfold", *map(_without_absolute_path, arguments)])


def _without_absolute_path(word: str) -> str:
    option, equals, value = word.partition("=") if word.startswith("-") else ("", "", word)
    if not os.path.isabs(value):
        return word
    path, here = Path(value), Path.cwd()
    shown = path.relative_to(here) if path.is_relative_to(here) else Path("...", path.name)
    return f"{option}{equals}{shown.as_posix()}"
