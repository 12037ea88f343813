"""Two conditions over the threshold T: reliability, failure probability, and their difference.

One colour per condition, one shade and marker per curve (missions, or tau). Estimates by simulation
of the real model stand beside the curves as marks with their intervals.
"""

from __future__ import annotations

import math
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
from uqfold.report.drawing import UPPER_BOUND
from uqfold.report.studies.selection import (
    SelectionError,
    distinct,
    having,
    joined,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.style import COLUMN_INCHES, MethodStyle, figure_settings, shades
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = {
    "reliability": "reliability",
    "pf": "failure probability",
    "difference": "difference of reliability",
}
HEIGHTS = {"reliability": 1.9, "pf": 1.9, "difference": 1.6}
LEGEND_ROW_INCHES = 0.17
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
    from matplotlib.figure import Figure

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
    handles = _handles(pair, names, unit)
    legend = LEGEND_ROW_INCHES * math.ceil(len(handles) / 2) + 0.1
    parts = settings["parts"]
    heights = [HEIGHTS[part] for part in parts]
    figure = Figure(figsize=(COLUMN_INCHES, sum(heights) + 0.45 + legend), layout="constrained")
    grid = figure.subplots(len(parts), 1, squeeze=False, sharex=True, height_ratios=heights)[:, 0]
    for part, axes in zip(parts, grid, strict=True):
        if part == "difference":
            _draw_differences(axes, pair, names)
        else:
            _draw_curves(axes, pair, as_pf=part == "pf")
        if part == "pf":
            axes.set_yscale("log")
            axes.set_ylim(settings["smallest_pf"], 1.5)
        elif part == "reliability":
            axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel(PARTS[part])
    drawn = lines["threshold"]
    grid[-1].set_xlim(drawn.min(), drawn.max())
    grid[-1].set_xlabel(f"threshold $T$ on {response}{f' ({unit})' if unit else ''}")
    figure.align_ylabels(grid)
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
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
            marks = own[own["label"] == pair.check]
            if as_pf:
                # an estimate of zero has only its upper bound
                none = marks[marks["pf"] == 0.0]
                axes.plot(none["threshold"], none["ci_high"], color="black", **UPPER_BOUND)
                marks = marks[marks["pf"] > 0.0]
            y = marks["pf" if as_pf else "reliability"].to_numpy()
            low, high = marks["ci_low"].to_numpy(), marks["ci_high"].to_numpy()
            ends = (low, high) if as_pf else (1.0 - high, 1.0 - low)
            _draw_marks(axes, marks["threshold"], y, np.array([y - ends[0], ends[1] - y]), style)


def _draw_differences(axes: Axes, pair: _Pair, names: Sequence[str]) -> None:
    """Draw reliability of the first condition less that of the second."""
    axes.axhline(0.0, color="black", linewidth=0.6)
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
                _draw_marks(axes, common, difference, NORMAL_95 * error.to_numpy(), look)
            else:
                axes.plot(
                    common, difference, color=style.color, marker=style.marker,
                    markersize=2.6, linewidth=0.9,
                )  # fmt: skip
    axes.annotate(
        f"above 0: {names[0]}\nis more reliable", (0.985, 0.96), xycoords="axes fraction",
        ha="right", va="top", fontsize=6.5, color="#444444",
    )  # fmt: skip


def _draw_marks(axes: Axes, x: Any, y: FloatArray, bars: FloatArray, style: MethodStyle) -> None:
    axes.errorbar(
        x,
        y,
        yerr=np.maximum(np.nan_to_num(bars), 0.0),
        fmt=style.marker,
        color="black",
        ecolor="black",
        markerfacecolor="white",
        markersize=4.2,
        markeredgewidth=0.8,
        elinewidth=0.8,
        capsize=1.8,
        zorder=3.0,
    )


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
        handles.append(
            Line2D([], [], linestyle="", color="black", marker="o", markerfacecolor="white",
                   markersize=4.2, label="simulation, 95 %")
        )  # fmt: skip
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
        Key("smallest_pf", NUMBER, "Lower end of the axis of pf.", 1e-6),
    ),
    draw_conditions,
    needs=("problem", "label", "threshold", "pf", "reliability", "std_error", "ci_low", "ci_high"),
)
