"""What matters: Sobol' indices, and derivatives of pf.

Two ways to the same number stand side by side, each in the colour of its method and with its
interval, so that a reader sees whether they agree.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.checks import choice
from uqfold.plots.panels import axes_or_new, draw_rows, mark
from uqfold.plots.rows import distinct, having, joined, response_of
from uqfold.plots.style import SOFT_COLOR, figure_settings, method_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from uqfold.plots.rows import Frames

ROW_INCHES = 0.3
REACH = 1.96
"""Standard errors in an interval on either side."""
SMALLEST_INDEX = 1e-6
MOMENTS = {"mean": "mean", "standard deviation": "std. dev."}
DERIVATIVE_NEEDS = ("input", "moment", "threshold", "per_std", "per_std_error")


@figure_settings()
def sobol(table: Frames, ax: Axes | None = None) -> Axes:
    """Draw main (filled) and total (hollow) Sobol' indices of every input, logarithmic.

    Parameters
    ----------
    table
        What `chaos_sobol(...).to_frame()` or `pick_freeze(...).to_frame()` returned, or both, each
        with a column ``label``. Indices below 1e-6 are not drawn.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    frame = joined(table, ("label", "input", "order", "index", "ci_low", "ci_high"), "table")
    low = frame["ci_low"].clip(lower=SMALLEST_INDEX)
    frame = frame.assign(
        row=frame["input"], series=frame["label"] + ", " + frame["order"], low=low,
        value=frame["index"].where(frame["index"] > SMALLEST_INDEX),
        high=np.maximum(frame["ci_high"], low),
    )  # fmt: skip
    styles = method_styles(distinct(frame, "label"))
    axes = axes_or_new(ax, height=1.2 + (ROW_INCHES + 0.1) * frame["input"].nunique())
    looks = {f"{name}, {one}": styles[name] for name in styles for one in ("main", "total")}
    draw_rows(axes, frame, looks, hollow=", total")
    axes.set(xscale="log", xlim=(SMALLEST_INDEX, 1.5), xlabel="Sobol' index of the response")
    handles = [mark(label, marker=look.marker, color=look.color) for label, look in styles.items()]
    handles += [mark("main", color=SOFT_COLOR), mark("total", hollow=True, color=SOFT_COLOR)]
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.4, -0.25), ncols=2)
    return axes


@figure_settings()
def derivatives(table: Frames, ax: Axes | None = None) -> Axes:
    """Draw relative changes of pf per standard deviation of every input, method beside method.

    Parameters
    ----------
    table
        What `surface_derivatives(...).to_frame()` or `score_derivatives(...).to_frame()` returned,
        or both: rows of one criterion. A column ``label`` names them, without it ``method`` does.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    frame = joined(table, DERIVATIVE_NEEDS, "table")
    value, half = frame["per_std"], REACH * frame["per_std_error"]
    frame = frame.assign(
        row=frame["input"] + ", " + frame["moment"].map(MOMENTS),
        series=frame["label" if "label" in frame else "method"],
        value=value, low=value - half, high=value + half,
    )  # fmt: skip
    rows = distinct(frame, "row")
    axes = axes_or_new(ax, height=1.2 + ROW_INCHES * len(rows))
    axes.axvline(0.0, color=SOFT_COLOR, linewidth=0.8)
    draw_rows(axes, frame, method_styles(distinct(frame, "series")))
    means = sum(row.endswith(", mean") for row in rows)
    axes.axhline(means - 0.5, color="#BBBBBB", linewidth=0.8)
    axes.set_xlabel("relative change of pf\nper std. dev. of the input")
    axes.legend()
    return axes


@figure_settings()
def derivatives_over_threshold(table: Frames, moment: str, ax: Axes | None = None) -> Axes:
    """Draw relative changes of pf per standard deviation over T, one curve per input.

    Parameters
    ----------
    table
        As in `derivatives`, rows of one method, one tau and one number of missions.
    moment
        ``mean`` or ``standard deviation``: by which parameter of the inputs.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    choice("moment", moment, MOMENTS)
    frame = having(joined(table, DERIVATIVE_NEEDS, "table"), "moment", moment)
    axes = axes_or_new(ax)
    axes.axhline(0.0, color=SOFT_COLOR, linewidth=0.8)
    for name, look in method_styles(distinct(frame, "input")).items():
        own = having(frame, "input", name).sort_values("threshold")
        axes.errorbar(
            own["threshold"], own["per_std"], yerr=REACH * own["per_std_error"], capsize=2.0,
            elinewidth=0.9, color=look.color, marker=look.marker, label=name,
        )  # fmt: skip
    unit = response_of(frame)[1]
    axes.set_xlabel(f"threshold $T${f' ({unit})' if unit else ''}")
    axes.set_ylabel(f"relative change of pf\nby the {moment}")
    return axes
