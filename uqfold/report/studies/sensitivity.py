"""Figures of what matters: Sobol' indices, and derivatives of pf.

Two ways to the same number stand side by side, each in the colour of its method and with its
interval, so that a reader sees whether they agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.keys import COLUMN, TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import (
    distinct,
    having,
    joined,
    response_axis,
    selected,
    value_text,
)
from uqfold.report.style import COLUMN_INCHES, MethodStyle, figure_settings, method_styles

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROW_INCHES = 0.3
PANEL_INCHES = 2.3
REACH = 1.96
SMALLEST_INDEX = 1e-6
_SHORT = {"mean": "mean", "standard deviation": "std. dev."}
INPUT_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#5D3A9B")
INPUT_MARKERS = ("o", "s", "^", "D", "v", "P", "X")


@figure_settings()
def draw_sobol(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw main (filled) and total (hollow) Sobol' indices of every input on a logarithmic axis.

    Settings are the values of the keys of `SOBOL_FIGURE`.
    """
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    frame = joined(tables, settings["table"])
    inputs = distinct(frame, "input")
    labels = distinct(frame, "label")
    styles = method_styles(labels)
    figure = Figure(
        figsize=(COLUMN_INCHES, 0.9 + (ROW_INCHES + 0.1) * len(inputs)), layout="constrained"
    )
    axes = figure.subplots()
    axes.set_xscale("log")
    rows = [(label, order) for label in labels for order in ("main", "total")]
    for k, (label, order) in enumerate(rows):
        own = having(having(frame, "label", label), "order", order)
        y = np.array([inputs.index(name) for name in own["input"]]) + _offset(k, len(rows))
        value = own["index"].to_numpy()
        low = np.maximum(own["ci_low"].to_numpy(), SMALLEST_INDEX)
        shown = value > SMALLEST_INDEX
        _points(axes, value[shown], y[shown], styles[label], hollow=order == "total")
        axes.hlines(
            y, low, np.maximum(own["ci_high"].to_numpy(), low), color=styles[label].color,
            linewidth=1.0,
        )  # fmt: skip
    _name_rows(axes, inputs)
    axes.set_xlim(SMALLEST_INDEX, 1.5)
    axes.set_xlabel("Sobol' index of the response")
    handles = [
        *(_handle(styles[label], label) for label in labels),
        Line2D([], [], linestyle="", marker="o", color="#555555", label="main"),
        Line2D(
            [], [], linestyle="", marker="o", color="#555555", markerfacecolor="white",
            label="total",
        ),
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


@figure_settings()
def draw_derivatives(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw relative changes of pf per standard deviation, method beside method.

    Settings are the values of the keys of `DERIVATIVES_FIGURE`.
    """
    from matplotlib.figure import Figure

    frame = selected(joined(tables, settings["table"]), settings["where"])
    unit = response_axis(tables, frame["problem"].iloc[0])[1]
    parameters = list(dict.fromkeys(zip(frame["input"], frame["moment"], strict=True)))
    names = [f"{name}, {_SHORT[moment]}" for name, moment in parameters]
    labels, panels = distinct(frame, "label"), distinct(frame, settings["panels"])
    styles = method_styles(labels)
    width = COLUMN_INCHES if len(panels) == 1 else 1.1 + PANEL_INCHES * len(panels)
    figure = Figure(figsize=(width, 1.2 + ROW_INCHES * len(parameters)), layout="constrained")
    for axes, panel in zip(
        figure.subplots(1, len(panels), squeeze=False, sharey=True)[0], panels, strict=True
    ):
        rows = having(frame, settings["panels"], panel)
        axes.axvline(0.0, color="#555555", linewidth=0.8)
        for k, label in enumerate(labels):
            own = having(rows, "label", label)
            places = [
                parameters.index(pair) for pair in zip(own["input"], own["moment"], strict=True)
            ]
            y = np.array(places) + _offset(k, len(labels))
            value, half = own["per_std"].to_numpy(), REACH * own["per_std_error"].to_numpy()
            axes.hlines(y, value - half, value + half, color=styles[label].color, linewidth=1.2)
            _points(axes, value, y, styles[label], hollow=False)
        if settings["panels"] is not None:
            axes.set_title(value_text(settings["panels"], panel, unit))
        axes.set_xlabel("relative change of pf\nper std. dev. of the input")
        _name_rows(axes, names)
        axes.axhline(
            sum(moment == "mean" for _, moment in parameters) - 0.5, color="#BBBBBB", linewidth=0.8
        )
    figure.legend(
        handles=[_handle(styles[label], label) for label in labels],
        loc="outside lower center", ncols=len(labels),
    )  # fmt: skip
    return figure


@figure_settings()
def draw_derivative_curves(
    settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]
) -> Figure:
    """Draw relative changes of pf per standard deviation over T, one curve per input.

    Settings are the values of the keys of `DERIVATIVE_CURVES`.
    """
    from matplotlib.figure import Figure

    frame = selected(joined(tables, settings["table"]), settings["where"])
    unit = response_axis(tables, frame["problem"].iloc[0])[1]
    panels, inputs = distinct(frame, settings["panels"]), distinct(frame, "input")
    moments = distinct(frame, "moment")
    width = COLUMN_INCHES if len(panels) == 1 else 0.7 + PANEL_INCHES * len(panels)
    figure = Figure(figsize=(width, 0.9 + 1.7 * len(moments)), layout="constrained")
    grid = figure.subplots(len(moments), len(panels), squeeze=False, sharex=True, sharey="row")
    handles: dict[str, Any] = {}
    for i, moment in enumerate(moments):
        for j, panel in enumerate(panels):
            axes, rows = grid[i, j], having(frame, settings["panels"], panel)
            axes.axhline(0.0, color="#555555", linewidth=0.8)
            for k, name in enumerate(inputs):
                own = having(having(rows, "moment", moment), "input", name).sort_values("threshold")
                half = REACH * own["per_std_error"]
                handles[name] = axes.errorbar(
                    own["threshold"], own["per_std"], yerr=half, capsize=2.0, elinewidth=0.9,
                    color=INPUT_COLORS[k % len(INPUT_COLORS)],
                    marker=INPUT_MARKERS[k % len(INPUT_MARKERS)], label=name,
                )  # fmt: skip
            if i == 0 and settings["panels"] is not None:
                axes.set_title(value_text(settings["panels"], panel, unit))
            if i == len(moments) - 1:
                axes.set_xlabel(f"threshold $T${f' ({unit})' if unit else ''}")
        grid[i, 0].set_ylabel(f"by the {moment}")
    figure.supylabel("relative change of pf per std. deviation", fontsize=9.0)
    figure.legend(
        handles=list(handles.values()), loc="outside lower center",
        ncols=min(len(handles), 5 if len(panels) > 1 else 3),
    )  # fmt: skip
    return figure


def _offset(k: int, count: int) -> float:
    return 0.0 if count == 1 else 0.5 * (k / (count - 1) - 0.5)


def _points(axes: Axes, x: Any, y: Any, style: MethodStyle, *, hollow: bool) -> None:
    axes.plot(
        x, y, style.marker, color=style.color, markersize=4.5, markeredgewidth=1.0,
        markerfacecolor="white" if hollow else style.color,
    )  # fmt: skip


def _name_rows(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")


def _handle(style: MethodStyle, label: str) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], linestyle="", marker=style.marker, color=style.color, label=label)


_TABLES = Key("table", TABLE_NAMES, "Analyses to draw.")
_WHERE = Key("where", WHERE, "Rows to draw.", {})
_PANELS = Key("panels", COLUMN, "Column whose values are panels side by side.", None)

SOBOL_FIGURE = Kind(
    "sobol",
    "Main and total Sobol' indices of every input, method beside method.",
    (_TABLES,),
    draw_sobol,
    needs=("label", "input", "order", "index", "std_error", "ci_low", "ci_high"),
)
_NEEDS = ("label", "input", "moment", "threshold", "per_std", "per_std_error")
DERIVATIVES_FIGURE = Kind(
    "derivatives",
    "Relative change of pf per standard deviation of every input, method beside method.",
    (_TABLES, _WHERE, _PANELS),
    draw_derivatives,
    needs=_NEEDS,
)
DERIVATIVE_CURVES = Kind(
    "derivative-curves",
    "Relative change of pf per standard deviation over T, one curve per input.",
    (_TABLES, _WHERE, _PANELS),
    draw_derivative_curves,
    needs=_NEEDS,
)
