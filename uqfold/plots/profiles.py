"""Profiles of a benchmark: what share of the questions each method solves, over what it may cost.

References
----------
Dolan ED, More JJ. Benchmarking optimization software with performance profiles. Mathematical
Programming 91 (2002) 201-213.

More JJ, Wild SM. Benchmarking derivative-free optimization algorithms. SIAM Journal on Optimization
20 (2009) 172-191.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.league import solving_costs
from uqfold.plots.panels import axes_or_new
from uqfold.plots.style import figure_settings, method_styles
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import in_figure

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

SIZE_INCHES = (7.0, 4.2)


@figure_settings()
def performance_profile(frame: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the share of questions that each method solves over its cost relative to the best.

    At a factor f stands the share of questions that a method solves with at most f times the
    evaluations of the method that solves them with the fewest (Dolan and More 2002). Questions that
    no method solves count as well. The order of methods at a factor holds for this set of methods.

    Parameters
    ----------
    frame
        Rows of `uqfold.benchmark`, all with one budget.
    ax
        Where to draw; None: a figure of its own.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or has no row with a reference.
    """
    costs = solving_costs(frame)
    best = costs.min(axis=1)
    ratios = costs.div(best.where(np.isfinite(best), 1.0), axis=0)
    return _profile(ratios, "evaluations, as a multiple of the cheapest method's", ax)


@figure_settings()
def data_profile(frame: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the share of questions that each method solves over its evaluations per input and one.

    At k stands the share of questions that a method solves with at most k (d + 1) evaluations, d
    being the number of inputs (More and Wild 2009: what k simplex gradients cost).

    Parameters
    ----------
    frame, ax
        As for `performance_profile`.

    Raises
    ------
    TypeError, ValueError
        As for `performance_profile`.
    """
    costs = solving_costs(frame)
    inputs = costs.index.get_level_values("inputs")
    return _profile(costs.div(inputs + 1.0, axis=0), "evaluations / (inputs + 1)", ax)


def _profile(costs: pd.DataFrame, name: str, ax: Axes | None) -> Axes:
    from matplotlib.ticker import EngFormatter

    axes = axes_or_new(ax, *SIZE_INCHES)
    finite = costs.to_numpy()[np.isfinite(costs.to_numpy())]
    low = finite.min() if finite.size else 1.0
    high = max(10.0 * low, 1.2 * finite.max(initial=0.0))
    looks = method_styles(costs.columns)
    for label in np.isfinite(costs).sum().sort_values(ascending=False, kind="stable").index:
        look = looks[label]
        at = np.sort(costs[label])[: np.isfinite(costs[label]).sum()]
        share = np.arange(at.size + 1) / len(costs)
        x, y = [low, *at, high], [*share, share[-1]]
        line = axes.step(x, y, where="post", color=look.color, marker=look.marker, markersize=3.0,
                         label=in_figure(label))  # fmt: skip
        said = [f"{part:.0%} within {cost:,.4g}" for cost, part in zip(x, y, strict=True)]
        tell(line, gid(method=label), said)
    axes.set(xscale="log", xlim=(low, high), ylim=(-0.02, 1.02), xlabel=name,
             ylabel="share of questions solved")  # fmt: skip
    axes.xaxis.set_major_formatter(EngFormatter(sep=""))
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return axes
