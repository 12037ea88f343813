"""Reliability curves: every method's answer over the threshold T, with the reference behind."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from uqfold.checks import instance
from uqfold.comparison.columns import Row
from uqfold.comparison.records import Records
from uqfold.report.drawing import (
    SMALLEST_PF,
    UPPER_BOUND,
    Curve,
    draw_method,
    draw_reference,
    method_curve,
    reference_curve,
    set_logarithmic,
)
from uqfold.report.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    MethodStyle,
    figure_settings,
    method_styles,
)
from uqfold.report.wording import REFERENCE_STANDARD_ERRORS, panel_key, panel_text, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_INCHES = 8.0
ROW_INCHES = 2.6
FRAME_INCHES = 1.1


MOST_NESTED = 5
"""More methods than this stand side by side at each threshold, not on top of each other."""
GROUPED_SIZE = 4.0


@figure_settings()
def reliability_curves(records: Records) -> Figure | None:
    """Draw R(T), and pf(T) on a logarithmic axis beside it: one row of panels per tau and missions.

    Where there is only one threshold, the methods stand side by side as points.

    Parameters
    ----------
    records
        The comparison; rows without an answer leave gaps.

    Returns
    -------
    matplotlib.figure.Figure or None
        The figure, bound to no window; None where no method has an answer.
    """
    from matplotlib.figure import Figure

    instance("records", records, Records, "give Records")
    if all(math.isnan(row["pf"]) for row in records.rows):
        return None

    header = records.header
    panels: dict[tuple[float | None, str], list[Row]] = {}
    for row in records.rows:
        panels.setdefault(panel_key(row), []).append(row)
    thresholds = {row["threshold"] for row in records.rows}
    styles = method_styles(records.finished)

    figure = Figure(
        figsize=(WIDTH_INCHES, ROW_INCHES * len(panels) + FRAME_INCHES), layout="constrained"
    )
    grid = figure.subplots(len(panels), 2, squeeze=False)
    for (key, rows), pair in zip(panels.items(), grid, strict=True):
        pair[0].set_title(panel_text(key, header.response_unit), loc="left")
        for axes, as_pf in zip(pair, (False, True), strict=True):
            axes.set_ylabel("failure probability" if as_pf else "reliability")
            if as_pf:
                set_logarithmic(axes, rows)
            if len(thresholds) > 1:
                _draw_curves(axes, rows, styles, as_pf)
            else:
                _draw_points(axes, rows, styles, as_pf)
    for axes in grid[-1]:
        unit = f" ({header.response_unit})" if header.response_unit else ""
        one = f"T = {quantity(min(thresholds), header.response_unit)}"
        axes.set_xlabel(f"threshold T on {header.response}{unit}" if len(thresholds) > 1 else one)
    # beside a single threshold the methods are named on the axis
    _add_legend(figure, records, styles if len(thresholds) > 1 else {})
    figure.suptitle(f"{header.problem}: reliability", x=0.012, ha="left", fontweight="bold")
    return figure


def _draw_curves(
    axes: Axes, rows: Sequence[Row], styles: Mapping[str, MethodStyle], as_pf: bool
) -> None:
    reference = reference_curve(rows)
    crowded = len(styles) > MOST_NESTED
    width = _group_width(rows) if crowded else 0.0
    if crowded:
        _draw_group_references(axes, reference, width, as_pf)
    else:
        draw_reference(axes, reference, as_pf)
    for i, (label, style) in enumerate(styles.items()):
        own = [row for row in rows if row["label"] == label and math.isfinite(row["threshold"])]
        own.sort(key=lambda row: float(row["threshold"]))
        step = width * ((i + 0.5) / len(styles) - 0.5)
        curve = method_curve(own, [row["threshold"] + step for row in own])
        size = GROUPED_SIZE if crowded else _nested_size(i, len(styles))
        draw_method(axes, curve, style, as_pf, size=size, joined=not crowded)


def _group_width(rows: Sequence[Row]) -> float:
    """Give the width that the methods of one threshold may take."""
    thresholds = np.unique([row["threshold"] for row in rows if math.isfinite(row["threshold"])])
    return 0.8 * float(np.diff(thresholds).min()) if thresholds.size > 1 else 0.0


def _draw_group_references(axes: Axes, reference: Curve, width: float, as_pf: bool) -> None:
    """Draw the reference of every threshold, with its band, across the methods that stand there."""
    axes.plot(reference.x, reference.values(as_pf)[0], color=BAND_COLOR, linewidth=0.8, zorder=0.4)
    for x, *values in zip(reference.x, reference.pf, reference.low, reference.high, strict=True):
        edges = np.array([x - 0.5 * width, x + 0.5 * width])
        draw_reference(axes, Curve(edges, *(np.resize(value, 2) for value in values)), as_pf)


def _draw_points(
    axes: Axes, rows: Sequence[Row], styles: Mapping[str, MethodStyle], as_pf: bool
) -> None:
    reference = reference_curve(rows)
    edges = np.array([-0.5, len(styles) - 0.5])
    wide = [np.resize(part, 2) for part in (reference.pf, reference.low, reference.high)]
    if reference.x.size:
        draw_reference(axes, Curve(edges, *wide), as_pf)
    for i, (label, style) in enumerate(styles.items()):
        own = [row for row in rows if row["label"] == label]
        draw_method(axes, method_curve(own, [i] * len(own)), style, as_pf, size=6.0, joined=False)
    axes.set_xlim(*edges)
    axes.set_xticks(range(len(styles)), list(styles), rotation=20, ha="right")
    axes.grid(visible=False, axis="x")


def _nested_size(index: int, count: int) -> float:
    """Shrink the markers from method to method, so that those on one spot stay visible."""
    return 8.5 - 5.0 * index / max(count - 1, 1)


def _add_legend(figure: Figure, records: Records, styles: Mapping[str, MethodStyle]) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Artist] = [
        Line2D(
            [],
            [],
            color=style.color,
            marker=style.marker,
            markerfacecolor="white",
            markersize=6.5,
            label=label,
        )
        for label, style in styles.items()
    ]
    if any(not math.isnan(row["reference_pf"]) for row in records.rows):
        band = f"its ± {REFERENCE_STANDARD_ERRORS:g} standard errors"
        handles += [
            Line2D([], [], **REFERENCE_LINE, label="reference"),
            Patch(color=BAND_COLOR, label=band),
        ]
    if any(row["pf"] < SMALLEST_PF < row["ci_high"] for row in records.rows):
        handles.append(Line2D([], [], **UPPER_BOUND, color="#555555", label="pf = 0: upper bound"))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 4))
