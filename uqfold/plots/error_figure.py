"""Error against cost: which method tells most for its evaluations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from uqfold.plots.panels import axes_or_new, key
from uqfold.plots.style import BAND_COLOR, HEADER, SOFT_COLOR, figure_settings, method_styles
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import (
    answer_text,
    comparison_rows,
    drawable,
    in_figure,
    panel_key,
    panel_text,
    percent,
    reference_resolution,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

SIZE_INCHES = (7.0, 4.6)
SIDE_STEP = 0.03
"""Distance between methods of nearly equal cost, as a part of the axis."""
SMALLEST = 1e-16
"""Errors below are drawn on the lower edge."""


@figure_settings()
def error_against_evaluations(frame: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the error of Eq. (49) over the number of evaluations, both logarithmic.

    A small marker is one criterion, filled where the error exceeds two standard errors of the
    reference and hollow where the reference cannot judge it; the large marker is the median.
    Methods of equal cost stand side by side.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or some rows of it.
    ax
        Where to draw; None: a figure of its own.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or has no answer with a reference.
    """
    import pandas as pd

    rows = drawable(comparison_rows(frame))
    axes = axes_or_new(ax, *SIZE_INCHES)
    styles = method_styles(dict.fromkeys(row["label"] for row in rows))
    rows = drawable(rows, "error")
    if not rows:
        raise ValueError("frame has no answer with a reference: there is no error to draw")
    unit = frame.attrs.get(HEADER, {}).get("response_unit", "")
    errors = pd.DataFrame(rows)
    errors["panel"] = [panel_text(panel_key(row), unit) for row in rows]
    errors["text"] = [answer_text(row, unit) for row in rows]
    errors["level"] = [reference_resolution(row) for row in rows]
    errors["judged"] = errors["error"] > errors["level"]
    errors["cost"] = errors["n_evals_row"].clip(lower=1)
    _scale(axes, errors)
    low = axes.get_ylim()[0]
    steps = _side_steps(errors, axes.get_xlim())
    for label, own in errors.groupby("label", sort=False):
        look: dict[str, Any] = {
            "color": styles[label].color, "marker": styles[label].marker, "linestyle": "",
        }  # fmt: skip
        for (panel, judged), part in own.groupby(["panel", "judged"], sort=False):
            # an error of exactly zero is drawn on the lower edge
            points = axes.plot(
                steps[label] * part["cost"], part["error"].clip(lower=low), markersize=4.0,
                markeredgewidth=0.8, alpha=0.75, **look,
                markerfacecolor=styles[label].color if judged else "white",
            )  # fmt: skip
            tell(points, gid(method=label, criterion=panel), part["text"])
        cost, typical = own["cost"].median(), own["error"].median()
        # the single criteria stay visible on it
        points = axes.plot(
            steps[label] * cost, max(typical, low), markersize=12.0, markeredgewidth=1.3,
            markerfacecolor=styles[label].pale, zorder=1.9, **look,
        )  # fmt: skip
        said = f"median error {percent(typical)}\n{cost:,.0f} evaluations"
        tell(points, gid(method=label), [said])
    for level, alpha, which in (("max", 0.45, "some references"), ("min", 1.0, "every reference")):
        high = min(errors["level"].agg(level), axes.get_ylim()[1])
        if high > low:
            axes.axhspan(low, high, facecolor=(BAND_COLOR, alpha), linewidth=0.0, zorder=0.2,
                         label=f"below 2 standard errors\nof {which}")  # fmt: skip
    handles = [
        key(in_figure(label), linestyle="", marker=styles[label].marker, markersize=6.5,
            color=styles[label].color)
        for label in steps
    ]  # fmt: skip
    grey: dict[str, Any] = {"linestyle": "", "marker": "o", "color": SOFT_COLOR}
    handles.append(
        key("median of the criteria", markersize=11.0, markerfacecolor="#BBBBBB", **grey)
    )
    handles.append(key("one criterion", markersize=4.0, **grey))
    if not errors["judged"].all():
        said = "one criterion, below 2\nstandard errors of\nits reference"
        handles.append(key(said, markersize=4.0, markerfacecolor="white", **grey))
    axes.legend(handles=[*handles, *axes.patches], loc="upper left", bbox_to_anchor=(1.01, 1.0))
    axes.set_xlabel("evaluations of the model")
    axes.set_ylabel("error of the failure probability, Eq. (49)")
    title = f"{in_figure(rows[0]['problem'], 40)}: error against cost"
    axes.set_title(title, loc="left", fontweight="bold")
    return axes


def _scale(axes: Axes, errors: pd.DataFrame) -> None:
    """Make both axes logarithmic; that of costs over a factor of 30 at least."""
    from matplotlib.ticker import NullFormatter

    positive = errors["error"][errors["error"] > SMALLEST]
    low, high = (positive.min() / 2.0, positive.max() * 2.0) if len(positive) else (1e-6, 1.0)
    left, right = errors["cost"].min() / 2.0, errors["cost"].max() * 2.0
    wider = max(math.sqrt(30.0 * left / right), 1.0)
    axes.set(xscale="log", yscale="log", xlim=(left / wider, right * wider),
             ylim=(low, max(high, 0.02)))  # fmt: skip
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:,.7g}")
    axes.yaxis.set_major_formatter(lambda value, _: f"{100.0 * value:g} %")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_minor_formatter(NullFormatter())


def _side_steps(errors: pd.DataFrame, limits: tuple[float, float]) -> dict[str, float]:
    """Return the factor on the cost by which each method is moved aside from its neighbours."""
    step = (limits[1] / limits[0]) ** SIDE_STEP
    costs = errors.groupby("label", sort=False)["cost"].median()
    ordered = costs.sort_values(kind="stable")
    # a method that costs clearly more than the one before begins another group
    group = (ordered > step * ordered.shift()).cumsum()
    place = group.groupby(group).cumcount() - (group.groupby(group).transform("size") - 1) / 2
    return {label: float(step ** place[label]) for label in costs.index}
