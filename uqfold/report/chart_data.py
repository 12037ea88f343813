"""The figures of a comparison as data for a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.comparison.columns import Row
from uqfold.comparison.records import Records
from uqfold.report.clouds import Cloud, cost_limits, error_clouds, error_limits, side_steps
from uqfold.report.drawing import SMALLEST_PF
from uqfold.report.page.blocks import Figure, View
from uqfold.report.page.chart import DASHED, Axis, Band, Chart, Key, Point, Series
from uqfold.report.style import method_styles
from uqfold.report.wording import (
    REFERENCE_STANDARD_ERRORS,
    count_text,
    criterion_key,
    criterion_text,
    finite,
    panel_key,
    panel_text,
    percent,
    probability,
    quantity,
    reference_resolution,
    scientific,
)

PF_VIEW, RELIABILITY_VIEW = "failure probability, logarithmic", "reliability, linear"
REFERENCE = Key("reference", "reference", marker=DASHED)


def method_keys(records: Records) -> dict[str, Key]:
    """Give every method that has rows its key: colour and marker as in all figures."""
    return {
        label: Key(f"method {label}", label, style.color, style.marker)
        for label, style in method_styles(records.finished).items()
    }


def panel_keys(records: Records) -> dict[tuple[float | None, str], Key]:
    """Give every combination of tau and missions its key."""
    unit = records.header.response_unit
    panels = dict.fromkeys(panel_key(row) for row in records.rows)
    texts = {panel: panel_text(panel, unit) for panel in panels}
    return {panel: Key(f"criterion {text}", text) for panel, text in texts.items()}


def curves_figure(records: Records, values_at: str) -> Figure | None:
    """Give pf and reliability over the threshold: one panel for each tau and missions.

    With a single threshold the methods stand below each other instead.

    Parameters
    ----------
    records
        The comparison.
    values_at
        Anchor of the table that holds the numbers.

    Returns
    -------
    Figure or None
        None where no method has an answer at a finite threshold.
    """
    rows = [row for row in records.rows if math.isfinite(row["threshold"])]
    if all(math.isnan(row["pf"]) for row in rows):
        return None
    several = len({row["threshold"] for row in rows}) > 1
    keys, panels = method_keys(records), panel_keys(records)
    build = _curve_chart if several else _place_chart
    views = tuple(
        View(
            name,
            tuple(
                build(records, [row for row in rows if panel_key(row) == panel], key, keys, as_pf)
                for panel, key in panels.items()
            ),
        )
        for name, as_pf in ((PF_VIEW, True), (RELIABILITY_VIEW, False))
    )
    referenced = any(not math.isnan(row["reference_pf"]) for row in rows)
    notes = []
    if referenced:
        band = f"the reference ± {REFERENCE_STANDARD_ERRORS:g} of its standard errors"
        notes.append(("stripe", band))
    if any(row["pf"] < SMALLEST_PF < row["ci_high"] for row in rows):
        notes.append(("arrow", "no failure seen: upper end of the interval"))
    over = "over the threshold" if several else "by method"
    return Figure(
        caption=f"Failure probability and reliability {over}. Bars are the intervals that a "
        "method states itself; a method without bars states none.",
        views=views,
        legend=(*keys.values(), *([REFERENCE] if referenced else [])) if several else (),
        notes=tuple(notes),
        values_at=values_at,
    )


def cost_figure(records: Records, values_at: str) -> Figure | None:
    """Give the error of every answer over the evaluations spent on it; None without references."""
    clouds = error_clouds(records)
    if not clouds:
        return None
    keys = method_keys(records)
    low, high = error_limits(clouds)
    steps = side_steps(clouds, *cost_limits(clouds))
    chart = Chart(
        title=f"{records.header.problem}: error against cost",
        x=Axis("evaluations of the model", "log"),
        y=Axis("relative error of the failure probability", "log", percent=True),
        series=tuple(
            series
            for cloud in clouds
            for series in _cloud_series(records, cloud, keys[cloud.label], steps[cloud.label], low)
        ),
        bands=_resolution_bands(records, low),
        limits=(low, high),
    )
    notes = [("dot-large", "median of the criteria"), ("dot-full", "one criterion")]
    if not all(cloud.judged.all() for cloud in clouds):
        notes.append(("dot-hollow", "one criterion, below two standard errors of its reference"))
    if chart.bands:
        notes.append(("stripe", "where the references cannot judge"))
    return Figure(
        caption="Error of Eq. (49), |pf - reference| / reference, against the evaluations of the "
        "model. Methods of equal cost stand side by side.",
        views=(View("error", (chart,)),),
        legend=tuple(keys[cloud.label] for cloud in clouds),
        notes=tuple(notes),
        values_at=values_at,
    )


def _curve_chart(
    records: Records, rows: Sequence[Row], panel: Key, keys: dict[str, Key], as_pf: bool
) -> Chart:
    header = records.header
    series = []
    for i, (label, key) in enumerate(keys.items()):
        own = sorted((r for r in rows if r["label"] == label), key=lambda r: float(r["threshold"]))
        points = tuple(_point(row, row["threshold"], header.response_unit, as_pf) for row in own)
        barred = any(not math.isnan(point.high) for point in points)
        # markers shrink from method to method, so that those on one spot stay visible
        size = 10.0 - 4.5 * i / max(len(keys) - 1, 1)
        series.append(Series(key, points, joined=not barred, size=size))
    unit = f" ({header.response_unit})" if header.response_unit else ""
    return Chart(
        title=panel.label,
        x=Axis(f"threshold T on {header.response}{unit}"),
        y=_value_axis(as_pf),
        series=(*series, *_reference_series(rows, header.response_unit, as_pf)),
        keys=(panel.name,),
        limits=_pf_limits(rows) if as_pf else None,
    )


def _place_chart(
    records: Records, rows: Sequence[Row], panel: Key, keys: dict[str, Key], as_pf: bool
) -> Chart:
    unit = records.header.response_unit
    series = []
    for i, (label, key) in enumerate(keys.items()):
        points = [_point(row, float(i), unit, as_pf) for row in rows if row["label"] == label]
        swapped = tuple(replace(point, x=point.y, y=point.x) for point in points)
        series.append(Series(key, swapped, joined=False, size=9.0))
    bands = []
    for point in (point for one in _reference_series(rows, unit, as_pf) for point in one.points):
        bands.append(Band("x", point.low, point.high))
    threshold = quantity(rows[0]["threshold"], unit) if rows else ""
    axis = _value_axis(as_pf)
    return Chart(
        title=f"T = {threshold}, {panel.label}",
        x=replace(axis, name=axis.name),
        y=Axis("", categories=tuple(keys)),
        series=tuple(series),
        bands=tuple(bands),
        bars="x",
        keys=(panel.name,),
    )


def _value_axis(as_pf: bool) -> Axis:
    return Axis("failure probability", "log") if as_pf else Axis("reliability")


def _point(row: Row, x: float, unit: str, as_pf: bool) -> Point:
    """Give an answer as a point; one of zero on a logarithmic axis is a bound without a point."""
    pf, low, high = row["pf"], row["ci_low"], row["ci_high"]
    text = f"{criterion_text(criterion_key(row), unit)}\n{_told(row)}"
    if as_pf:
        hidden = pf < SMALLEST_PF
        return Point(x, math.nan if hidden else pf, low, high, text)
    reliability = row["reliability"]
    return Point(x, reliability, 1.0 - high, 1.0 - low, text)


def _told(row: Row) -> str:
    said = [f"pf = {probability(row['pf'], 4)}"]
    if not math.isnan(row["ci_low"] + row["ci_high"]):
        ends = " .. ".join(probability(row[end], 3) for end in ("ci_low", "ci_high"))
        said.append(f"interval {ends}")
    if not math.isnan(row["error"]):
        said.append(f"error {percent(row['error'])}")
    said.append(row["status"].replace("_", " "))
    return "\n".join(said)


def _reference_series(rows: Sequence[Row], unit: str, as_pf: bool) -> list[Series]:
    by_threshold = {row["threshold"]: row for row in rows if not math.isnan(row["reference_pf"])}
    points = []
    for threshold in sorted(by_threshold):
        row = by_threshold[threshold]
        pf = row["reference_pf"]
        half = REFERENCE_STANDARD_ERRORS * row["reference_std_error"]
        low, high = max(pf - half, SMALLEST_PF), min(pf + half, 1.0)
        text = (
            f"{criterion_text(criterion_key(row), unit)}\n"
            f"pf = {probability(pf, 4)} ± {scientific(row['reference_std_error'], 2)}"
        )
        if as_pf:
            points.append(Point(threshold, pf, low, high, text))
        else:
            points.append(Point(threshold, 1.0 - pf, 1.0 - high, 1.0 - low, text))
    if not points:
        return []
    return [Series(REFERENCE, tuple(points), band=True, dashed=True, size=3.5)]


def _pf_limits(rows: Sequence[Row]) -> tuple[float, float] | None:
    values = [row[name] for row in rows for name in ("pf", "reference_pf", "ci_high")]
    positive = [value for value in values if SMALLEST_PF < value <= 1.0]
    if not positive:
        return None
    # long bars of estimates from a few failures are cut off rather than squeeze the rest
    lows = [row["ci_low"] for row in rows if row["ci_low"] > 0.2 * min(positive)]
    low, high = min(positive + lows), max(positive)
    margin = 1.15 * (high / low) ** 0.05
    return low / margin, high * margin


def _cloud_series(
    records: Records, cloud: Cloud, key: Key, step: float, low: float
) -> list[Series]:
    unit = records.header.response_unit
    rows = [r for r in records.rows if r["label"] == cloud.label and not math.isnan(r["error"])]
    points = tuple(
        Point(
            step * float(cost),
            # an error of exactly zero is drawn on the lower edge
            max(float(error), low),
            text=f"{criterion_text(criterion_key(row), unit)}\n{_told(row)}\n"
            f"{count_text(row['n_evals_row'])} evaluations",
            hollow=not judged,
        )
        for row, cost, error, judged in zip(
            rows, cloud.n_evals, cloud.error, cloud.judged, strict=True
        )
    )
    with np.errstate(over="ignore"):
        median = float(np.median(cloud.error))
    typical = Point(
        step * cloud.cost,
        max(median, low),
        text=f"median error {percent(median)}\n{cloud.cost:,.0f} evaluations",
        hollow=True,
    )
    return [
        Series(key, (typical,), joined=False, size=15.0),
        Series(key, points, joined=False, size=6.0),
    ]


def _resolution_bands(records: Records, low: float) -> tuple[Band, ...]:
    levels = finite(reference_resolution(row) for row in records.rows)
    ends = ((max(levels), True), (min(levels), False)) if levels else ()
    return tuple(Band("y", low, level, faint) for level, faint in ends if level > low)
