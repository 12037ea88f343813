"""Sets of points with error bars, a reference with its band, and limits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal, get_args

from uqfold.checks import choice, mapping, or_none, real, refused, text
from uqfold.plots.panels import axes_or_new
from uqfold.plots.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    SOFT_COLOR,
    figure_settings,
    method_styles,
)
from uqfold.plots.telling import gid, tell

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

Log = Literal["", "x", "y", "xy"]
REFERENCE = "reference"


@figure_settings()
def points(
    frame: pd.DataFrame,
    x: str,
    y: str,
    *,
    log: Log = "",
    limits: Mapping[str, float] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw sets of points.

    Parameters
    ----------
    frame
        Columns ``series``, ``x``, ``y`` and, where there are error bars, ``low`` and ``high``. A
        series called ``reference`` is drawn as a line with a band; one with the name of a method
        in that method's colour.
    x, y
        Labels of the axes, with units.
    log
        Which axes are logarithmic.
    limits
        Label -> y of a horizontal line; a label beginning with a minus sign is not written.
    ax
        Where to draw; None: a figure of its own.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    if not {"series", "x", "y"} <= set(getattr(frame, "columns", ())):
        raise refused("frame", frame, "give a DataFrame with columns series, x and y", TypeError)
    text("x", x)
    text("y", y)
    choice("log", log, get_args(Log))
    or_none("limits", limits, mapping, real)
    axes = axes_or_new(ax, 6.4, 3.6)
    labels = frame["series"].unique()
    styles = method_styles(label for label in labels if label != REFERENCE)
    for label, rows in frame.groupby("series", sort=False):
        own, belongs = rows.sort_values("x"), gid(series=label)
        ends = [own["x"], own["low"], own["high"]] if "low" in own else []
        if label == REFERENCE:
            if ends:
                tell(axes.fill_between(*ends, color=BAND_COLOR), belongs)
            tell(axes.plot(own["x"], own["y"], label=label, **REFERENCE_LINE), belongs)
            continue
        color, marker = styles[label].color, styles[label].marker
        if ends:
            tell(axes.vlines(*ends, color=color), belongs)
        drawn = axes.plot(own["x"], own["y"], marker, color=color, label=label, alpha=0.8)
        tell(drawn, belongs)
    for label, at in (limits or {}).items():
        axes.axhline(at, color=SOFT_COLOR, linewidth=0.8, linestyle=":")
        if not label.startswith("-"):
            axes.annotate(label, (1.0, at), xycoords=("axes fraction", "data"), ha="right",
                          va="bottom", color=SOFT_COLOR)  # fmt: skip
    for side in log:
        axes.set(**{f"{side}scale": "log"})
    axes.set(xlabel=x, ylabel=y)
    if len(labels) > 1:
        axes.legend()
    return axes
