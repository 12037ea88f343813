"""Tables and figures of validation records as blocks of a page."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import cycle

from uqfold.comparison.findings import Finding, Verdict, number
from uqfold.evidence import measurement
from uqfold.evidence.measurement import Cell as Value
from uqfold.report.page.blocks import Cell, Column, Figure, Number, Row, Table, Tone, View
from uqfold.report.page.chart import DASHED, Axis, Chart, Key, Mark, Point, Series
from uqfold.report.page.values import number_cell
from uqfold.report.style import FURTHER_STYLES, MethodStyle, method_styles

VERDICT_TONES: dict[Verdict, Tone] = {
    "holds": "good",
    "does not hold": "bad",
    "cannot be judged": "warn",
}


def findings_table(findings: Iterable[Finding], caption: str) -> Table:
    """Give findings with their limits and verdicts."""
    listed, rows = list(findings), []
    for one in listed:
        verdict = one.verdict
        bound = "at least" if one.at_least else "at most"
        spread = "" if one.uncertainty is None else f" ± {number(one.uncertainty)}"
        value = Cell("not measured", math.nan)
        if one.value is not None:
            value = Cell([Number(f"{number(one.value)}{spread}"), _unit(one.unit)], one.value)
        limit = Cell("quoted only", math.nan, "quiet")
        if one.limit is not None:
            limit = Cell([f"{bound} ", Number(number(one.limit)), _unit(one.unit)], one.limit)
        rows.append(
            Row(
                (
                    Cell(one.what),
                    value,
                    limit,
                    Cell(verdict or "–", tone=VERDICT_TONES[verdict] if verdict else "quiet"),
                    Cell(one.remark),
                )
            )
        )
    columns: tuple[Column, ...] = (
        Column("finding"),
        Column("measured", numeric=True),
        Column("limit", numeric=True),
        Column("verdict"),
        Column("remark"),
    )
    if not any(one.remark for one in listed):
        columns, rows = columns[:-1], [Row(row.cells[:-1]) for row in rows]
    return Table(caption, columns, tuple(rows), tools=False, show_caption=False)


def evidence_table(table: measurement.Table) -> Table:
    """Give a table of a record."""
    numeric = [
        all(row[i] is None or isinstance(row[i], float | int) for row in table.rows)
        for i in range(len(table.columns))
    ]
    columns = tuple(
        Column(f"{one.name} ({one.unit})" if one.unit else one.name, numeric=is_number)
        for one, is_number in zip(table.columns, numeric, strict=True)
    )
    rows = tuple(Row(tuple(map(_value_cell, row))) for row in table.rows)
    return Table(table.title, columns, rows)


def evidence_figure(figure: measurement.Figure, case: str) -> Figure:
    """Give a figure of a record; its curves can be switched off by themselves.

    Parameters
    ----------
    figure
        The figure.
    case
        Name of its case, so that equal labels elsewhere in the page are left alone.
    """
    styles = _styles(figure.series)
    series = []
    for one in figure.series:
        style = styles.get(one.label, MethodStyle("", DASHED))
        name = f"{case}, {figure.name}, {one.label}"
        key = Key(name, one.label, style.color, style.marker)
        series.append(
            Series(
                key,
                tuple(_points(one, figure)),
                joined=one.style == "line",
                band=one.style == "line" and bool(one.low),
                dashed=one.reference,
                size=4.0 if one.reference and one.style == "line" else 7.0,
            )
        )
    marks = [Mark("x", at, label) for label, at in figure.x_marks]
    marks += [Mark("y", at, label) for label, at in figure.y_marks]
    chart = Chart(
        title=figure.title, x=_axis(figure.x), y=_axis(figure.y), series=tuple(series),
        marks=tuple(marks),
    )  # fmt: skip
    legend = tuple(one.key for one in series)
    return Figure("", (View(figure.title, (chart,)),), legend if len(legend) > 1 else ())


def _styles(series: Iterable[measurement.Series]) -> dict[str, MethodStyle]:
    """Give methods their own colour and marker, and other curves further ones; references none."""
    further = cycle(FURTHER_STYLES)
    return {
        one.label: method_styles([one.method])[one.method] if one.method else next(further)
        for one in series
        if not one.reference
    }


def _axis(axis: measurement.Axis) -> Axis:
    return Axis(f"{axis.name} ({axis.unit})" if axis.unit else axis.name, axis.scale)


def _points(series: measurement.Series, figure: measurement.Figure) -> Iterable[Point]:
    nothing: tuple[float | None, ...] = (None,) * len(series.x)
    lows, highs = series.low or nothing, series.high or nothing
    for x, y, low, high in zip(series.x, series.y, lows, highs, strict=True):
        text = f"{figure.x.name} {_said(x, figure.x.unit)}\n{figure.y.name} "
        text += _said(y, figure.y.unit)
        if low is not None and high is not None:
            text += f"\n{number(low)} .. {number(high)}"
        yield Point(x, _or_nan(y), _or_nan(low), _or_nan(high), text)


def _said(value: float | None, unit: str) -> str:
    return "–" if value is None else f"{value:.5g} {unit}".strip()


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value


def _value_cell(value: Value) -> Cell:
    if isinstance(value, str):
        return Cell(value)
    return number_cell(math.nan if value is None else float(value))


def _unit(unit: str) -> str:
    return f" {unit}" if unit else ""
