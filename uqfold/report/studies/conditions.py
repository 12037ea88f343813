"""Two conditions over the threshold T: reliability, failure probability, and their difference.

One colour per condition, one shade and marker per curve (missions, or tau). Estimates by simulation
of the real model stand beside the curves as marks in the colour of their condition, with their
intervals. The axis of T runs from where the first curve rises to where the last one has settled.
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
from uqfold.report.studies.marks import draw_estimates, draw_marks, mark_handles
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
SETTLED = 1e-3
"""Share of reliability up to which a curve has not begun to rise; of pf, has settled."""


@dataclass(frozen=True)
class _Pair:
    """Rows of both conditions, and how they look: value of the curves' column -> style."""

    rows: tuple[pd.DataFrame, pd.DataFrame]
    styles: tuple[Mapping[Any, MethodStyle], Mapping[Any, MethodStyle]]
    column: str
    check: str | None
    paired: pd.DataFrame | None = None


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
        If a problem has no row, there are not exactly two problems and names, or no table has the
        name of the paired runs.
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
    paired = settings["paired"]
    if paired is not None and paired not in tables:
        raise SelectionError(f"paired = {paired!r}: the study has no analysis of that name")
    pair = _Pair(
        (rows[0], rows[1]),
        (styles[0], styles[1]),
        settings["curves"],
        settings["check"],
        None if paired is None else _own_pairs(tables[paired], problems, settings["where"]),
    )
    response, unit = response_axis(tables, problems[0])
    parts = settings["parts"]
    figure, panels = stacked_panels(
        [HEIGHTS[part] for part in parts], 1, _handles(pair, names, unit, parts)
    )
    grid = panels[:, 0]
    lowest = 0.0
    for part, axes in zip(parts, grid, strict=True):
        if part == "difference" and pair.paired is not None:
            _draw_pairs(axes, pair, pair.paired)
        elif part == "difference":
            _draw_differences(axes, pair)
        else:
            _draw_curves(axes, pair, as_pf=part == "pf")
        if part == "pf":
            limit_pf(axes, lines["pf"], settings["smallest_pf"])
            lowest = axes.get_ylim()[0]
        elif part == "reliability":
            axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel(PARTS[part])
    grid[-1].set_xlim(*_range(lines, settings["curves"], lowest))
    grid[-1].set_xlabel(threshold_label(response, unit))
    figure.align_ylabels(grid)
    return figure


def _draw_curves(axes: Axes, pair: _Pair, *, as_pf: bool) -> None:
    for frame, styles, color in zip(pair.rows, pair.styles, COLORS, strict=True):
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
            draw_estimates(axes, own[own["label"] == pair.check], style, as_pf=as_pf, color=color)


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
            if check:
                error = np.hypot(first["std_error"][common], second["std_error"][common])
                draw_marks(axes, common, difference, NORMAL_95 * error.to_numpy(), style)
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


def _draw_pairs(axes: Axes, pair: _Pair, paired: pd.DataFrame) -> None:
    """Draw the difference of paired runs with a band of two standard errors on either side."""
    axes.axhline(0.0, color="black", linewidth=0.6)
    for value, style in pair.styles[0].items():
        own = having(paired, pair.column, value).sort_values("threshold")
        T, difference, error = (own[name] for name in ("threshold", "difference", "std_error"))
        low, high = difference - 2.0 * error, difference + 2.0 * error
        axes.fill_between(T, low, high, color=style.color, alpha=0.2, linewidth=0.0)
        axes.plot(
            T, difference, color=style.color, marker=style.marker, markersize=2.6, linewidth=0.9
        )
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)


def _own_pairs(
    frame: pd.DataFrame, problems: Sequence[str], where: Mapping[str, Any]
) -> pd.DataFrame:
    """Give the paired runs of two problems, as the figure asks for them."""
    kept = {column: values for column, values in where.items() if column in frame}
    return selected(frame, {"problem": problems[0], "other": problems[1], **kept})


def _range(lines: pd.DataFrame, column: str, lowest: float) -> tuple[float, float]:
    """Give the range of T in which a curve still moves, or pf is still above the axis' end."""
    frame = lines.sort_values("threshold")
    T = np.unique(frame["threshold"])
    first, last = [], []
    for _, own in frame.groupby(["problem", column], dropna=False):
        pf, at = own["pf"].to_numpy(), own["threshold"].to_numpy()
        first.append(at[np.flatnonzero(own["reliability"] >= SETTLED)[:1]])
        moving = (pf > (1.0 + SETTLED) * pf[-1]) & (pf >= lowest)
        last.append(at[np.flatnonzero(moving)[-1:]])
    begin, end = np.concatenate(first), np.concatenate(last)
    if not begin.size or not end.size or begin.min() >= end.max():
        return float(T[0]), float(T[-1])
    # one step more on either side
    low = max(np.searchsorted(T, begin.min()) - 1, 0)
    high = min(np.searchsorted(T, end.max()) + 1, T.size - 1)
    return float(T[low]), float(T[high])


def _handles(pair: _Pair, names: Sequence[str], unit: str, parts: Sequence[str]) -> list[Any]:
    import pandas as pd
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
    marks = pd.concat([frame[frame["label"] == pair.check] for frame in pair.rows])
    return [*handles, *mark_handles(marks, as_pf="pf" in parts)]


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
        Key(
            "paired",
            TEXT,
            "Analysis of the kind `paired` whose differences are drawn, with a band of two "
            "standard errors, instead of those of the curves.",
            None,
        ),
        Key("smallest_pf", NUMBER, "Lower end of the axis of pf; without it, what is drawn.", None),
    ),
    draw_conditions,
    needs=("problem", "label", "threshold", "pf", "reliability", "std_error", "ci_low", "ci_high"),
)
