"""Designs for a target: values with their intervals, and pf by simulation at these values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from uqfold.plots.panels import beside, draw_intervals, key, legend_below, name_rows
from uqfold.plots.rows import distinct, having, joined, response_of, value_text
from uqfold.plots.style import (
    COLUMN_INCHES,
    REFERENCE_LINE,
    SOFT_COLOR,
    figure_settings,
    method_styles,
)

if TYPE_CHECKING:
    import pandas as pd
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
    cases, styles = distinct(frame, "case"), method_styles(distinct(frame, "label"))
    size = (2.0 * COLUMN_INCHES, 1.1 + ROW_INCHES * len(cases))
    figure = Figure(figsize=size, layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    for k, (label, look) in enumerate(styles.items()):
        own = having(frame, "label", label)
        y = own["case"].map(cases.index) + beside(k, len(styles))
        draw_intervals(left, y, own["value"], own["low"], own["high"], look, hollow=True)
        for place, lift in (("value", -0.12), ("safe", 0.12)):
            pf, low, high = (own[f"{place}_{name}"] for name in ("pf", "ci_low", "ci_high"))
            draw_intervals(right, y + lift, pf, low, high, look, hollow=place == "value")
    for i, case in enumerate(cases):
        rows = having(frame, "case", case)
        if rows["value"].isna().all():
            left.annotate(
                ", ".join(rows["status"].unique()), (0.02, i), va="center", color=SOFT_COLOR,
                fontsize=8.5, xycoords=("axes fraction", "data"),
            )  # fmt: skip
    for axes in (left, right):
        name_rows(axes, cases)
    row = frame.iloc[0]
    left.set_xlabel(f"{row['seek']} {row['parameter']} ({row['unit']})")
    right.set_xlabel("pf of the real model")
    for target in frame["target_pf"].unique():
        right.axvline(target, **REFERENCE_LINE)
    # long intervals of few failures do not squeeze the rest
    right.set_xlim(0.0, 2.5 * float(frame["target_pf"].max()))
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    handles = [
        key(f"{label}, 95 %", marker=look.marker, color=look.color, markerfacecolor="white")
        for label, look in styles.items()
    ]
    for place, face in (("value", "white"), ("safe value", SOFT_COLOR)):
        mark: Any = {"marker": "o", "color": SOFT_COLOR, "markerfacecolor": face}
        handles.append(key(f"simulated at the {place}", linestyle="", **mark))
    legend_below(figure, [*handles, key("target", **REFERENCE_LINE)], 3)
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
