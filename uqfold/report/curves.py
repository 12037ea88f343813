"""Reliability curves: every method's answer over the threshold T, with the reference behind."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.columns import Row
from uqfold.comparison.records import Records
from uqfold.report.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    MethodStyle,
    figure_settings,
    method_styles,
)
from uqfold.report.wording import REFERENCE_STANDARD_ERRORS, panel_key, panel_text, quantity
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_INCHES = 8.0
ROW_INCHES = 2.6
FRAME_INCHES = 1.1
UPPER_BOUND: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}
SMALLEST_PF = 1e-16
"""Failure probabilities below are not drawn."""


@dataclass(frozen=True)
class _Curve:
    """Failure probabilities over x (n,), with bounds (n,) that are NaN where there are none."""

    x: FloatArray
    pf: FloatArray
    low: FloatArray
    high: FloatArray

    def values(self, as_pf: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Give value, lower and upper bound of pf, or of the reliability."""
        if as_pf:
            return self.pf, self.low, self.high
        return 1.0 - self.pf, 1.0 - self.high, 1.0 - self.low


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
                _set_logarithmic(axes, rows)
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
    _draw_reference(axes, _reference(rows), as_pf)
    for i, (label, style) in enumerate(styles.items()):
        own = [row for row in rows if row["label"] == label and math.isfinite(row["threshold"])]
        own.sort(key=lambda row: float(row["threshold"]))
        curve = _curve(own, [row["threshold"] for row in own])
        _draw_method(axes, curve, style, as_pf, size=_nested_size(i, len(styles)), joined=True)


def _draw_points(
    axes: Axes, rows: Sequence[Row], styles: Mapping[str, MethodStyle], as_pf: bool
) -> None:
    reference = _reference(rows)
    edges = np.array([-0.5, len(styles) - 0.5])
    wide = [np.resize(part, 2) for part in (reference.pf, reference.low, reference.high)]
    if reference.x.size:
        _draw_reference(axes, _Curve(edges, *wide), as_pf)
    for i, (label, style) in enumerate(styles.items()):
        own = [row for row in rows if row["label"] == label]
        _draw_method(axes, _curve(own, [i] * len(own)), style, as_pf, size=6.0, joined=False)
    axes.set_xlim(*edges)
    axes.set_xticks(range(len(styles)), list(styles), rotation=20, ha="right")
    axes.grid(visible=False, axis="x")


def _draw_method(
    axes: Axes, curve: _Curve, style: MethodStyle, as_pf: bool, *, size: float, joined: bool
) -> None:
    value, low, high = curve.values(as_pf)
    # an axis without zero shows the upper bound of an estimate of zero, with an arrow down
    hidden = as_pf & (curve.pf < SMALLEST_PF)
    bars = np.vstack([value - low, high - value])
    has_bar = np.isfinite(bars).all(axis=0) & ~hidden
    axes.plot(
        curve.x,
        np.where(hidden, np.nan, value),
        # points with error bars of their own are not joined
        linestyle="-" if joined and not has_bar.any() else "",
        color=style.color,
        marker=style.marker,
        markersize=size,
        markerfacecolor="white",
        markeredgewidth=1.1,
    )
    axes.errorbar(
        curve.x[has_bar],
        value[has_bar],
        yerr=np.maximum(bars[:, has_bar], 0.0),
        fmt="none",
        ecolor=style.color,
        elinewidth=1.0,
        capsize=2.5,
    )
    bounded = hidden & (high > SMALLEST_PF)
    axes.plot(curve.x[bounded], high[bounded], **UPPER_BOUND, color=style.color)


def _draw_reference(axes: Axes, reference: _Curve, as_pf: bool) -> None:
    value, low, high = reference.values(as_pf)
    axes.fill_between(reference.x, low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
    # on top: where methods agree their curves would hide it
    axes.plot(reference.x, value, **REFERENCE_LINE, zorder=3.0)


def _reference(rows: Sequence[Row]) -> _Curve:
    """Give the reference and its band over T; thresholds without one leave gaps."""
    by_threshold = {row["threshold"]: row for row in rows if math.isfinite(row["threshold"])}
    own = [by_threshold[threshold] for threshold in sorted(by_threshold)]
    if all(math.isnan(row["reference_pf"]) for row in own):
        own = []
    pf = np.array([row["reference_pf"] for row in own])
    half = REFERENCE_STANDARD_ERRORS * np.array([row["reference_std_error"] for row in own])
    low, high = np.maximum(pf - half, SMALLEST_PF), np.minimum(pf + half, 1.0)
    return _Curve(np.array([row["threshold"] for row in own]), pf, low, high)


def _curve(rows: Sequence[Row], x: Sequence[float]) -> _Curve:
    columns = ([row[name] for row in rows] for name in ("pf", "ci_low", "ci_high"))
    return _Curve(np.array(x, dtype=np.float64), *(np.array(c, dtype=np.float64) for c in columns))


def _set_logarithmic(axes: Axes, rows: Sequence[Row]) -> None:
    values = [row[name] for row in rows for name in ("pf", "reference_pf", "ci_high")]
    positive = [value for value in values if value > SMALLEST_PF]
    axes.set_yscale("log")
    if positive:
        # long bars of estimates from a few failures are cut off rather than squeeze the rest
        lows = [row["ci_low"] for row in rows if row["ci_low"] > 0.2 * min(positive)]
        low, high = min(positive + lows), max(positive)
        margin = 1.05 * (high / low) ** 0.07
        axes.set_ylim(low / margin, high * margin)


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
