"""Which method at which budget: error against evaluations, by problem and decade of pf."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from uqfold.checks import refused, several, whole
from uqfold.plots.panels import draw_judged, key, legend_below, mark, percent_axis
from uqfold.plots.rows import checked, distinct, having
from uqfold.plots.style import SOFT_COLOR, MethodStyle, figure_settings, method_styles

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_INCHES = 7.1
"""Width of two columns of print."""
ROW_INCHES = 1.75
EXPECTED: Any = {"color": "#000000", "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
SMALLEST, LARGEST = 1e-5, 10.0
NEEDS = ("label", "problem", "decade", "answers", "n_evals", "rms", "monte_carlo_rms", "judged")


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
    size = (WIDTH_INCHES, ROW_INCHES * len(decades) + 0.6)
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
    percent_axis(axes, SMALLEST, LARGEST)
    axes.plot(frame["n_evals"], frame["monte_carlo_rms"], **EXPECTED)
    for name, look in styles.items():
        # a budget that buys no further run buys no further point
        own = having(frame, "label", name).drop_duplicates("n_evals", keep="last")
        errors = own["rms"].clip(SMALLEST, LARGEST)
        draw_judged(axes, own["n_evals"], errors, ~own["judged"].astype(bool), look)
