"""What matters: Sobol' indices, and derivatives of pf.

Two ways to the same number stand side by side, each in the colour of its method and with its
interval, so that a reader sees whether they agree.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.checks import choice
from uqfold.plots.panels import axes_or_new, beside, draw_intervals, key, name_rows
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
    inputs, styles = distinct(frame, "input"), method_styles(distinct(frame, "label"))
    axes = axes_or_new(ax, height=1.2 + (ROW_INCHES + 0.1) * len(inputs))
    rows = [(label, order) for label in styles for order in ("main", "total")]
    for k, (label, order) in enumerate(rows):
        own = having(having(frame, "label", label), "order", order)
        y = own["input"].map(inputs.index) + beside(k, len(rows))
        low = own["ci_low"].clip(lower=SMALLEST_INDEX)
        high = np.maximum(own["ci_high"], low)
        value = own["index"].where(own["index"] > SMALLEST_INDEX)
        draw_intervals(axes, y, value, low, high, styles[label], hollow=order == "total")
    name_rows(axes, inputs)
    axes.set(xscale="log", xlim=(SMALLEST_INDEX, 1.5), xlabel="Sobol' index of the response")
    handles = [
        key(label, linestyle="", marker=look.marker, color=look.color)
        for label, look in styles.items()
    ]
    for order, face in (("main", SOFT_COLOR), ("total", "white")):
        handles.append(key(order, linestyle="", marker="o", color=SOFT_COLOR, markerfacecolor=face))
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
    frame = frame.assign(row=frame["input"] + ", " + frame["moment"].map(MOMENTS))
    rows = distinct(frame, "row")
    column = "label" if "label" in frame else "method"
    styles = method_styles(distinct(frame, column))
    axes = axes_or_new(ax, height=1.2 + ROW_INCHES * len(rows))
    axes.axvline(0.0, color=SOFT_COLOR, linewidth=0.8)
    for k, (label, look) in enumerate(styles.items()):
        own = having(frame, column, label)
        y = own["row"].map(rows.index) + beside(k, len(styles))
        value, half = own["per_std"], REACH * own["per_std_error"]
        draw_intervals(axes, y, value, value - half, value + half, look, label=label)
    name_rows(axes, rows)
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
