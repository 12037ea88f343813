"""Figures of panels one above another with one legend below.

One column of panels is as wide as a column of print.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance
from uqfold.plots.style import COLUMN_INCHES, MethodStyle, figure_settings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL_INCHES = 2.4
"""Width of a panel where several stand side by side."""
LEGEND_COLUMN_INCHES = 1.55
LEGEND_ROW_INCHES = 0.17
CLOSE: dict[str, float] = {"handlelength": 1.4, "handletextpad": 0.5, "columnspacing": 0.9}
SMALLEST_PF = 1e-8
"""Failure probabilities below are not drawn unless a figure asks for them."""
HOLLOW: Any = {"markerfacecolor": "white", "markersize": 4.2, "markeredgewidth": 0.8}
"""Marks with error bars."""


@figure_settings()
def stacked(heights: Sequence[float], columns: int, handles: Sequence[Any]) -> tuple[Figure, Any]:
    """Make panels that share x in a column and y in a row.

    Parameters
    ----------
    heights
        Height of each row of panels (inches).
    columns
        How many panels stand side by side.
    handles
        What the legend shows.

    Returns
    -------
    tuple[matplotlib.figure.Figure, numpy.ndarray]
        The figure and its axes (rows, columns).
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    width = COLUMN_INCHES if columns == 1 else PANEL_INCHES * columns
    fitting = max(1, int(width / LEGEND_COLUMN_INCHES))
    rows = math.ceil(len(handles) / fitting)
    height = sum(heights) + 0.55 + LEGEND_ROW_INCHES * rows
    figure = Figure(figsize=(width, height), layout="constrained")
    grid = figure.subplots(
        len(heights), columns, squeeze=False, sharex=True, sharey="row", height_ratios=heights
    )
    for axes in grid[-1]:
        axes.xaxis.set_major_locator(MaxNLocator(7 if columns == 1 else 5, steps=[1, 2, 5, 10]))
    if handles:
        # as few columns as these rows need, so that the last row is not nearly empty
        legend_below(figure, handles, math.ceil(len(handles) / rows))
    return figure, grid


def legend_below(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """Put a legend below the panels: closer together, then in fewer columns, until it fits."""
    tries = [(count, look) for count in range(columns, 0, -1) for look in ({}, CLOSE)]
    for count, look in tries:
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=count, **look)
        if legend.get_window_extent().width <= figure.bbox.width or (count, look) == tries[-1]:
            break
        legend.remove()
    more = math.ceil(len(handles) / count) - math.ceil(len(handles) / columns)
    figure.set_figheight(figure.get_figheight() + LEGEND_ROW_INCHES * more)


def axes_or_new(ax: Axes | None, width: float = COLUMN_INCHES, height: float = 2.6) -> Axes:
    """Return the axes, or those of a new figure, by default as wide as a column of print."""
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    if ax is not None:
        checked: Axes = instance("ax", ax, Axes, "give Axes of matplotlib")
        return checked
    return Figure(figsize=(width, height), layout="constrained").subplots()


def key(label: str, **look: Any) -> Any:
    """Return an entry of a legend: a line, a mark or both."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **look)


def draw_bars(axes: Axes, x: Any, y: Any, bars: Any, marker: str, color: str) -> None:
    """Draw hollow marks with error bars (n,), or (2, n): below and above."""
    axes.errorbar(x, y, yerr=bars, fmt=marker, color=color, elinewidth=0.8, capsize=1.8,
                  zorder=3.5, **HOLLOW)  # fmt: skip


def draw_judged(axes: Axes, x: Any, errors: Any, hollow: Any, style: MethodStyle) -> None:
    """Draw a curve of errors whose marks are hollow where the reference cannot judge them."""
    axes.plot(x, errors, "-", color=style.color, linewidth=0.9)
    for chosen, face in ((~hollow, style.color), (hollow, "white")):
        axes.plot(x[chosen], errors[chosen], style.marker, color=style.color, markersize=3.6,
                  markerfacecolor=face, markeredgewidth=0.9)  # fmt: skip


def draw_intervals(
    axes: Axes, y: Any, value: Any, low: Any, high: Any, style: MethodStyle, *,
    hollow: bool = False, label: str = "",
) -> None:  # fmt: skip
    """Draw values (n,) with their intervals along x, in rows at y (n,)."""
    axes.hlines(y, low, high, color=style.color, linewidth=1.2)
    face = "white" if hollow else style.color
    axes.plot(value, y, style.marker, color=style.color, markersize=4.5, markerfacecolor=face,
              label=label)  # fmt: skip


def beside(k: int, count: int) -> float:
    """Return how far the k-th of some marks in a row stands from its middle."""
    return 0.0 if count == 1 else 0.5 * (k / (count - 1) - 0.5)


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Name rows from top to bottom: 0 is the first."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")


def limit_pf(axes: Axes, values: Iterable[float], smallest: float | None) -> None:
    """Make an axis of pf logarithmic, from the smallest value shown up to one.

    `smallest` is its lower end; None: that of the values, but not below `SMALLEST_PF`.
    """
    axes.set_yscale("log")
    if smallest is None:
        lowest = min((value for value in values if value > 0.0), default=SMALLEST_PF)
        smallest = 10.0 ** np.floor(np.log10(max(lowest, SMALLEST_PF)) - 0.1)
    axes.set_ylim(smallest, 1.6)


def limit_errors(axes: Axes, smallest: float, largest: float) -> None:
    """Make an axis of relative errors logarithmic, with ticks in per cent."""
    from matplotlib.ticker import NullFormatter

    axes.set(yscale="log", ylim=(smallest, largest))
    axes.yaxis.set_major_formatter(lambda value, _: f"{100.0 * value:g} %")
    axes.yaxis.set_minor_formatter(NullFormatter())
