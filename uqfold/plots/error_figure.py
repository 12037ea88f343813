"""Error against cost: which method tells most for its evaluations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from uqfold.plots.panels import axes_or_new, mark, percent_axis
from uqfold.plots.rows import Comparable
from uqfold.plots.style import BAND_COLOR, SOFT_COLOR, figure_settings, method_styles
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import REFERENCE_STANDARD_ERRORS, answers_of, in_figure, percent

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

SIZE_INCHES = (7.0, 4.6)
SMALLEST = 1e-16
"""Errors below are drawn on the lower edge."""


@figure_settings()
def error_against_evaluations(frame: Comparable, ax: Axes | None = None) -> Axes:
    """Draw the error of Eq. (49) over the number of evaluations, both logarithmic.

    A small marker is one criterion; the large marker is their median. Errors in the grey band are
    below two standard errors of every reference.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or some rows of it (results of methods have no reference).
    ax
        Where to draw; None: a figure of its own.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or has no answer with a reference.
    """
    answers = answers_of(frame)
    styles = method_styles(answers["label"].unique())
    errors = answers[answers["error"].notna()]
    if errors.empty:
        raise ValueError("frame has no answer with a reference: there is no error to draw")
    errors = errors.assign(cost=errors["n_evals_row"].clip(lower=1))
    axes = axes_or_new(ax, *SIZE_INCHES)
    low = _scale(axes, errors)
    handles: list[Any] = []
    for label, own in errors.groupby("label", sort=False):
        look: dict[str, Any] = {
            "color": styles[label].color, "marker": styles[label].marker, "linestyle": "",
        }  # fmt: skip
        for panel, part in own.groupby("panel", sort=False):
            # an error of exactly zero is drawn on the lower edge
            height = part["error"].clip(lower=low)
            points = axes.plot(part["cost"], height, markersize=4.0, alpha=0.75, **look)
            tell(points, gid(method=label, criterion=panel), part["text"])
        cost, typical = own["cost"].median(), own["error"].median()
        # the single criteria stay visible on it
        points = axes.plot(cost, max(typical, low), markersize=12.0, alpha=0.4, zorder=1.9, **look)
        said = f"median error {percent(typical)}\n{cost:,.0f} evaluations"
        tell(points, gid(method=label), [said])
        handles.append(mark(in_figure(label), **look))
    handles.append(mark("median of the criteria", markersize=11.0, alpha=0.4, color=SOFT_COLOR))
    handles.append(mark("one criterion", markersize=4.0, color=SOFT_COLOR))
    resolution = REFERENCE_STANDARD_ERRORS * errors["reference_std_error"] / errors["reference_pf"]
    if (level := min(resolution.min(), axes.get_ylim()[1])) > low:
        said = "below 2 standard errors\nof every reference"
        handles.append(axes.axhspan(low, level, facecolor=BAND_COLOR, zorder=0.2, label=said))
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    axes.set_xlabel("evaluations of the model")
    axes.set_ylabel("error of the failure probability, Eq. (49)")
    title = f"{in_figure(answers['problem'].iloc[0], 40)}: error against cost"
    axes.set_title(title, loc="left", fontweight="bold")
    return axes


def _scale(axes: Axes, errors: pd.DataFrame) -> float:
    """Make both axes logarithmic, that of costs over a factor of 30 at least; return the lowest."""
    from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter

    positive = errors["error"][errors["error"] > SMALLEST]
    low, high = (positive.min() / 2.0, positive.max() * 2.0) if len(positive) else (1e-6, 1.0)
    left, right = errors["cost"].min() / 2.0, errors["cost"].max() * 2.0
    wider = max(math.sqrt(30.0 * left / right), 1.0)
    percent_axis(axes, low, max(high, 0.02))
    axes.set(xscale="log", xlim=(left / wider, right * wider))
    if right / left < 100.0:
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    axes.xaxis.set_minor_formatter(NullFormatter())
    return float(low)
