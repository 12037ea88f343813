"""Known answers with their own uncertainty, kept as data and never interpolated."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

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

    def lookup(self, criterion: Criterion) -> Reference | None:
        """Give the reference of exactly this criterion, or None; nothing is interpolated."""
        return self.entries.get(criterion)

    def __iter__(self) -> Iterator[Reference]:
        return iter(self.entries.values())

    def __len__(self) -> int:
        return len(self.entries)


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
        If the schema differs, a field is missing, a value is no probability, or two rows answer
        the same criterion.
    """
    if document.get("schema") != SCHEMA:
        raise ValueError(f"schema {document.get('schema')!r} is not {SCHEMA!r}")
    try:
        entries: dict[Criterion, Reference] = {}
        for row in document["rows"]:
            criterion = Criterion(row["threshold"], row["tau"], _missions(row["missions"]))
            pf, error = float(row["pf"]), float(row["std_error"])
            if not (0.0 <= pf <= 1.0 and error >= 0.0 and math.isfinite(error)):
                raise ValueError(f"reference for {criterion}: pf = {pf}, std_error = {error}")
            if criterion in entries:
                raise ValueError(f"two references for {criterion}")
            entries[criterion] = Reference(criterion, pf, error)
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
