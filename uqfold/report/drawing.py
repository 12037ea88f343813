"""Drawing failure probabilities: curves of methods with their intervals, references with bands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.columns import Row
from uqfold.report.style import BAND_COLOR, REFERENCE_LINE, MethodStyle
from uqfold.report.wording import REFERENCE_STANDARD_ERRORS
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

UPPER_BOUND: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}
SMALLEST_PF = 1e-16
"""Failure probabilities below are not drawn."""


@dataclass(frozen=True)
class Curve:
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


def draw_method(
    axes: Axes, curve: Curve, style: MethodStyle, as_pf: bool, *, size: float, joined: bool
) -> None:
    """Draw what a method found over x, as reliability or as pf, with its intervals.

    An estimate of zero appears on a logarithmic axis as its upper bound, with an arrow down.
    """
    value, low, high = curve.values(as_pf)
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


def draw_reference(axes: Axes, reference: Curve, as_pf: bool) -> None:
    """Draw a reference and its band, as reliability or as pf."""
    value, low, high = reference.values(as_pf)
    axes.fill_between(reference.x, low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
    # on top: where methods agree their curves would hide it
    axes.plot(reference.x, value, **REFERENCE_LINE, zorder=3.0)


def reference_curve(rows: Sequence[Row]) -> Curve:
    """Give the reference and its band over T; thresholds without one leave gaps."""
    by_threshold = {row["threshold"]: row for row in rows if math.isfinite(row["threshold"])}
    own = [by_threshold[threshold] for threshold in sorted(by_threshold)]
    if all(math.isnan(row["reference_pf"]) for row in own):
        own = []
    pf = np.array([row["reference_pf"] for row in own])
    half = REFERENCE_STANDARD_ERRORS * np.array([row["reference_std_error"] for row in own])
    low, high = np.maximum(pf - half, SMALLEST_PF), np.minimum(pf + half, 1.0)
    return Curve(np.array([row["threshold"] for row in own]), pf, low, high)


def method_curve(rows: Sequence[Row], x: Sequence[float]) -> Curve:
    """Give pf and intervals of a method's rows, placed at x."""
    columns = ([row[name] for row in rows] for name in ("pf", "ci_low", "ci_high"))
    return Curve(np.array(x, dtype=np.float64), *(np.array(c, dtype=np.float64) for c in columns))


def set_logarithmic(axes: Axes, rows: Sequence[Row]) -> None:
    """Make the axis of pf logarithmic, with limits that show every estimate above zero."""
    values = [row[name] for row in rows for name in ("pf", "reference_pf", "ci_high")]
    positive = [value for value in values if value > SMALLEST_PF]
    axes.set_yscale("log")
    if positive:
        # long bars of estimates from a few failures are cut off rather than squeeze the rest
        lows = [row["ci_low"] for row in rows if row["ci_low"] > 0.2 * min(positive)]
        low, high = min(positive + lows), max(positive)
        margin = 1.05 * (high / low) ** 0.07
        axes.set_ylim(low / margin, high * margin)
