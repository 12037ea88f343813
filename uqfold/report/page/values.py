"""The numbers of a figure as a table: its text alternative."""

from __future__ import annotations

import math

from uqfold.report.page.blocks import Cell, Column, Figure, Number, Row, Table
from uqfold.report.page.chart import Chart, Point, Series

_DIGITS = 5


def values_table(figure: Figure) -> Table:
    """Give the points of the first view of a figure, one row each."""
    charts = figure.views[0].charts if figure.views else ()
    barred = any(not math.isnan(point.high) for chart in charts for point in chart.points())
    heads = ["series"]
    if len(charts) > 1:
        heads.append("panel")
    x, y = (charts[0].x.name, charts[0].y.name) if charts else ("x", "y")
    heads += [x or "x", y or "y", *(["low", "high"] if barred else [])]
    rows = tuple(
        _row(chart, series, point, panels=len(charts) > 1, barred=barred)
        for chart in charts
        for series in chart.series
        for point in series.points
    )
    said = figure.caption or (charts[0].title if charts else "none")
    columns = tuple(Column(head, numeric=head not in ("series", "panel")) for head in heads)
    return Table(f"Values: {said}", columns, rows, tools=False, show_caption=False)


def _row(chart: Chart, series: Series, point: Point, *, panels: bool, barred: bool) -> Row:
    cells = [Cell(series.key.label)]
    if panels:
        cells.append(Cell(chart.title))
    cells.append(number_cell(point.x))
    if chart.y.categories and math.isfinite(point.y):
        cells.append(Cell(chart.y.categories[round(point.y)]))
    else:
        cells.append(number_cell(point.y))
    if barred:
        cells += [number_cell(point.low), number_cell(point.high)]
    return Row(tuple(cells), keys=(series.key.name,))


def number_cell(value: float) -> Cell:
    """Give a number with five digits; a dash for NaN."""
    if math.isnan(value):
        return Cell("–", math.nan)
    text = f"{value:.{_DIGITS}g}"
    mantissa, e, exponent = text.partition("e")
    return Cell([Number(f"{mantissa}e{int(exponent)}" if e else text)], value)
