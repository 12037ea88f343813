"""What matters: Sobol' indices, and derivatives of pf.

Two ways to the same number stand side by side, each in the colour of its method and with its
interval, so that a reader sees whether they agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import choice
from uqfold.plots.panels import GREY, axes_or_new, key
from uqfold.plots.rows import distinct, having, joined, response_of
from uqfold.plots.style import MethodStyle, figure_settings, method_styles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from uqfold.plots.rows import Frames

ROW_INCHES = 0.3
REACH = 1.96
SMALLEST_INDEX = 1e-6
MOMENTS = {"mean": "mean", "standard deviation": "std. dev."}
INPUT_LOOKS = (
    MethodStyle("#0072B2", "o"), MethodStyle("#D55E00", "s"), MethodStyle("#009E73", "^"),
    MethodStyle("#CC79A7", "D"), MethodStyle("#E69F00", "v"), MethodStyle("#56B4E9", "P"),
    MethodStyle("#5D3A9B", "X"),
)  # fmt: skip
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
    inputs, labels = distinct(frame, "input"), distinct(frame, "label")
    styles = method_styles(labels)
    axes = axes_or_new(ax, 1.2 + (ROW_INCHES + 0.1) * len(inputs))
    axes.set_xscale("log")
    rows = [(label, order) for label in labels for order in ("main", "total")]
    for k, (label, order) in enumerate(rows):
        own = having(having(frame, "label", label), "order", order)
        y = np.array([inputs.index(name) for name in own["input"]]) + _offset(k, len(rows))
        low = np.maximum(own["ci_low"].to_numpy(), SMALLEST_INDEX)
        high = np.maximum(own["ci_high"].to_numpy(), low)
        value = own["index"].where(own["index"] > SMALLEST_INDEX).to_numpy()
        axes.hlines(y, low, high, color=styles[label].color, linewidth=1.0)
        _points(axes, value, y, styles[label], hollow=order == "total")
    _name_rows(axes, inputs)
    axes.set_xlim(SMALLEST_INDEX, 1.5)
    axes.set_xlabel("Sobol' index of the response")
    grey: Any = {"linestyle": "", "marker": "o", "color": GREY}
    handles = [_key(styles[label], label) for label in labels]
    handles += [key("main", **grey), key("total", markerfacecolor="white", **grey)]
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
    column = "label" if "label" in frame else "method"
    parameters = list(dict.fromkeys(zip(frame["input"], frame["moment"], strict=True)))
    labels = distinct(frame, column)
    styles = method_styles(labels)
    axes = axes_or_new(ax, 1.2 + ROW_INCHES * len(parameters))
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    for k, label in enumerate(labels):
        own = having(frame, column, label)
        pairs = zip(own["input"], own["moment"], strict=True)
        y = np.array([parameters.index(pair) for pair in pairs]) + _offset(k, len(labels))
        value, half = own["per_std"].to_numpy(), REACH * own["per_std_error"].to_numpy()
        axes.hlines(y, value - half, value + half, color=styles[label].color, linewidth=1.2)
        _points(axes, value, y, styles[label], hollow=False, label=str(label))
    _name_rows(axes, [f"{name}, {MOMENTS[moment]}" for name, moment in parameters])
    means = sum(moment == "mean" for _, moment in parameters)
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
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    for k, name in enumerate(distinct(frame, "input")):
        own = having(frame, "input", name).sort_values("threshold")
        look = INPUT_LOOKS[k % len(INPUT_LOOKS)]
        axes.errorbar(
            own["threshold"], own["per_std"], yerr=REACH * own["per_std_error"], capsize=2.0,
            elinewidth=0.9, color=look.color, marker=look.marker, label=name,
        )  # fmt: skip
    unit = response_of(frame)[1]
    axes.set_xlabel(f"threshold $T${f' ({unit})' if unit else ''}")
    axes.set_ylabel(f"relative change of pf\nby the {moment}")
    return axes


def _offset(k: int, count: int) -> float:
    return 0.0 if count == 1 else 0.5 * (k / (count - 1) - 0.5)


def _points(
    axes: Axes, x: Any, y: Any, style: MethodStyle, *, hollow: bool, label: str | None = None
) -> None:
    axes.plot(
        x, y, style.marker, color=style.color, markersize=4.5, markeredgewidth=1.0,
        markerfacecolor="white" if hollow else style.color, label=label,
    )  # fmt: skip


def _name_rows(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")


def _key(style: MethodStyle, label: str) -> Any:
    return key(label, linestyle="", marker=style.marker, color=style.color)
