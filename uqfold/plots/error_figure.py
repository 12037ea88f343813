"""Error against cost: which method tells most for its model runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance
from uqfold.plots.style import (
    BAND_COLOR,
    HEADER,
    SOFT_COLOR,
    MethodStyle,
    figure_settings,
    method_styles,
)
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import (
    answer_text,
    comparison_rows,
    drawable,
    finite,
    in_figure,
    panel_key,
    panel_text,
    percent,
    reference_resolution,
)
from uqfold.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from uqfold.plots.wording import Row

SIZE_INCHES = (7.0, 4.6)
SIDE_STEP = 0.03
"""Distance between methods of nearly equal cost, as a part of the axis."""
SMALLEST = 1e-16
"""Errors below are drawn on the lower edge."""


@dataclass(frozen=True)
class Cloud:
    """Errors of one method: its rows (n,), cost (n,), error (n,), and whether judged (n,)."""

    label: str
    rows: Sequence[Row]
    n_evals: FloatArray
    error: FloatArray
    judged: BoolArray

    @property
    def cost(self) -> float:
        """Median cost of a criterion."""
        return float(np.median(self.n_evals))


@figure_settings()
def error_against_evaluations(frame: pd.DataFrame, ax: Axes | None = None) -> Axes:
    """Draw the error of Eq. (49) over the number of model runs, both logarithmic.

    A small marker is one criterion, filled where the error exceeds two standard errors of the
    reference and hollow where the reference cannot judge it; the large marker is the median.
    Methods of equal cost stand side by side.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or some rows of it.
    ax
        Where to draw; None: a figure of its own.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or has no answer with a reference.
    """
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    rows = drawable(comparison_rows(frame))
    if ax is not None:
        instance("ax", ax, Axes, "give Axes of matplotlib")
    clouds = error_clouds(rows)
    if not clouds:
        raise ValueError("frame has no answer with a reference: there is no error to draw")
    if ax is None:
        ax = Figure(figsize=SIZE_INCHES, layout="constrained").subplots()
    styles = method_styles(dict.fromkeys(row["label"] for row in rows))
    low, high = _error_limits(clouds)
    left, right = _cost_limits(clouds)
    ax.set(xscale="log", yscale="log", xlim=(left, right), ylim=(low, high))
    steps = side_steps(clouds, left, right)
    unit = frame.attrs.get(HEADER, {}).get("response_unit", "")
    for cloud in clouds:
        _draw(ax, cloud, styles[cloud.label], steps[cloud.label], low, unit)
    _format_ticks(ax)
    _draw_resolution(ax, clouds, low)
    ax.set_xlabel("evaluations of the model")
    ax.set_ylabel("error of the failure probability, Eq. (49)")
    ax.set_title(
        f"{in_figure(rows[0]['problem'], 40)}: error against cost", loc="left", fontweight="bold"
    )
    _add_legend(ax, clouds, [styles[cloud.label] for cloud in clouds])
    return ax


def error_clouds(rows: Sequence[Row]) -> list[Cloud]:
    """Return the errors of every method that has some."""
    by_label: dict[str, list[Row]] = {}
    for row in drawable(rows, "error"):
        by_label.setdefault(row["label"], []).append(row)
    return [
        Cloud(
            label,
            own,
            np.array([max(row["n_evals_row"], 1) for row in own], dtype=np.float64),
            np.array([row["error"] for row in own]),
            np.array([row["error"] > reference_resolution(row) for row in own]),
        )
        for label, own in by_label.items()
    ]


def side_steps(clouds: Sequence[Cloud], left: float, right: float) -> dict[str, float]:
    """Return the factor on the cost by which each method is moved aside from its neighbours."""
    step = (right / left) ** SIDE_STEP
    ordered = sorted(clouds, key=lambda cloud: cloud.cost)
    groups = [[ordered[0]]]
    for before, cloud in pairwise(ordered):
        if cloud.cost < step * before.cost:
            groups[-1].append(cloud)
        else:
            groups.append([cloud])
    return {
        cloud.label: step ** (i - (len(group) - 1) / 2)
        for group in groups
        for i, cloud in enumerate(group)
    }


def _error_limits(clouds: Sequence[Cloud]) -> tuple[float, float]:
    """Return the ends of the axis of errors; an error of zero belongs on its lower end."""
    errors = np.concatenate([cloud.error for cloud in clouds])
    positive = errors[errors > SMALLEST]
    if positive.size == 0:
        return 1e-6, 1.0
    return float(positive.min()) / 2.0, max(float(positive.max()) * 2.0, 0.02)


def _cost_limits(clouds: Sequence[Cloud]) -> tuple[float, float]:
    """Return the ends of the axis of costs, a factor of 30 apart at least."""
    costs = np.concatenate([cloud.n_evals for cloud in clouds])
    left, right = float(costs.min()) / 2.0, float(costs.max()) * 2.0
    widening = max(math.sqrt(30.0 * left / right), 1.0)
    return left / widening, right * widening


def _draw(ax: Axes, cloud: Cloud, style: MethodStyle, step: float, low: float, unit: str) -> None:
    look: dict[str, Any] = {"color": style.color, "marker": style.marker, "linestyle": ""}
    panels: dict[str, list[int]] = {}
    for i, row in enumerate(cloud.rows):
        panels.setdefault(panel_text(panel_key(row), unit), []).append(i)
    for name, own in panels.items():
        for judged in (True, False):
            chosen = [i for i in own if cloud.judged[i] == judged]
            # an error of exactly zero is drawn on the lower edge
            (line,) = ax.plot(
                step * cloud.n_evals[chosen], np.maximum(cloud.error[chosen], low), **look,
                markersize=4.0, markeredgewidth=0.8, alpha=0.75,
                markerfacecolor=style.color if judged else "white",
            )  # fmt: skip
            texts = [answer_text(cloud.rows[i], unit) for i in chosen]
            tell(line, gid(method=cloud.label, criterion=name), texts)
    typical = float(np.median(cloud.error))
    # the single criteria stay visible on it
    (line,) = ax.plot(step * cloud.cost, max(typical, low), **look, markersize=12.0,
                      markeredgewidth=1.3, markerfacecolor=style.pale, zorder=1.9)  # fmt: skip
    said = f"median error {percent(typical)}\n{cloud.cost:,.0f} evaluations"
    tell(line, gid(method=cloud.label), [said])


def _format_ticks(ax: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.7g}"))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100.0 * value:g} %"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.yaxis.set_minor_formatter(NullFormatter())


def _draw_resolution(ax: Axes, clouds: Sequence[Cloud], low: float) -> None:
    """Shade the errors that the reference is too uncertain to judge."""
    levels = finite(reference_resolution(row) for cloud in clouds for row in cloud.rows)
    if not levels:
        return
    for level, alpha, label in (
        (max(levels), 0.45, "below 2 standard errors\nof some references"),
        (min(levels), 1.0, "below 2 standard errors\nof every reference"),
    ):
        if level > low:
            ax.axhspan(
                low, level, facecolor=(BAND_COLOR, alpha), linewidth=0.0, zorder=0.2, label=label
            )


def _add_legend(ax: Axes, clouds: Sequence[Cloud], styles: Sequence[MethodStyle]) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D

    def sign(style: MethodStyle, size: float, face: Any, label: str) -> Line2D:
        return Line2D([], [], linestyle="", marker=style.marker, color=style.color,
                      markersize=size, markerfacecolor=face, label=label)  # fmt: skip

    handles: list[Artist] = [
        sign(style, 6.5, None, in_figure(cloud.label))
        for cloud, style in zip(clouds, styles, strict=True)
    ]
    grey = MethodStyle(SOFT_COLOR, "o")
    handles.append(sign(grey, 11.0, grey.pale, "median of the criteria"))
    handles.append(sign(grey, 4.0, None, "one criterion"))
    if not all(cloud.judged.all() for cloud in clouds):
        label = "one criterion, below 2\nstandard errors of\nits reference"
        handles.append(sign(grey, 4.0, "white", label))
    ax.legend(handles=[*handles, *ax.patches], loc="upper left", bbox_to_anchor=(1.01, 1.0))
