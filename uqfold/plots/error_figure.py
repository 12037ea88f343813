"""Error against cost: which method tells most for its evaluations, and at which budget."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from uqfold.checks import refused, several, whole
from uqfold.plots.panels import axes_or_new, draw_judged, key, legend_below, mark, percent_axis
from uqfold.plots.rows import checked, distinct, having
from uqfold.plots.style import BAND_COLOR, SOFT_COLOR, MethodStyle, figure_settings, method_styles
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import REFERENCE_STANDARD_ERRORS, answers_of, in_figure, percent

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE_INCHES = (7.0, 4.6)
SIDE_STEP = 0.03
"""Distance between methods of nearly equal cost, as a part of the axis."""
SMALLEST = 1e-16
"""Errors below are drawn on the lower edge."""
BUDGETS_WIDTH_INCHES = 7.1
"""Width of two columns of print."""
ROW_INCHES = 1.75
EXPECTED: Any = {"color": "#000000", "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
SMALLEST_RMS, LARGEST_RMS = 1e-5, 10.0
NEEDS = ("label", "problem", "decade", "answers", "n_evals", "rms", "monte_carlo_rms", "judged")


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
    answers = answers_of(frame)
    styles = method_styles(answers["label"].unique())
    errors = answers[answers["error"].notna()]
    if errors.empty:
        raise ValueError("frame has no answer with a reference: there is no error to draw")
    resolution = REFERENCE_STANDARD_ERRORS * errors["reference_std_error"] / errors["reference_pf"]
    errors = errors.assign(
        resolution=resolution, judged=errors["error"] > resolution,
        cost=errors["n_evals_row"].clip(lower=1),
    )  # fmt: skip
    axes = axes_or_new(ax, *SIZE_INCHES)
    low = _scale(axes, errors)
    handles: list[Any] = []
    for label, step in _side_steps(errors, axes.get_xlim()).items():
        own, style = errors[errors["label"] == label], styles[label]
        look: dict[str, Any] = {"color": style.color, "marker": style.marker, "linestyle": ""}
        for (panel, judged), part in own.groupby(["panel", "judged"], sort=False):
            # an error of exactly zero is drawn on the lower edge
            points = axes.plot(
                step * part["cost"], part["error"].clip(lower=low), markersize=4.0,
                markerfacecolor=style.color if judged else "white", alpha=0.75, **look,
            )  # fmt: skip
            tell(points, gid(method=label, criterion=panel), part["text"])
        cost, typical = own["cost"].median(), own["error"].median()
        # the single criteria stay visible on it
        points = axes.plot(
            step * cost, max(typical, low), markersize=12.0, markerfacecolor=style.pale,
            zorder=1.9, **look,
        )  # fmt: skip
        said = f"median error {percent(typical)}\n{cost:,.0f} evaluations"
        tell(points, gid(method=label), [said])
        handles.append(mark(in_figure(label), **look))
    handles += [
        mark(
            "median of the criteria", markersize=11.0, markerfacecolor="#BBBBBB", color=SOFT_COLOR
        ),
        mark("one criterion", markersize=4.0, color=SOFT_COLOR),
    ]
    if not errors["judged"].all():
        said = "one criterion, below 2\nstandard errors of\nits reference"
        handles.append(mark(said, hollow=True, markersize=4.0, color=SOFT_COLOR))
    if (level := min(errors["resolution"].min(), axes.get_ylim()[1])) > low:
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
    from matplotlib.ticker import EngFormatter

    positive = errors["error"][errors["error"] > SMALLEST]
    low, high = (positive.min() / 2.0, positive.max() * 2.0) if len(positive) else (1e-6, 1.0)
    left, right = errors["cost"].min() / 2.0, errors["cost"].max() * 2.0
    wider = max(math.sqrt(30.0 * left / right), 1.0)
    percent_axis(axes, low, max(high, 0.02))
    axes.set(xscale="log", xlim=(left / wider, right * wider))
    axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    return float(low)


def _side_steps(errors: pd.DataFrame, limits: tuple[float, float]) -> dict[str, float]:
    """Return the factor on the cost by which each method is moved aside from its neighbours."""
    step = (limits[1] / limits[0]) ** SIDE_STEP
    costs = errors.groupby("label", sort=False)["cost"].median()
    ordered = costs.sort_values(kind="stable")
    # a method that costs clearly more than the one before begins another group
    group = (ordered > step * ordered.shift()).cumsum()
    place = group.groupby(group).cumcount() - (group.groupby(group).transform("size") - 1) / 2
    return {label: float(step ** place[label]) for label in costs.index}


@figure_settings()
def benchmark_panels(summary: pd.DataFrame, decades: Sequence[int]) -> Figure:
    """Draw errors over evaluations: decades of pf below each other, problems side by side.

    Parameters
    ----------
    summary
        Rows of `uqfold.comparison.benchmark_summary`; all with or all without tau.
    decades
        Exponents d of the decades to draw, 10^d < reference <= 10^(d + 1).

    Raises
    ------
    ValueError
        If no answer lies in these decades.
    """
    from matplotlib.figure import Figure

    frame = checked("summary", summary, NEEDS)
    decades = list(several("decades", decades, whole))
    frame = frame[frame["decade"].isin(decades) & (frame["answers"] > 0)]
    if frame.empty:
        raise refused("decades", decades, "no reference lies in them")
    problems = distinct(frame, "problem")
    styles = method_styles(distinct(frame, "label"))
    size = (BUDGETS_WIDTH_INCHES, ROW_INCHES * len(decades) + 0.6)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(len(decades), len(problems), squeeze=False, sharex=True, sharey=True)
    for row, decade in zip(grid, decades, strict=True):
        for axes, problem in zip(row, problems, strict=True):
            own = frame[(frame["decade"] == decade) & (frame["problem"] == problem)]
            if own.empty:
                axes.text(
                    0.5, 0.5, "not asked", transform=axes.transAxes, ha="center", color=SOFT_COLOR
                )
            else:
                _errors(axes, own, styles)
        row[0].set_ylabel(f"pf 1e{decade} to 1e{decade + 1}")
    for axes, problem in zip(grid[0], problems, strict=True):
        axes.set_title(problem)
    for axes in grid[-1]:
        axes.set_xlabel("evaluations")
    figure.supylabel("root mean square error of pf, Eq. (49)", fontsize=9.0)
    handles = [key(name, marker=look.marker, color=look.color) for name, look in styles.items()]
    handles.append(key("Monte Carlo, expected", **EXPECTED))
    if not frame["judged"].all():
        handles.append(mark("not beyond the reference's error", hollow=True, color=SOFT_COLOR))
    legend_below(figure, handles)
    return figure


def _errors(axes: Axes, rows: pd.DataFrame, styles: Mapping[str, MethodStyle]) -> None:
    """Draw the curves of all methods on one problem, in one decade."""
    from matplotlib.ticker import EngFormatter

    frame = rows.sort_values("n_evals")
    axes.set(xscale="log", xlim=(20, 20_000))
    axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    percent_axis(axes, SMALLEST_RMS, LARGEST_RMS)
    axes.plot(frame["n_evals"], frame["monte_carlo_rms"], **EXPECTED)
    for name, look in styles.items():
        # a budget that buys no further run buys no further point
        own = having(frame, "label", name).drop_duplicates("n_evals", keep="last")
        errors = own["rms"].clip(SMALLEST_RMS, LARGEST_RMS)
        draw_judged(axes, own["n_evals"], errors, ~own["judged"].astype(bool), look)
