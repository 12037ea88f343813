"""Figures of panels one above another, with one legend below: the frame that kinds share.

One column of panels is as wide as a column of print, several are a page wide at most.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.report.style import COLUMN_INCHES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL_INCHES = 2.4
"""Width of a panel where several stand side by side."""
LEGEND_COLUMN_INCHES = 1.55
LEGEND_ROW_INCHES = 0.17
TIGHT: dict[str, float] = {"handlelength": 1.4, "handletextpad": 0.5, "columnspacing": 0.9}
X_LABEL_INCHES = 0.45
X_TICKS = (7, 5)
"""At most so many steps between ticks of a single panel, and of several side by side."""
SMALLEST_PF = 1e-8
"""Failure probabilities below are not drawn unless a figure asks for them."""


def stacked_panels(
    heights: Sequence[float], columns: int, handles: Sequence[Any]
) -> tuple[Figure, Any]:
    """Make a figure of panels that share x in a column and y in a row.

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
    # as few columns as these rows need, so that the last row is not nearly empty
    legend_columns = math.ceil(len(handles) / max(rows, 1))
    height = sum(heights) + X_LABEL_INCHES + LEGEND_ROW_INCHES * rows + 0.1
    figure = Figure(figsize=(width, height), layout="constrained")
    grid = figure.subplots(
        len(heights), columns, squeeze=False, sharex=True, sharey="row", height_ratios=heights
    )
    for axes in grid[-1]:
        axes.xaxis.set_major_locator(MaxNLocator(X_TICKS[columns > 1], steps=[1, 2, 5, 10]))
    if handles:
        _add_legend(figure, handles, legend_columns)
    return figure, grid


def _add_legend(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """Put a legend below the panels: closer together, then in fewer columns, until it fits."""
    tries = [(ncols, look) for ncols in range(columns, 0, -1) for look in ({}, TIGHT)]
    for ncols, look in tries:
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=ncols, **look)
        if legend.get_window_extent().width <= figure.bbox.width or (ncols, look) == tries[-1]:
            break
        legend.remove()
    more = math.ceil(len(handles) / ncols) - math.ceil(len(handles) / columns)
    figure.set_figheight(figure.get_figheight() + LEGEND_ROW_INCHES * more)


def threshold_label(response: str, unit: str) -> str:
    """Give the label of an axis of thresholds."""
    return f"threshold $T$ on {response}{f' ({unit})' if unit else ''}"


def limit_pf(axes: Axes, values: Iterable[float], smallest: float | None) -> None:
    """Make an axis of pf logarithmic, from the smallest value shown up to one.

    Parameters
    ----------
    axes
        The axes.
    values
        What is drawn.
    smallest
        Lower end; None: that of the values, but not below `SMALLEST_PF`.
    """
    axes.set_yscale("log")
    if smallest is None:
        shown = [value for value in values if value > 0.0]
        lowest = min(shown, default=SMALLEST_PF)
        smallest = 10.0 ** np.floor(np.log10(max(lowest, SMALLEST_PF)) - 0.1)
    axes.set_ylim(smallest, 1.6)
