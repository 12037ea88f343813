"""Which method at which budget: error against evaluations, by problem and decade of pf."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.benchmark import NEEDS, benchmark_summary
from uqfold.comparison.studies.keys import FLAG, NUMBER, TABLE_NAMES, Key, Kind, list_of
from uqfold.report.studies.selection import SelectionError, distinct, joined
from uqfold.report.style import MethodStyle, figure_settings, method_styles

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_INCHES = 7.1
"""Width of two columns of print."""
ROW_INCHES = 1.75
EXPECTED: Any = {"color": "#000000", "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
_SMALLEST, _LARGEST = 1e-5, 10.0


def summarised(tables: Mapping[str, pd.DataFrame], names: tuple[str, ...]) -> pd.DataFrame:
    """Summarise the runs of a study, with the registered name of every label in ``method``."""
    frame = joined(tables, names)
    units = dict(zip(tables["problems"]["problem"], tables["problems"]["units"], strict=True))
    summary = benchmark_summary(frame, {name: int(count) for name, count in units.items()})
    registered = dict(zip(frame["label"], frame["method"], strict=True))
    return summary.assign(method=summary["label"].map(registered))


def decade_text(decade: int) -> str:
    """Write a decade of pf, for instance ``1e-4 to 1e-3``."""
    return f"1e{decade} to 1e{decade + 1}"


@figure_settings()
def draw_budgets(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw errors over evaluations: decades of pf below each other, problems side by side.

    Settings are the values of the keys of `BUDGETS`.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    summary = summarised(tables, settings["table"])
    summary = summary[summary["synchronized"] == settings["synchronized"]]
    decades = [int(decade) for decade in settings["decades"]]
    summary = summary[summary["decade"].isin(decades) & (summary["answers"] > 0)]
    if summary.empty:
        raise SelectionError(f"no reference lies in the decades {decades}")
    problems = distinct(summary, "problem")
    methods = distinct(summary, "method")
    styles = method_styles(methods)
    figure = Figure(figsize=(WIDTH_INCHES, ROW_INCHES * len(decades) + 1.0), layout="constrained")
    grid = figure.subplots(len(decades), len(problems), squeeze=False, sharex=True, sharey=True)
    for i, decade in enumerate(decades):
        for j, problem in enumerate(problems):
            axes = grid[i, j]
            chosen = (summary["decade"] == decade) & (summary["problem"] == problem)
            _draw(axes, summary[chosen], styles)
            if i == 0:
                axes.set_title(problem)
        grid[i, 0].set_ylabel(f"pf {decade_text(decade)}")
    for axes in grid[-1]:
        axes.set_xlabel("evaluations")
    figure.supylabel("root mean square error of pf, Eq. (49)", fontsize=9.0)
    handles = [
        Line2D([], [], marker=styles[name].marker, color=styles[name].color, label=name)
        for name in methods
    ]
    handles.append(Line2D([], [], **EXPECTED, label="Monte Carlo, expected"))
    if not summary["judged"].all():
        handles.append(
            Line2D(
                [], [], linestyle="", marker="o", color="#555555", markerfacecolor="white",
                label="not beyond the reference's error",
            )
        )  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _draw(axes: Axes, rows: pd.DataFrame, styles: Mapping[str, MethodStyle]) -> None:
    axes.set(xscale="log", yscale="log", xlim=(20, 20_000), ylim=(_SMALLEST, _LARGEST))
    axes.yaxis.set_major_formatter(lambda value, _: f"{100.0 * value:g} %")
    axes.xaxis.set_major_formatter(
        lambda value, _: f"{value / 1000:g}k" if value >= 1000.0 else f"{value:g}"
    )
    if rows.empty:
        axes.text(0.5, 0.5, "not asked", transform=axes.transAxes, ha="center", color="#555555")
        return
    line = rows.sort_values("n_evals")
    axes.plot(line["n_evals"], line["monte_carlo_rms"], **EXPECTED)
    for name, look in styles.items():
        own = rows[rows["method"] == name].sort_values("n_evals")
        # a budget that buys no further run buys no further point
        own = own.drop_duplicates("n_evals", keep="last")
        error = np.clip(own["rms"], _SMALLEST, _LARGEST)
        axes.plot(own["n_evals"], error, "-", color=look.color, linewidth=1.0)
        for judged, face in ((True, look.color), (False, "white")):
            shown = (own["judged"] == judged).to_numpy()
            axes.plot(
                own["n_evals"][shown], error[shown], look.marker, color=look.color,
                markersize=4.0, markerfacecolor=face, markeredgewidth=0.9,
            )  # fmt: skip


BUDGETS = Kind(
    "budgets",
    "Root mean square error of pf over evaluations: decades of pf below each other, problems side "
    "by side.",
    (
        Key("table", TABLE_NAMES, "Runs with several budgets and seeds."),
        Key(
            "decades",
            list_of(NUMBER),
            "Exponents d of decades of the reference, 10^d < pf <= 10^(d + 1).",
        ),
        Key("synchronized", FLAG, "Whether to draw the criteria with tau.", False),
    ),
    draw_budgets,
    needs=NEEDS,
)
