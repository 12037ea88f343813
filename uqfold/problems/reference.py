"""Known answers with their own uncertainty, kept as data and never interpolated."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from typing import Any

from uqfold.checks import instance, keep, real, text
from uqfold.problems.criterion import Binomial, Criterion, Missions

SCHEMA = "uqfold-reference/1"


@dataclass(frozen=True)
class Reference:
    """The known failure probability of one criterion.

    Attributes
    ----------
    criterion
        What it answers.
    pf
        Failure probability.
    std_error
        Its own standard error (simulation) or error bound (integration).
    """

    criterion: Criterion
    pf: float
    std_error: float

    def __post_init__(self) -> None:
        keep(self, "criterion", instance, Criterion, "give a Criterion")
        keep(self, "pf", real, at_least=0.0, at_most=1.0, what="probability")
        keep(self, "std_error", real, at_least=0.0)


@dataclass(frozen=True)
class ReferenceTable:
    """All references of one problem and where they come from.

    Attributes
    ----------
    problem
        Name of the problem.
    kind
        ``integration`` or ``simulation``.
    how
        One sentence: how they were obtained.
    command
        The command that makes them again.
    entries
        The references, by criterion.
    """

    problem: str
    kind: str
    how: str
    command: str
    entries: Mapping[Criterion, Reference]
    _answered: tuple[Any, ...] | None = field(default=None, compare=False, repr=False, kw_only=True)

    def __post_init__(self) -> None:
        keep(self, "problem", text)
        for name in ("kind", "how", "command"):
            keep(self, name, text, empty=True)
        keep(self, "entries", instance, Mapping, "give a dict of Criterion -> Reference")
        for criterion, reference in self.entries.items():
            instance("a key of entries", criterion, Criterion, "give a Criterion")
            instance(f"entries[{criterion}]", reference, Reference, "give a Reference")

    def lookup(self, criterion: Criterion) -> Reference | None:
        """Return the reference of exactly this criterion, or None; nothing is interpolated."""
        return self.entries.get(instance("criterion", criterion, Criterion, "give a Criterion"))

    def __iter__(self) -> Iterator[Reference]:
        return iter(self.entries.values())

    def __len__(self) -> int:
        return len(self.entries)


def answering(references: ReferenceTable, *question: Any) -> ReferenceTable | None:
    """Return references as those of one question, or None if they answer another.

    Parameters
    ----------
    references
        The references.
    question
        What pf depends on besides the criterion: model, inputs, units, structure.
    """
    known = references._answered
    if known is None:
        return replace(references, _answered=question)
    same = (one is two or one == two for one, two in zip(known, question, strict=True))
    return references if all(same) else None


@cache
def load_references(stem: str) -> ReferenceTable:
    """Read the reference table that ships as ``problems/references/<stem>.json``.

    Raises
    ------
    ValueError
        If the file does not follow the schema ``uqfold-reference/1``.
    """
    path = resources.files("uqfold.problems") / "references" / f"{stem}.json"
    return parse_references(json.loads(path.read_text(encoding="utf-8")))


def parse_references(document: Mapping[str, Any]) -> ReferenceTable:
    """Check and read a reference document (schema ``uqfold-reference/1``).

    Raises
    ------
    ValueError
        If the schema differs, a field is missing, a value is not a probability, or two rows answer
        the same criterion.
    """
    if document.get("schema") != SCHEMA:
        raise ValueError(f"schema {document.get('schema')!r} is not {SCHEMA!r}")
    try:
        entries: dict[Criterion, Reference] = {}
        for row in document["rows"]:
            criterion = Criterion(row["threshold"], row["tau"], _missions(row["missions"]))
            if criterion in entries:
                raise ValueError(f"two references for {criterion}")
            entries[criterion] = Reference(criterion, row["pf"], row["std_error"])
        return ReferenceTable(
            problem=str(document["problem"]),
            kind=str(document["kind"]),
            how=str(document["how"]),
            command=str(document["command"]),
            entries=entries,
        )
    except KeyError as error:
        raise ValueError(f"reference document lacks the field {error}") from error
    except TypeError as error:
        raise ValueError(f"reference document holds a value of the wrong type: {error}") from error


def _missions(value: int | Mapping[str, Any]) -> Missions:
    return Binomial(value["planned"], value["p"]) if isinstance(value, Mapping) else value
