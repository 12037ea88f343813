"""Designs for a target: values with their intervals, and pf by simulation at these values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from uqfold.plots.panels import draw_rows, key, legend_below, mark
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
    import pandas as pd
    from matplotlib.figure import Figure

    frame = joined(table, NEEDS, "table")
    frame = frame.assign(row=case_texts(frame), series=frame["label"])
    rows, styles = distinct(frame, "row"), method_styles(distinct(frame, "label"))
    size = (2.0 * COLUMN_INCHES, 0.8 + ROW_INCHES * len(rows))
    figure = Figure(figsize=size, layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    draw_rows(left, frame, styles)
    simulated = pd.concat([
        frame.assign(
            series=frame["label"] + ", " + place, value=frame[f"{place}_pf"],
            low=frame[f"{place}_ci_low"], high=frame[f"{place}_ci_high"],
        )
        for place in PLACES
    ])  # fmt: skip
    looks = {f"{label}, {place}": look for label, look in styles.items() for place in PLACES}
    draw_rows(right, simulated, looks, hollow=", value")
    for i, name in enumerate(rows):
        own = having(frame, "row", name)
        if own["value"].isna().all():
            left.annotate(
                ", ".join(own["status"].unique()), (0.02, i), va="center", color=SOFT_COLOR,
                fontsize=8.5, xycoords=("axes fraction", "data"),
            )  # fmt: skip
    first = frame.iloc[0]
    left.set_xlabel(f"{first['seek']} {first['parameter']} ({first['unit']})")
    right.set_xlabel("pf of the real model")
    for target in frame["target_pf"].unique():
        right.axvline(target, **REFERENCE_LINE)
    # long intervals of few failures do not squeeze the rest
    right.set_xlim(0.0, 2.5 * float(frame["target_pf"].max()))
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    handles = [
        key(f"{label}, 95 %", marker=look.marker, color=look.color)
        for label, look in styles.items()
    ]
    handles += [
        mark("simulated at the value", hollow=True, color=SOFT_COLOR),
        mark("simulated at the safe value", color=SOFT_COLOR),
        key("target", **REFERENCE_LINE),
    ]
    legend_below(figure, handles)
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
