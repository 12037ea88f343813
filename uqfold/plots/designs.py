"""Designs for a target: values with their intervals, and pf by simulation at these values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.plots.panels import GREY, key, legend_below
from uqfold.plots.rows import distinct, having, joined, response_of, value_text
from uqfold.plots.style import COLUMN_INCHES, REFERENCE_LINE, figure_settings, method_styles

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uqfold.plots.rows import Frames

ROW_INCHES = 0.36
PLACES = ("value", "safe")
NEEDS = (
    "label", "parameter", "unit", "threshold", "tau", "missions", "seek", "status", "target_pf",
    "value", "low", "high",
    *(f"{place}_{name}" for place in PLACES for name in ("pf", "ci_low", "ci_high")),
)  # fmt: skip


@figure_settings()
def design(table: Frames) -> Figure:
    """Draw design values with intervals, and pf by simulation at the value and at the safe value.

    Parameters
    ----------
    table
        One row per design: what `uqfold.analysis.designs_to_frame` returned.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    frame = joined(table, NEEDS, "table")
    frame = frame.assign(case=case_texts(frame))
    cases, labels = distinct(frame, "case"), distinct(frame, "label")
    styles = method_styles(labels)
    size = (2.0 * COLUMN_INCHES, 1.1 + ROW_INCHES * len(cases))
    figure = Figure(figsize=size, layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    for k, label in enumerate(labels):
        own, look = having(frame, "label", label), styles[label]
        shift = 0.0 if len(labels) == 1 else 0.5 * (k / (len(labels) - 1) - 0.5)
        y = np.array([cases.index(case) for case in own["case"]]) + shift
        left.hlines(y, own["low"], own["high"], color=look.color, linewidth=1.6)
        left.plot(own["value"], y, look.marker, color=look.color, markerfacecolor="white")
        for place, face, lift in (("value", "white", -0.12), ("safe", look.color, 0.12)):
            pf, low, high = (own[f"{place}_{name}"] for name in ("pf", "ci_low", "ci_high"))
            right.hlines(y + lift, low, high, color=look.color, linewidth=1.2)
            right.plot(pf, y + lift, look.marker, color=look.color, markerfacecolor=face)
    for i, case in enumerate(cases):
        rows = having(frame, "case", case)
        if rows["value"].isna().all():
            left.annotate(
                ", ".join(rows["status"].unique()), (0.02, i), va="center", color=GREY,
                fontsize=8.5, xycoords=("axes fraction", "data"),
            )  # fmt: skip
    _finish(left, right, frame, cases)
    grey: Any = {"linestyle": "", "marker": "o", "color": GREY}
    handles = [
        key(f"{label}, 95 %", marker=look.marker, color=look.color, markerfacecolor="white")
        for label, look in styles.items()
    ]
    handles += [
        key("simulated at the value", markerfacecolor="white", **grey),
        key("simulated at the safe value", **grey),
        key("target", **REFERENCE_LINE),
    ]
    legend_below(figure, handles, 3)
    return figure


def case_texts(frame: pd.DataFrame) -> list[str]:
    """Return the criterion of every row in words; NaN as threshold is one that is designed."""
    unit = response_of(frame)[1]
    whole = frame[["threshold", "tau", "missions"]].astype(object)
    rows = whole.where(whole.notna(), None).to_dict("records")
    return [
        ", ".join(
            value_text(name, value, unit)
            for name, value in row.items()
            if name != "threshold" or value is not None
        )
        for row in rows
    ]


def _finish(left: Axes, right: Axes, frame: pd.DataFrame, cases: list[str]) -> None:
    row = frame.iloc[0]
    left.set_yticks(range(len(cases)), cases)
    left.set_ylim(len(cases) - 0.5, -0.5)
    left.set_xlabel(f"{row['seek']} {row['parameter']} ({row['unit']})")
    right.set_xlabel("pf of the real model")
    for target in frame["target_pf"].unique():
        right.axvline(target, **REFERENCE_LINE)
    # long intervals of few failures do not squeeze the rest
    right.set_xlim(0.0, 2.5 * float(frame["target_pf"].max()))
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    for axes in (left, right):
        axes.grid(visible=False, axis="y")
