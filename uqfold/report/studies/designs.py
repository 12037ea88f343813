"""Designs for a target: values with their intervals, and what simulation says of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.keys import TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import (
    distinct,
    having,
    joined,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.style import COLUMN_INCHES, REFERENCE_LINE, figure_settings, method_styles
from uqfold.report.wording import NO_VALUE, probability

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_INCHES = 0.36
_CASE = ("threshold", "tau", "missions")


@figure_settings()
def draw_designs(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw design values with intervals, and pf by simulation at the value and at the safe value.

    Settings are the values of the keys of `DESIGNS_FIGURE`.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    frame = selected(joined(tables, settings["table"]), settings["where"])
    frame = frame.assign(case=_cases(frame, tables))
    cases, labels = distinct(frame, "case"), distinct(frame, "label")
    styles = method_styles(labels)
    figure = Figure(
        figsize=(2.0 * COLUMN_INCHES, 1.1 + ROW_INCHES * len(cases)), layout="constrained"
    )
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.25, 1.0))
    for k, label in enumerate(labels):
        own = having(frame, "label", label)
        y = np.array([cases.index(case) for case in own["case"]]) + _offset(k, len(labels))
        look = styles[label]
        left.hlines(y, own["low"], own["high"], color=look.color, linewidth=1.6)
        left.plot(own["value"], y, look.marker, color=look.color, markerfacecolor="white")
        for place, face in (("value", "white"), ("safe", look.color)):
            known = own[f"{place}_pf"].notna().to_numpy()
            shift = -0.12 if place == "value" else 0.12
            right.hlines(
                y[known] + shift, own[f"{place}_ci_low"][known], own[f"{place}_ci_high"][known],
                color=look.color, linewidth=1.2,
            )  # fmt: skip
            right.plot(
                own[f"{place}_pf"][known], y[known] + shift, look.marker, color=look.color,
                markerfacecolor=face,
            )  # fmt: skip
    for i, case in enumerate(cases):
        if not having(frame, "case", case)["value"].notna().any():
            status = ", ".join(dict.fromkeys(having(frame, "case", case)["status"]))
            left.annotate(
                status, (0.02, i), xycoords=("axes fraction", "data"), va="center",
                color="#555555", fontsize=8.5,
            )  # fmt: skip
    _finish(left, right, frame, cases)
    grey: Any = {"linestyle": "", "marker": "o", "color": "#555555"}
    handles = [
        *(
            Line2D(
                [], [], marker=styles[label].marker, color=styles[label].color,
                markerfacecolor="white", label=f"{label}, 95 %",
            )
            for label in labels
        ),
        Line2D([], [], **grey, markerfacecolor="white", label="simulated at the value"),
        Line2D([], [], **grey, label="simulated at the safe value"),
        Line2D([], [], **REFERENCE_LINE, label="target"),
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def design_table(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Give every design with its interval, and the verdict of simulation.

    Settings are the values of the keys of `DESIGNS`.
    """
    import pandas as pd

    frame = selected(joined(tables, settings["table"]), settings["where"])
    cases = _cases(frame, tables)
    rows = []
    for case, row in zip(cases, frame.to_dict("records"), strict=True):
        digits = _digits(row)
        found = not math.isnan(row["value"])
        rows.append(
            {
                "criterion": case.replace("$", "").replace("\\tau", "τ"),
                "method": row["label"],
                "evaluations": f"{row['n_evals']:,}",
                f"{row['parameter']} ({row['unit']})": f"{row['value']:.{digits}f}"
                if found
                else row["status"],
                "interval, 95 %": f"{row['low']:.{digits}f} to {row['high']:.{digits}f}"
                if math.isfinite(row["std_error"])
                else NO_VALUE,
                "simulated pf at the value": _simulated(row, "value"),
                "at the safe value": _simulated(row, "safe"),
                "intervals agree": row["agrees"] or NO_VALUE,
                "note": row["message"] if row["status"] == "doubtful" else "",
            }
        )
    return pd.DataFrame(rows)


def _cases(frame: pd.DataFrame, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Write the criterion of every row."""
    unit = response_axis(tables, frame["problem"].iloc[0])[1]
    cases = []
    for row in frame.to_dict("records"):
        words = [
            value_text(name, None if _missing(row[name]) else row[name], unit)
            for name in _CASE
            if name != "threshold" or not _missing(row[name])
        ]
        cases.append(", ".join(words))
    return cases


def _finish(left: Axes, right: Axes, frame: pd.DataFrame, cases: list[str]) -> None:
    row = frame.iloc[0]
    left.set_yticks(range(len(cases)), cases)
    left.set_ylim(len(cases) - 0.5, -0.5)
    left.set_xlabel(f"{row['seek']} {row['parameter']} ({row['unit']})")
    right.set_xlabel("pf of the real model")
    for target in dict.fromkeys(frame["target_pf"]):
        right.axvline(target, **REFERENCE_LINE)
    # long intervals of few failures do not squeeze the rest
    right.set_xlim(0.0, 2.5 * float(frame["target_pf"].max()))
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    for axes in (left, right):
        axes.grid(visible=False, axis="y")


def _offset(k: int, count: int) -> float:
    return 0.0 if count == 1 else 0.5 * (k / (count - 1) - 0.5)


def _digits(row: Mapping[str, Any]) -> int:
    """Decimals that show the interval to its second digit."""
    width = row["high"] - row["low"]
    if not (math.isfinite(width) and width > 0.0):
        return 4 if abs(row["value"]) < 10.0 else 2
    return min(max(1 - math.floor(math.log10(width)), 0), 8)


def _simulated(row: Mapping[str, Any], place: str) -> str:
    if math.isnan(row[f"{place}_pf"]):
        return NO_VALUE
    low, high = (probability(row[f"{place}_{end}"], 2) for end in ("ci_low", "ci_high"))
    meets = {"yes": "met", "no": "missed", "undecided": "undecided"}[row[f"{place}_meets"]]
    return f"{probability(row[f'{place}_pf'], 3)} ({low} to {high}): {meets}"


def _missing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


_KEYS = (
    Key("table", TABLE_NAMES, "Designs."),
    Key("where", WHERE, "Rows to show.", {}),
)
_NEEDS = ("label", "parameter", "value", "low", "high", "safe", "value_pf", "safe_pf")
DESIGNS_FIGURE = Kind(
    "designs",
    "Design values with their intervals, and pf by simulation at the values and the safe values.",
    _KEYS,
    draw_designs,
    needs=_NEEDS,
)
DESIGNS = Kind(
    "designs",
    "Design values with their intervals, and what simulation says of them.",
    _KEYS,
    design_table,
    needs=_NEEDS,
)
