"""What a case measured: findings, tables, and figures as data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

from uqfold.checks import (
    choice,
    flag,
    instance,
    keep,
    listed,
    mapping,
    or_none,
    plain,
    real,
    refused,
    several,
    text,
)
from uqfold.comparison.findings import Finding, Verdict, verdict_of

Cell: TypeAlias = float | str | None
"""A number, a text, or None for nothing; infinities are numbers, NaN is nothing."""

Scale: TypeAlias = Literal["linear", "log"]
Style: TypeAlias = Literal["line", "points"]


@dataclass(frozen=True)
class Column:
    """A column of a table: its name, and the unit of its numbers."""

    name: str
    unit: str = ""

    def __post_init__(self) -> None:
        keep(self, "name", text)
        keep(self, "unit", text, empty=True)


@dataclass(frozen=True)
class Table:
    """Rows of numbers and texts.

    Attributes
    ----------
    name
        Identifier within the case.
    title
        What the rows are, in one line.
    columns, rows
        Each row has one cell per column.
    """

    name: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        keep(self, "name", text)
        keep(self, "title", text, empty=True)
        keep(self, "columns", several, instance, Column, "give a Column")
        keep(self, "rows", several, several, _checked_cell)
        names = [column.name for column in self.columns]
        if not names:
            raise refused("columns", self.columns, "give at least one Column")
        if len(set(names)) != len(names):
            raise ValueError(f"table {self.name!r} names a column twice: {names}")
        for i, row in enumerate(self.rows):
            if len(row) != len(names):
                raise ValueError(
                    f"table {self.name!r}: row {i} has {len(row)} cells for {len(names)} columns"
                )

    @classmethod
    def of(
        cls,
        name: str,
        title: str,
        rows: Iterable[Mapping[str, Any]],
    ) -> Table:
        """Make a table of rows with the same keys, which become the columns.

        Parameters
        ----------
        name, title
            As in the class.
        rows
            At least one mapping of column name to number, truth value, text or None; a name such
            as ``time (s)`` gives the unit as well.

        Raises
        ------
        ValueError
            If there are no rows, or their keys differ.
        """
        given = several("rows", rows, instance, Mapping, "give a dict of column -> cell")
        if not given:
            raise refused("rows", given, f"table {name!r} has none, give at least one")
        listed = [mapping(f"rows[{i}]", row, _checked_cell) for i, row in enumerate(given)]
        names = list(listed[0])
        for i, row in enumerate(listed):
            if list(row) != names:
                raise ValueError(f"table {name!r}: row {i} has the keys {list(row)}, not {names}")
        return cls(
            name,
            title,
            tuple(map(_column, names)),
            tuple(tuple(_cell(value) for value in row.values()) for row in listed),
        )


@dataclass(frozen=True)
class Axis:
    """An axis of a figure: what it shows, its unit, and its scale."""

    name: str
    unit: str = ""
    scale: Scale = "linear"

    def __post_init__(self) -> None:
        keep(self, "name", text)
        keep(self, "unit", text, empty=True)
        keep(self, "scale", choice, get_args(Scale))


@dataclass(frozen=True)
class Series:
    """One curve or set of points.

    Attributes
    ----------
    label
        Its name in the legend.
    x, y
        Coordinates, equally many; None in `y` is a gap.
    low, high
        Ends of the error bars, or of the band of a line; empty where there are none.
    style
        A line, or points.
    method
        Registered name of the reliability method it belongs to (same colour everywhere), or empty.
    reference
        Whether it is what the others are compared with.
    """

    label: str
    x: tuple[float, ...]
    y: tuple[float | None, ...]
    low: tuple[float | None, ...] = ()
    high: tuple[float | None, ...] = ()
    style: Style = "line"
    method: str = ""
    reference: bool = False

    def __post_init__(self) -> None:
        keep(self, "label", text)
        keep(self, "x", several, _coordinate)
        for name in ("y", "low", "high"):
            keep(self, name, several, _coordinate_or_gap)
        keep(self, "style", choice, get_args(Style))
        keep(self, "method", text, empty=True)
        keep(self, "reference", flag)
        if len(self.y) != len(self.x):
            raise ValueError(f"series {self.label!r}: {len(self.x)} x for {len(self.y)} y")
        for name, ends in (("low", self.low), ("high", self.high)):
            if len(ends) not in (0, len(self.x)):
                raise ValueError(f"series {self.label!r}: {len(ends)} {name} for {len(self.x)} x")
        if bool(self.low) != bool(self.high):
            raise ValueError(f"series {self.label!r} has only one of low and high")


@dataclass(frozen=True)
class Figure:
    """A figure as data, for a report to draw.

    Attributes
    ----------
    name
        Identifier within the case.
    title
        What it shows, in one sentence; serves as the text alternative too.
    x, y
        Its axes.
    series
        What is drawn, in order.
    x_marks, y_marks
        Lines at constant x or y (limits, tolerances), label and place.
    """

    name: str
    title: str
    x: Axis
    y: Axis
    series: tuple[Series, ...]
    x_marks: tuple[tuple[str, float], ...] = ()
    y_marks: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        keep(self, "name", text)
        keep(self, "title", text, empty=True)
        keep(self, "x", instance, Axis, "give an Axis")
        keep(self, "y", instance, Axis, "give an Axis")
        keep(self, "series", several, instance, Series, "give a Series")
        keep(self, "x_marks", several, _checked_mark)
        keep(self, "y_marks", several, _checked_mark)


@dataclass(frozen=True)
class Measurement:
    """What a case measured."""

    findings: tuple[Finding, ...]
    tables: tuple[Table, ...] = ()
    figures: tuple[Figure, ...] = ()

    def __post_init__(self) -> None:
        keep(self, "findings", several, instance, Finding, "give a Finding")
        keep(self, "tables", several, instance, Table, "give a Table")
        keep(self, "figures", several, instance, Figure, "give a Figure")
        for kind, parts in (("table", self.tables), ("figure", self.figures)):
            names = [part.name for part in parts]
            if len(set(names)) != len(names):
                raise ValueError(f"two {kind}s have the same name: {names}")

    @classmethod
    def of(
        cls,
        findings: Sequence[Finding],
        tables: Sequence[Table] = (),
        figures: Sequence[Figure] = (),
    ) -> Measurement:
        """Take any sequences."""
        return cls(
            listed("findings", findings), listed("tables", tables), listed("figures", figures)
        )

    @property
    def verdict(self) -> Verdict:
        """The verdict that the findings give."""
        return verdict_of(self.findings)


def _checked_cell(name: str, value: Any) -> Any:
    simple = plain(value)
    if isinstance(simple, str | bool | None):
        return simple
    real(name, simple, finite=False, nan=True, what="number, a text or None")
    return simple


def _coordinate(name: str, value: Any) -> Any:
    real(name, value, finite=False, nan=True)
    return plain(value)


def _coordinate_or_gap(name: str, value: Any) -> Any:
    return or_none(name, value, _coordinate)


def _checked_mark(name: str, mark: Any) -> tuple[str, float]:
    parts = listed(name, mark)
    if len(parts) != 2:
        raise refused(name, mark, "give a label and a place")
    return text(f"{name}[0]", parts[0], empty=True), _coordinate(f"{name}[1]", parts[1])


def _cell(value: Any) -> Cell:
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "yes" if value else "no"
    return float(value)


def _column(key: str) -> Column:
    name, bracket, unit = key.removesuffix(")").rpartition(" (")
    return Column(name, unit) if bracket and key.endswith(")") else Column(key)
