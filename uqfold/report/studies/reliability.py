"""Reliability over the threshold T: the body, the tail, and the error of Eq. (49).

These stand one above another. One column of panels is as wide as a column of print. A method keeps
its colour; where one method has several curves, they are shades of it with markers of their own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.keys import (
    COLUMN,
    FLAG,
    NUMBER,
    TABLE_NAMES,
    TEXT,
    WHERE,
    Key,
    Kind,
    choice,
    list_of,
)
from uqfold.report.drawing import (
    SMALLEST_PF,
    draw_method,
    draw_reference,
    method_curve,
    reference_curve,
)
from uqfold.report.studies.marks import NONE_FAILED, arrow_handle, draw_estimates, mark_handles
from uqfold.report.studies.selection import (
    distinct,
    having,
    joined,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.studies.stacked import limit_pf, stacked_panels, threshold_label
from uqfold.report.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    MethodStyle,
    figure_settings,
    method_styles,
    shades,
)
from uqfold.report.wording import REFERENCE_STANDARD_ERRORS, reference_resolution

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = {
    "reliability": "reliability",
    "pf": "failure probability",
    "error": "error of pf, Eq. (49)",
}
HEIGHTS = {"reliability": 1.6, "pf": 1.8, "error": 1.8}
SMALLEST_ERROR = 1e-4


@dataclass(frozen=True)
class _Line:
    """One curve of a panel: label of the method, value of the curves' column, how it looks."""

    label: str
    value: Any
    style: MethodStyle


@figure_settings()
def draw_reliability(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the rows of comparisons over T.

    Parameters
    ----------
    settings
        Values of the keys of `RELIABILITY`.
    tables
        Tables of the study.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    SelectionError
        If no row is chosen.
    """
    frame = selected(joined(tables, settings["table"]), settings["where"])
    response, unit = response_axis(tables, frame["problem"].iloc[0])
    panels = distinct(frame, settings["panels"])
    lines = _lines(frame[frame["label"] != settings["check"]], settings["curves"])
    parts = settings["parts"]
    handles = _handles(frame, lines, settings, unit)
    figure, grid = stacked_panels([HEIGHTS[part] for part in parts], len(panels), handles)
    for j, panel in enumerate(panels):
        rows = having(frame, settings["panels"], panel)
        for part, axes in zip(parts, grid[:, j], strict=True):
            _draw(axes, rows, lines, part, settings)
        if settings["panels"] is not None:
            grid[0, j].set_title(value_text(settings["panels"], panel, unit))
    # in the middle of several panels, where there is room for it
    grid[-1, len(panels) // 2].set_xlabel(
        threshold_label(response, unit),
        x=0.0 if len(panels) % 2 == 0 else 0.5,
    )
    for part, axes in zip(parts, grid[:, 0], strict=True):
        axes.set_ylabel(PARTS[part])
        if part == "pf":
            limit_pf(axes, [*frame["pf"], *frame["reference_pf"]], settings["smallest_pf"])
        elif part == "error":
            _limit_errors(axes, frame["error"].max())
    figure.align_ylabels(grid[:, 0])
    return figure


def _lines(frame: pd.DataFrame, column: str | None) -> list[_Line]:
    """Give every curve its look: a method its colour, several curves of one its shades."""
    labels = distinct(frame, "label")
    styles = dict(zip(labels, method_styles(_style_names(frame, labels)).values(), strict=True))
    values = distinct(frame, column)
    lines = []
    for label in labels:
        several = shades(styles[label], len(values), own_markers=len(labels) == 1)
        own = having(frame, "label", label)
        lines += [
            _Line(label, value, style)
            for value, style in zip(values, several, strict=True)
            if not having(own, column, value).empty
        ]
    return lines


def _style_names(frame: pd.DataFrame, labels: Sequence[str]) -> list[str]:
    """Give the name by which each label finds its look: its method's, if no other label has it."""
    methods = [str(having(frame, "label", label)["method"].iloc[0]) for label in labels]
    return [
        method if methods.count(method) == 1 and method not in labels else label
        for label, method in zip(labels, methods, strict=True)
    ]


def _draw(
    axes: Axes, frame: pd.DataFrame, lines: Sequence[_Line], part: str, settings: Mapping[str, Any]
) -> None:
    column = settings["curves"]
    values = list(dict.fromkeys(line.value for line in lines))
    if settings["reference"] and part != "error":
        for value in values:
            rows = having(frame, column, value).to_dict("records")
            draw_reference(axes, reference_curve(rows), part == "pf")
    for line in lines:
        own = having(having(frame, "label", line.label), column, line.value)
        rows = own.sort_values("threshold").to_dict("records")
        if part == "error":
            _draw_errors(axes, rows, line.style)
            continue
        curve = method_curve(rows, [row["threshold"] for row in rows])
        draw_method(axes, curve, line.style, part == "pf", size=3.6, joined=True)
        marks = having(having(frame, "label", settings["check"]), column, line.value)
        if settings["check"] is not None:
            draw_estimates(axes, marks, line.style, as_pf=part == "pf")
    if part == "pf":
        axes.set_yscale("log")
    elif part == "reliability":
        axes.set_ylim(-0.03, 1.03)
    else:
        axes.set_yscale("log")


def _limit_errors(axes: Axes, largest: float) -> None:
    """Make an axis of errors logarithmic, over at least two decades, with ticks in per cent."""
    from matplotlib.ticker import NullFormatter

    axes.set_yscale("log")
    axes.set_ylim(0.8 * SMALLEST_ERROR, max(1.5 * largest, 1.5e-2))
    axes.yaxis.set_major_formatter(_percent_tick)
    axes.yaxis.set_minor_formatter(NullFormatter())


def _percent_tick(value: float, _: float) -> str:
    """Write an error; the smallest stands for all that are smaller still."""
    below = "≤ " if math.isclose(value, SMALLEST_ERROR) else ""
    return f"{below}{100.0 * value:g} %"


def _draw_errors(axes: Axes, rows: Sequence[Mapping[str, Any]], style: MethodStyle) -> None:
    """Draw errors, hollow where the reference cannot judge them."""
    x = np.array([row["threshold"] for row in rows])
    error = np.maximum([row["error"] for row in rows], SMALLEST_ERROR)
    judged = np.array([not _within(row) for row in rows])
    axes.plot(x, error, "-", color=style.color, linewidth=0.9)
    for chosen, face in ((judged, style.color), (~judged, "white")):
        axes.plot(
            x[chosen],
            error[chosen],
            style.marker,
            color=style.color,
            markersize=3.6,
            markerfacecolor=face,
            markeredgewidth=0.9,
        )


def _handles(
    frame: pd.DataFrame, lines: Sequence[_Line], settings: Mapping[str, Any], unit: str
) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    column = settings["curves"]
    several = len({line.label for line in lines}) > 1
    filled = tuple(settings["parts"]) == ("error",)
    handles: list[Any] = []
    for line in lines:
        words = [line.label] if several or column is None else []
        words += [] if column is None else [value_text(column, line.value, unit)]
        handles.append(
            Line2D(
                [],
                [],
                color=line.style.color,
                marker=line.style.marker,
                markerfacecolor=line.style.color if filled else "white",
                markersize=4.5,
                label=", ".join(words),
            )
        )
    curves = any(part != "error" for part in settings["parts"])
    if curves:
        marks = frame["label"] == settings["check"]
        as_pf = "pf" in settings["parts"]
        handles += mark_handles(frame[marks], as_pf=as_pf)
        others = frame[~marks]
        if as_pf and ((others["pf"] < SMALLEST_PF) & (others["ci_high"] > SMALLEST_PF)).any():
            handles.append(arrow_handle(NONE_FAILED))
    if settings["reference"] and curves and frame["reference_pf"].notna().any():
        handles.append(Line2D([], [], **REFERENCE_LINE, label="reference"))
        if (frame["reference_std_error"] > 1e-6 * frame["reference_pf"]).any():
            band = f"its ± {REFERENCE_STANDARD_ERRORS:g} std. errors"
            handles.append(Patch(color=BAND_COLOR, label=band))
    if "error" in settings["parts"]:
        unjudged = [row for row in frame.to_dict("records") if _within(row)]
        if unjudged:
            handles.append(
                Line2D(
                    [],
                    [],
                    linestyle="",
                    color="#555555",
                    marker="o",
                    markerfacecolor="white",
                    markersize=3.6,
                    label="within 2 std. errors of ref.",
                )
            )
    return handles


def _within(row: Mapping[str, Any]) -> bool:
    """Whether an error that the figure can show is below two standard errors of the reference."""
    resolution = reference_resolution(row)
    return bool(row["error"] <= resolution and resolution > SMALLEST_ERROR)


RELIABILITY = Kind(
    "reliability",
    "Reliability, failure probability on a logarithmic axis, and error of Eq. (49), over T.",
    (
        Key("table", TABLE_NAMES, "Runs to draw."),
        Key("where", WHERE, "Rows to draw.", {}),
        Key("curves", COLUMN, "Column whose values are curves of their own.", None),
        Key("panels", COLUMN, "Column whose values are panels side by side.", None),
        Key("check", TEXT, "Method that is drawn as marks with its intervals.", None),
        Key(
            "parts",
            list_of(choice(*PARTS)),
            "What to draw, from top to bottom.",
            ("reliability", "pf"),
        ),
        Key("reference", FLAG, "Whether to draw the references.", True),
        Key("smallest_pf", NUMBER, "Lower end of the axis of pf; without it, what is drawn.", None),
    ),
    draw_reliability,
    needs=("label", "method", "threshold", "pf", "reference_pf", "error"),
)
