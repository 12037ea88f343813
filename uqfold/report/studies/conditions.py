"""Two conditions over the threshold T: reliability, failure probability, and their difference.

One colour per condition, one shade and marker per curve (missions, or tau). Estimates by simulation
of the real model stand beside the curves as marks with their intervals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.keys import (
    COLUMN,
    NUMBER,
    TABLE_NAMES,
    TEXT,
    WHERE,
    Key,
    Kind,
    choice,
    list_of,
)
from uqfold.report.studies.marks import draw_estimates, draw_marks, mark_handle
from uqfold.report.studies.selection import (
    SelectionError,
    distinct,
    having,
    joined,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.studies.stacked import limit_pf, stacked_panels, threshold_label
from uqfold.report.style import MethodStyle, figure_settings, shades

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = {
    "reliability": "reliability",
    "pf": "failure probability",
    "difference": "difference of $R$,\nfirst less second",
}
HEIGHTS = {"reliability": 1.9, "pf": 1.9, "difference": 1.6}
# no colour of a method: all curves of such a figure come from one
COLORS = ("#117733", "#882255")
NORMAL_95 = 1.959964


@dataclass(frozen=True)
class _Pair:
    """Rows of both conditions, and how they look: value of the curves' column -> style."""

    rows: tuple[pd.DataFrame, pd.DataFrame]
    styles: tuple[Mapping[Any, MethodStyle], Mapping[Any, MethodStyle]]
    column: str
    check: str | None


@figure_settings()
def draw_conditions(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw two problems of a study against each other over T.

    Parameters
    ----------
    settings
        Values of the keys of `CONDITIONS`.
    tables
        Tables of the study.

    Raises
    ------
    SelectionError
        If a problem has no row, or there are not exactly two problems and names.
    """
    problems, names = settings["problems"], settings["names"]
    if len(problems) != 2 or len(names) != 2:
        raise SelectionError(f"problems {problems} and names {names}: give two of each")
    frame = selected(joined(tables, settings["table"]), settings["where"])
    rows = [selected(frame, {"problem": problem}) for problem in problems]
    lines = frame[frame["label"] != settings["check"]]
    values = distinct(lines, settings["curves"])
    styles = [
        dict(
            zip(values, shades(MethodStyle(color, "o"), len(values), own_markers=True), strict=True)
        )
        for color in COLORS
    ]
    pair = _Pair((rows[0], rows[1]), (styles[0], styles[1]), settings["curves"], settings["check"])
    response, unit = response_axis(tables, problems[0])
    parts = settings["parts"]
    figure, panels = stacked_panels(
        [HEIGHTS[part] for part in parts], 1, _handles(pair, names, unit)
    )
    grid = panels[:, 0]
    for part, axes in zip(parts, grid, strict=True):
        if part == "difference":
            _draw_differences(axes, pair)
        else:
            _draw_curves(axes, pair, as_pf=part == "pf")
        if part == "pf":
            limit_pf(axes, lines["pf"], settings["smallest_pf"])
        elif part == "reliability":
            axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel(PARTS[part])
    drawn = lines["threshold"]
    grid[-1].set_xlim(drawn.min(), drawn.max())
    grid[-1].set_xlabel(threshold_label(response, unit))
    figure.align_ylabels(grid)
    return figure


def _draw_curves(axes: Axes, pair: _Pair, *, as_pf: bool) -> None:
    for frame, styles in zip(pair.rows, pair.styles, strict=True):
        for value, style in styles.items():
            own = having(frame, pair.column, value).sort_values("threshold")
            curve = own[own["label"] != pair.check]
            axes.plot(
                curve["threshold"],
                curve["pf"] if as_pf else curve["reliability"],
                color=style.color,
                marker=style.marker,
                markersize=2.6,
                linewidth=0.9,
            )
            draw_estimates(axes, own[own["label"] == pair.check], style, as_pf=as_pf)


def _draw_differences(axes: Axes, pair: _Pair) -> None:
    """Draw reliability of the first condition less that of the second."""
    axes.axhline(0.0, color="black", linewidth=0.6)
    drawn = [0.0]
    for value, style in pair.styles[0].items():
        for check in (False, True):
            first, second = (
                having(frame[(frame["label"] == pair.check) == check], pair.column, value)
                .drop_duplicates("threshold")
                .set_index("threshold")
                .sort_index()
                for frame in pair.rows
            )
            common = first.index.intersection(second.index)
            difference = (second["pf"][common] - first["pf"][common]).to_numpy()
            look = MethodStyle("#444444", style.marker)
            if check:
                error = np.hypot(first["std_error"][common], second["std_error"][common])
                draw_marks(axes, common, difference, NORMAL_95 * error.to_numpy(), look)
            else:
                drawn += difference.tolist()
                axes.plot(
                    common, difference, color=style.color, marker=style.marker,
                    markersize=2.6, linewidth=0.9,
                )  # fmt: skip
    # long bars are cut off: they must not flatten the curves
    low, high = min(drawn), max(drawn)
    margin = max(0.15 * (high - low), 1e-4)
    axes.set_ylim(low - margin, high + margin)


def _handles(pair: _Pair, names: Sequence[str], unit: str) -> list[Any]:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=color, linewidth=2.0, label=name)
        for color, name in zip(COLORS, names, strict=True)
    ]
    handles += [
        Line2D([], [], color="#777777", marker=style.marker, markersize=3.5,
               label=value_text(pair.column, value, unit))
        for value, style in pair.styles[0].items()
    ]  # fmt: skip
    if any((frame["label"] == pair.check).any() for frame in pair.rows):
        handles.append(mark_handle())
    return handles


CONDITIONS = Kind(
    "conditions",
    "Two problems against each other over T: reliability, pf, and their difference.",
    (
        Key("table", TABLE_NAMES, "Runs to draw."),
        Key("problems", list_of(TEXT), "The two problems."),
        Key("names", list_of(TEXT), "What the legend calls them."),
        Key("where", WHERE, "Rows to draw.", {}),
        Key("curves", COLUMN, "Column whose values are curves of their own."),
        Key("check", TEXT, "Method that is drawn as marks with its intervals.", None),
        Key("parts", list_of(choice(*PARTS)), "From top to bottom.", ("reliability", "pf")),
        Key("smallest_pf", NUMBER, "Lower end of the axis of pf; without it, what is drawn.", None),
    ),
    draw_conditions,
    needs=("problem", "label", "threshold", "pf", "reliability", "std_error", "ci_low", "ci_high"),
)
