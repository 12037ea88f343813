"""What a case measured: findings, the claims that they judge, and tables and points as plain data.

>>> Table.of("Times", [{"wing": "table 6", "time (s)": 0.5356}]).columns
('wing', 'time (s)')
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

from uqfold.checks import (
    choice,
    flag,
    instance,
    keep,
    mapping,
    or_none,
    plain,
    real,
    refused,
    several,
    text,
)
from uqfold.validation.findings import Finding, Verdict, verdict_of

if TYPE_CHECKING:
    import pandas as pd

CellValue: TypeAlias = float | str | None
"""A finite number, a text, or None for nothing."""
Log: TypeAlias = Literal["", "x", "y", "xy"]
DIGITS = 9
"""Significant digits of numbers in tables; findings keep every bit."""


@dataclass(frozen=True)
class Table:
    """Rows of numbers and texts, as JSON knows them.

    Attributes
    ----------
    title
        What the rows are, in one line.
    columns
        Names, with their units, as in ``time (s)``.
    rows
        One cell per column: truth values are "yes" and "no", NaN is None, infinities are texts.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[CellValue, ...], ...]

    def __post_init__(self) -> None:
        keep(self, "title", text)
        keep(self, "columns", several, text)
        keep(self, "rows", several, several, _cell)
        if not self.columns or len(set(self.columns)) != len(self.columns):
            raise refused("columns", self.columns, "give at least one name, and none twice")
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise ValueError(
                    f"rows[{i}] has {len(row)} cells for {len(self.columns)} columns of the table "
                    f"{self.title!r}"
                )

    @classmethod
    def of(cls, title: str, rows: Iterable[Mapping[str, Any]] | pd.DataFrame) -> Table:
        """Return the table of a pandas frame, or of rows with the same keys, its columns.

        Raises
        ------
        ValueError
            If there are no rows, or their keys differ.
        """
        to_dict = getattr(rows, "to_dict", None)
        named = several("rows", to_dict("records") if to_dict else rows, mapping, _cell)
        if not named:
            raise refused("rows", named, f"the table {title!r} has none, give at least one")
        columns = list(named[0])
        for i, row in enumerate(named):
            if list(row) != columns:
                raise ValueError(f"rows[{i}] has the keys {list(row)}, not {columns}")
        return cls(title, tuple(columns), tuple(tuple(row.values()) for row in named))


@dataclass(frozen=True)
class Points:
    """Curves or sets of points, for a report to draw.

    Attributes
    ----------
    title
        What they show, in one sentence; serves as the text alternative too.
    x, y
        Names of the axes, with units.
    table
        Columns ``series``, ``x``, ``y`` and, where there are error bars, ``low`` and ``high``. A
        series called ``reference`` is what the others are compared with; one with the name of a
        method has that method's colour.
    log
        Which axes are logarithmic.
    limits
        Label -> y of a horizontal line.
    """

    title: str
    x: str
    y: str
    table: Table
    log: Log = ""
    limits: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        for name in ("title", "x", "y"):
            keep(self, name, text)
        keep(self, "table", instance, Table, "give a Table")
        keep(self, "log", choice, get_args(Log))
        keep(self, "limits", or_none, mapping, real)
        missing = {"series", "x", "y"} - {*self.table.columns}
        if missing:
            raise refused("table", self.table.columns, f"give the columns {sorted(missing)} too")


@dataclass(frozen=True)
class Claim:
    """One of several claims that a case judges.

    Attributes
    ----------
    key
        Short name; its findings carry it.
    statement
        What is claimed, in one sentence.
    source
        Where.
    rule
        What has to be true of the numbers.
    identity
        Whether it follows from the algebra alone, so that keeping it is no evidence.
    """

    key: str
    statement: str
    source: str
    rule: str
    identity: bool = False

    def __post_init__(self) -> None:
        for name in ("key", "statement", "source", "rule"):
            keep(self, name, text)
        keep(self, "identity", flag)


@dataclass(frozen=True)
class Measurement:
    """What a case measured; any sequences will do."""

    findings: tuple[Finding, ...]
    tables: tuple[Table, ...] = ()
    points: tuple[Points, ...] = ()
    claims: tuple[Claim, ...] = ()

    def __post_init__(self) -> None:
        keep(self, "findings", several, instance, Finding, "give a Finding")
        keep(self, "tables", several, instance, Table, "give a Table")
        keep(self, "points", several, instance, Points, "give Points")
        keep(self, "claims", several, instance, Claim, "give a Claim")
        known = {claim.key for claim in self.claims}
        for finding in self.findings:
            if finding.claim and finding.claim not in known:
                raise refused("findings", finding.claim, "a finding belongs to no claim of these")

    @property
    def verdict(self) -> Verdict:
        """The verdict that the findings give."""
        return verdict_of(self.findings)

    @property
    def claim_verdicts(self) -> dict[str, Verdict]:
        """Key -> verdict of every claim, by the findings that carry its key."""
        keys = [claim.key for claim in self.claims]
        return {key: verdict_of(one for one in self.findings if one.claim == key) for key in keys}


def _cell(name: str, value: Any) -> CellValue:
    simple = plain(value)
    if simple is None or isinstance(simple, str):
        return simple
    if isinstance(simple, bool):
        return "yes" if simple else "no"
    given = real(name, simple, finite=False, nan=True, what="number, a text or None")
    if math.isinf(given):
        return str(given)
    return None if math.isnan(given) else float(f"{given:.{DIGITS}g}")
