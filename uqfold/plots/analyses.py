"""Analyses: Sobol' indices, derivatives of pf, importance of units, and designs for a target.

Two ways to the same number stand side by side, each in the colour of its method and with its
interval, so that a reader sees whether they agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from uqfold.checks import choice
from uqfold.methods.tabular import Tabular
from uqfold.plots.panels import axes_or_new, draw_rows, key, legend_below
from uqfold.plots.rows import checked, having
from uqfold.plots.style import COLUMN_INCHES, REFERENCE_LINE, SOFT_COLOR, figure_settings
from uqfold.plots.wording import criterion_text, response_of

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Analysis: TypeAlias = "pd.DataFrame | Tabular[Any] | Sequence[Tabular[Any]]"
"""A frame, or answers of an analysis that print as tables."""
REACH = 1.96
"""Standard errors in an interval on either side."""
SMALLEST_INDEX = 1e-6
MOMENTS = {"mean": "mean", "standard deviation": "std. dev."}
MEASURES = {
    "pf": "failure probability of the system",
    "birnbaum": "Birnbaum importance:\npf at stake with the unit",
    "fussell_vesely": "Fussell-Vesely importance:\nshare of pf that a perfect unit saves",
    "risk_achievement_worth": "risk achievement worth:\nfactor on pf while the unit is out",
    "risk_reduction_worth": "risk reduction worth:\nfactor that a perfect unit takes off pf",
}
PLACES = ("safe", "value")
"""Of a design: what meets the target surely, and what meets it best."""
DERIVATIVE_NEEDS = ("input", "moment", "threshold", "per_std", "per_std_error")
DESIGN_NEEDS = (
    "label", "parameter", "unit", "threshold", "tau", "missions", "seek", "status", "target_pf",
    "value", "low", "high",
    *(f"{place}_{name}" for place in PLACES for name in ("pf", "ci_low", "ci_high")),
)  # fmt: skip


@figure_settings()
def sobol(table: Analysis, ax: Axes | None = None) -> Axes:
    """Draw main (filled) and total (hollow) Sobol' indices of every input, logarithmic.

    Parameters
    ----------
    table
        What `chaos_sobol` or `pick_freeze` returned, a list of such answers, or a frame of them. A
        column ``label`` names them, without it ``method`` does. Indices below 1e-6 are not drawn.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    frame = _labelled(table, ("input", "order", "index", "ci_low", "ci_high"))
    low = frame["ci_low"].clip(lower=SMALLEST_INDEX)
    frame = frame.assign(
        row=frame["input"], kind=frame["order"], low=low,
        value=frame["index"].where(frame["index"] > SMALLEST_INDEX),
        high=np.maximum(frame["ci_high"], low),
    )  # fmt: skip
    axes = axes_or_new(ax, height=1.2 + 0.4 * frame["row"].nunique())
    handles = draw_rows(axes, frame, ("main", "total"))
    axes.set(xscale="log", xlim=(SMALLEST_INDEX, 1.5), xlabel="Sobol' index of the response")
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.4, -0.25), ncols=2)
    return axes


@figure_settings()
def derivatives(table: Analysis, ax: Axes | None = None) -> Axes:
    """Draw relative changes of pf per standard deviation of every input, method beside method.

    Parameters
    ----------
    table
        What `surface_derivatives` or `score_derivatives` returned for one criterion, a list of such
        answers, or a frame of them. A column ``label`` names them, without it ``method`` does.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    frame = _labelled(table, DERIVATIVE_NEEDS)
    value, half = frame["per_std"], REACH * frame["per_std_error"]
    frame = frame.assign(
        row=frame["input"] + ", " + frame["moment"].map(MOMENTS),
        value=value, low=value - half, high=value + half,
    )  # fmt: skip
    axes = axes_or_new(ax, height=1.2 + 0.3 * frame["row"].nunique())
    axes.axvline(0.0, color=SOFT_COLOR, linewidth=0.8)
    draw_rows(axes, frame)
    means = frame.loc[frame["moment"] == "mean", "row"].nunique()
    axes.axhline(means - 0.5, color="#BBBBBB", linewidth=0.8)
    axes.set_xlabel("relative change of pf\nper std. dev. of the input")
    axes.legend()
    return axes


@figure_settings()
def importance(
    table: pd.DataFrame, measure: str = "fussell_vesely", ax: Axes | None = None
) -> Axes:
    """Draw one measure of every unit, with the common cause (filled) and without (hollow).

    Parameters
    ----------
    table
        What `uqfold.analysis.importance_of_units` returned.
    measure
        ``birnbaum``, ``fussell_vesely``, ``risk_achievement_worth``, ``risk_reduction_worth`` or
        ``pf``. Infinite values are not drawn.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    import pandas as pd
    from matplotlib.ticker import LogLocator, NullFormatter

    choice("measure", measure, MEASURES)
    kinds = {"causes shared": measure, "as if independent": f"{measure}_independent"}
    frame = checked("table", table, ("unit", "threshold", "missions", *kinds.values()))
    asked = [criterion_text(row, "") for row in frame.to_dict("records")]
    frame = frame.assign(row=frame["unit"], series=asked)
    frame = pd.concat([frame.assign(kind=kind, value=frame[own]) for kind, own in kinds.items()])
    value = frame["value"].where(np.isfinite(frame["value"]))
    axes = axes_or_new(ax, height=1.3 + 0.34 * frame["unit"].nunique())
    handles = draw_rows(axes, frame.assign(value=value, low=value, high=value), tuple(kinds))
    axes.set_xlabel(MEASURES[measure])
    if measure == "fussell_vesely":
        axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    else:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.4, -0.35), ncols=2)
    return axes


@figure_settings()
def design(table: pd.DataFrame) -> Figure:
    """Draw design values with intervals, and pf by simulation at the value and at the safe value.

    Parameters
    ----------
    table
        One row per design: what `uqfold.analysis.designs_to_frame` returned.

    Returns
    -------
    matplotlib.figure.Figure
    """
    import pandas as pd

    from uqfold.plots.shown import ShownFigure

    frame = checked("table", table, DESIGN_NEEDS)
    unit = response_of(frame)[1]
    frame = frame.assign(
        row=[criterion_text(row, unit) for row in frame.to_dict("records")], series=frame["label"]
    )
    rows = list(frame["row"].unique())
    size = (2.0 * COLUMN_INCHES, 0.8 + 0.36 * len(rows))
    figure = ShownFigure(figsize=size, layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    draw_rows(left, frame)
    ends = {"value": "pf", "low": "ci_low", "high": "ci_high"}
    simulated = pd.concat([
        frame.assign(
            kind=f"simulated at the {'safe ' * (place == 'safe')}value",
            **{end: frame[f"{place}_{name}"] for end, name in ends.items()},
        )
        for place in PLACES
    ])  # fmt: skip
    handles = draw_rows(right, simulated, tuple(simulated["kind"].unique()))
    for i, name in enumerate(rows):
        own = having(frame, "row", name)
        if own["value"].isna().all():
            left.annotate(
                ", ".join(own["status"].unique()), (0.02, i), va="center", color=SOFT_COLOR,
                fontsize=8.5, xycoords=("axes fraction", "data"),
            )  # fmt: skip
    first = frame.iloc[0]
    unit = f" ({first['unit']})" if first["unit"] else ""
    left.set_xlabel(f"{first['seek']} {first['parameter']}{unit}")
    right.set_xlabel("pf of the real model")
    for target in frame["target_pf"].unique():
        right.axvline(target, **REFERENCE_LINE)
    # long intervals of few failures do not squeeze the rest
    right.set_xlim(0.0, 2.5 * float(frame["target_pf"].max()))
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    handles += [key("95 %", color=SOFT_COLOR), key("target", **REFERENCE_LINE)]
    legend_below(figure, handles)
    return figure


def _labelled(table: Any, needs: Sequence[str]) -> pd.DataFrame:
    """Return answers of an analysis as one frame, with the ``series`` that each row belongs to."""
    import pandas as pd

    answers = table if isinstance(table, list | tuple) else [table]
    if answers and all(isinstance(one, Tabular) for one in answers):
        table = pd.concat([one.to_frame() for one in answers])
    by = "label" if "label" in getattr(table, "columns", ()) else "method"
    frame = checked("table", table, (by, *needs))
    return frame.assign(series=frame[by])
