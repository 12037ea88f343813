"""Estimates by simulation as marks with their intervals, beside the curves of other methods."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.report.drawing import UPPER_BOUND
from uqfold.report.style import MethodStyle
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

LABEL = "simulation, 95 %"
NONE_FAILED = "no failure: upper end"
_LOOK: Any = {
    "markerfacecolor": "white",
    "markersize": 4.2,
    "markeredgewidth": 0.8,
}


def draw_estimates(
    axes: Axes, rows: pd.DataFrame, style: MethodStyle, *, as_pf: bool, color: str = "black"
) -> None:
    """Draw estimates as reliability or as pf, each with its interval.

    Parameters
    ----------
    axes
        Where.
    rows
        Rows of a run.
    style
        Of the curve that they belong to; its marker is taken.
    as_pf
        Whether to draw pf. An estimate of zero is its upper bound then, with an arrow down.
    color
        Of edges and bars.
    """
    shown = rows
    if as_pf:
        none = rows[rows["pf"] == 0.0]
        axes.plot(none["threshold"], none["ci_high"], color=color, **UPPER_BOUND)
        shown = rows[rows["pf"] > 0.0]
    y = shown["pf" if as_pf else "reliability"].to_numpy()
    low, high = shown["ci_low"].to_numpy(), shown["ci_high"].to_numpy()
    if not as_pf:
        low, high = 1.0 - high, 1.0 - low
    draw_marks(axes, shown["threshold"], y, np.array([y - low, high - y]), style, color)


def draw_marks(
    axes: Axes,
    x: Any,
    y: FloatArray,
    bars: FloatArray,
    style: MethodStyle,
    color: str = "black",
) -> None:
    """Draw marks at (x, y) with bars: lengths (n,), or below and above (2, n)."""
    axes.errorbar(
        x,
        y,
        yerr=np.maximum(np.nan_to_num(bars), 0.0),
        fmt=style.marker,
        color=color,
        ecolor=color,
        elinewidth=0.8,
        capsize=1.8,
        zorder=3.0,
        **_LOOK,
    )


def mark_handles(rows: pd.DataFrame, *, as_pf: bool) -> list[Any]:
    """Give the entries of a legend for estimates: marks, and arrows if any are drawn.

    Parameters
    ----------
    rows
        The estimates.
    as_pf
        Whether pf is drawn.
    """
    from matplotlib.lines import Line2D

    if rows.empty:
        return []
    handles = [Line2D([], [], linestyle="", marker="o", label=LABEL, color="black", **_LOOK)]
    if as_pf and (rows["pf"] == 0.0).any():
        handles.append(arrow_handle(NONE_FAILED))
    return handles


def arrow_handle(label: str) -> Any:
    """Give the entry of a legend for arrows that point down from an upper end of pf."""
    from matplotlib.lines import Line2D

    return Line2D([], [], color="black", label=label, **UPPER_BOUND)
