"""Correlated against independent units: both curves, their difference, and the tail."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import NUMBER, TABLE_NAME, WHERE, Key, Kind
from uqfold.report.studies.selection import (
    distinct,
    having,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.studies.stacked import limit_pf, stacked_panels, threshold_label
from uqfold.report.style import MethodStyle, figure_settings, method_styles, shades

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STANDARD_ERRORS = 2.0
"""Length of the bars on sampled differences."""
HEIGHTS = (1.6, 1.6, 1.8)
INDEPENDENT = (0, (3, 1.5))
"""Dashes of the curves of independent units."""


@figure_settings()
def draw_independence(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw what an analysis of the kind ``independence`` found, one shade per number of units.

    From top to bottom: reliability of correlated and of independent units; its difference, with
    that found by sampling; failure probabilities on a logarithmic axis.

    Parameters
    ----------
    settings
        Values of the keys of `INDEPENDENCE`.
    tables
        Tables of the study.

    Raises
    ------
    SelectionError
        If no row is chosen.
    """
    frame = selected(tables[settings["table"]], settings["where"])
    response, unit = response_axis(tables, frame["problem"].iloc[0])
    label = str(frame["label"].iloc[0])
    numbers = distinct(frame, "units")
    looks = shades(method_styles([label])[label], len(numbers), own_markers=True)
    sampled = bool(frame["sampled_difference"].notna().any())
    figure, grid = stacked_panels(HEIGHTS, 1, _handles(numbers, looks, sampled))
    body, gap, tail = grid[:, 0]
    for number, look in zip(numbers, looks, strict=True):
        own = having(frame, "units", number).sort_values("threshold")
        for column, dashes in (("pf", "-"), ("pf_independent", INDEPENDENT)):
            body.plot(own["threshold"], 1.0 - own[column], linestyle=dashes, color=look.color)
            tail.plot(own["threshold"], own[column], linestyle=dashes, color=look.color)
        _draw_difference(gap, own, look)
    body.set_ylabel("reliability")
    body.set_ylim(-0.03, 1.03)
    gap.set_ylabel("$R$ − $R_{independent}$")
    tail.set_ylabel("failure probability")
    limit_pf(tail, [*frame["pf"], *frame["pf_independent"]], settings["smallest_pf"])
    tail.set_xlabel(threshold_label(response, unit))
    figure.align_ylabels(grid[:, 0])
    return figure


def _draw_difference(axes: Axes, rows: pd.DataFrame, look: MethodStyle) -> None:
    axes.plot(rows["threshold"], rows["difference"], color=look.color)
    axes.errorbar(
        rows["threshold"],
        rows["sampled_difference"],
        yerr=STANDARD_ERRORS * rows["sampled_std_error"],
        fmt=look.marker,
        color=look.color,
        markersize=3.2,
        markerfacecolor="white",
        markeredgewidth=0.9,
        elinewidth=0.9,
        capsize=1.5,
    )


def _handles(numbers: Sequence[int], looks: Sequence[MethodStyle], sampled: bool) -> list[Any]:
    from matplotlib.lines import Line2D

    grey = "#555555"
    handles = [
        Line2D([], [], color=look.color, linewidth=2.5, label=value_text("units", number, ""))
        for number, look in zip(numbers, looks, strict=True)
    ]
    handles.append(Line2D([], [], color=grey, label="correlated"))
    handles.append(Line2D([], [], color=grey, linestyle=INDEPENDENT, label="independent"))
    if sampled:
        handles.append(
            Line2D(
                [],
                [],
                color=grey,
                linestyle="",
                marker="o",
                markerfacecolor="white",
                label=f"sampled, ± {STANDARD_ERRORS:g} s.e.",
            )
        )
    return handles


INDEPENDENCE = Kind(
    "independence",
    "Reliability of correlated and of independent units over T, their difference, and both pf.",
    (
        Key("table", TABLE_NAME, "An analysis of the kind `independence`."),
        Key("where", WHERE, "Rows to draw.", {}),
        Key("smallest_pf", NUMBER, "Lower end of the axis of pf; without it, what is drawn.", None),
    ),
    draw_independence,
    needs=("units", "threshold", "pf", "pf_independent", "sampled_difference"),
)
