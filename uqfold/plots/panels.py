"""Legends below panels, and marks in named rows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance
from uqfold.plots.saving import figure_of
from uqfold.plots.style import COLUMN_INCHES, SOFT_COLOR, method_styles

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEGEND_ROW_INCHES = 0.17
CLOSE: Any = {"handlelength": 1.4, "handletextpad": 0.6, "columnspacing": 1.2}
"""How the entries of a legend stand."""


def legend_below(figure: Figure, handles: Sequence[Any]) -> None:
    """Put a legend below the panels, in as few rows as fit; the figure grows by these."""
    for rows in range(1, len(handles) + 1):
        # as few columns as these rows need, so that the last row is not nearly empty
        columns = math.ceil(len(handles) / rows)
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=columns, **CLOSE)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            figure.set_figheight(figure.get_figheight() + LEGEND_ROW_INCHES * rows)
            return
        legend.remove()


def one_legend(figure: Figure) -> None:
    """Put one legend below the panels in the place of their own, with each name once.

    Parameters
    ----------
    figure
        A figure into whose axes functions of `uqfold.plots` have drawn.
    """
    named: dict[str, Any] = {}
    for axes in figure_of(figure).axes:
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True):
            named.setdefault(name, handle)
        if axes.get_legend() is not None:
            axes.get_legend().remove()
    legend_below(figure, list(named.values()))


def axes_or_new(ax: Axes | None, width: float = COLUMN_INCHES, height: float = 2.6) -> Axes:
    """Return the axes, or those of a new figure, by default as wide as a column of print."""
    from matplotlib.axes import Axes

    from uqfold.plots.shown import ShownAxes, ShownFigure

    if ax is not None:
        checked: Axes = instance("ax", ax, Axes, "give Axes of matplotlib")
        return checked
    figure = ShownFigure(figsize=(width, height), layout="constrained")
    return figure.add_subplot(axes_class=ShownAxes)


def key(label: str, **look: Any) -> Any:
    """Return an entry of a legend: a line, a mark or both."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **look)


def mark(label: str, hollow: bool = False, **look: Any) -> Any:
    """Return an entry of a legend that is a mark, filled or hollow."""
    face = {"markerfacecolor": "white"} if hollow else {}
    return key(label, **{"marker": "o", **look, **face, "linestyle": ""})


def draw_rows(axes: Axes, frame: pd.DataFrame, kinds: Sequence[str] = ()) -> list[Any]:
    """Draw values with their intervals in named rows from top to bottom, series beside each other.

    Parameters
    ----------
    frame
        Columns ``row`` and ``series``, names of both; ``value``, ``low`` and ``high``.
    kinds
        Values of the column ``kind``: the first has filled marks, the second hollow ones.

    Returns
    -------
    list
        Entries of a legend: the series, and the kinds.
    """
    names, looks = list(frame["row"].unique()), method_styles(frame["series"].unique())
    axes.set_yscale("linear")  # rows have numbers, whatever was drawn here before
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    beside = list(product(looks.items(), kinds or [""]))
    places = np.linspace(-0.25, 0.25, len(beside)) if len(beside) > 1 else [0.0]
    for ((series, look), kind), place in zip(beside, places, strict=True):
        own = frame[frame["series"] == series]
        own = own[own["kind"] == kind] if kind else own
        y = own["row"].map(names.index) + place
        axes.hlines(y, own["low"], own["high"], color=look.color, linewidth=1.2)
        face = "white" if kind in kinds[1:] else look.color
        axes.plot(own["value"], y, look.marker, color=look.color, markersize=4.5,
                  markerfacecolor=face, label=series)  # fmt: skip
    handles = [mark(name, marker=look.marker, color=look.color) for name, look in looks.items()]
    return handles + [mark(kind, hollow=kind in kinds[1:], color=SOFT_COLOR) for kind in kinds]


def percent_axis(axes: Axes, smallest: float, largest: float) -> None:
    """Make an axis of relative errors logarithmic, with ticks in per cent.

    The smallest tick stands for all errors that are smaller still.
    """
    from matplotlib.ticker import NullFormatter

    def written(value: float, _: object) -> str:
        return f"{'≤ ' if value <= 1.01 * smallest else ''}{100.0 * value:g} %"

    axes.set(yscale="log", ylim=(0.8 * smallest, largest))
    axes.yaxis.set_major_formatter(written)
    axes.yaxis.set_minor_formatter(NullFormatter())
