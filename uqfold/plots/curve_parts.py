"""What the figures over the threshold T are drawn from: curves, marks, references, errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import refused
from uqfold.plots.panels import limit_pf
from uqfold.plots.rows import having
from uqfold.plots.style import BAND_COLOR, REFERENCE_LINE, MethodStyle

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

LABELS: dict[str, str] = {
    "reliability": "reliability",
    "pf": "failure probability",
    "error": "error of pf, Eq. (49)",
    "difference": "difference of $R$,\nfirst less second",
}
BAND = 2.0
"""Standard errors of a reference, or of a paired difference, in its band on either side."""
SMALLEST_ERROR = 1e-4
MARK: Any = {"markerfacecolor": "white", "markersize": 4.2, "markeredgewidth": 0.8}
ARROW: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}
_CURVE: Any = {"markersize": 2.8, "linewidth": 0.9}


@dataclass(frozen=True)
class Line:
    """One curve: what its group and value are, how it looks, its rows, and marks beside them."""

    group: Any
    value: Any
    style: MethodStyle
    rows: pd.DataFrame
    marks: pd.DataFrame
    mark_color: str


@dataclass(frozen=True)
class Drawing:
    """The curves of a figure, and what is common to them."""

    frame: pd.DataFrame
    lines: Sequence[Line]
    column: str | None
    problems: Sequence[str]
    paired: pd.DataFrame | None
    smallest_pf: float | None

    @property
    def marks(self) -> pd.DataFrame:
        """Estimates that stand beside the curves."""
        import pandas as pd

        return pd.concat([line.marks for line in self.lines], ignore_index=True)


def draw(axes: Axes, drawing: Drawing, quantity: str) -> None:
    """Draw one quantity, and set its axis."""
    if quantity == "difference":
        _draw_differences(axes, drawing)
    elif quantity == "error":
        for line in drawing.lines:
            _draw_error(axes, line)
        _limit_errors(axes, drawing.frame["error"].max())
    else:
        for line in drawing.lines:
            _draw_reference(axes, line, quantity)
            _draw_curve(axes, line, quantity)
            _draw_estimates(axes, line.marks, quantity, line.style, line.mark_color)
        if quantity == "pf":
            values = [*drawing.frame["pf"], *drawing.frame["reference_pf"]]
            limit_pf(axes, values, drawing.smallest_pf)
        else:
            axes.set_ylim(-0.03, 1.03)
    axes.set_ylabel(LABELS[quantity])


def _draw_reference(axes: Axes, line: Line, quantity: str) -> None:
    rows = line.rows[line.rows["reference_pf"].notna()].drop_duplicates("threshold")
    if rows.empty:
        return
    pf, half = rows["reference_pf"], BAND * rows["reference_std_error"]
    low, high = np.maximum(pf - half, 1e-16), np.minimum(pf + half, 1.0)
    if quantity == "reliability":
        pf, low, high = 1.0 - pf, 1.0 - high, 1.0 - low
    axes.fill_between(rows["threshold"], low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
    # on top: where methods agree their curves would hide it
    axes.plot(rows["threshold"], pf, **REFERENCE_LINE, zorder=3.0)


def _draw_curve(axes: Axes, line: Line, quantity: str) -> None:
    """Draw a curve; points with intervals of their own are not joined."""
    stated = line.rows["ci_high"].notna()
    if stated.any():
        _draw_estimates(axes, line.rows[stated], quantity, line.style, line.style.color)
    rows = line.rows[~stated & ((line.rows["pf"] > 0.0) | (quantity != "pf"))]
    look: Any = {"color": line.style.color, "marker": line.style.marker, **_CURVE}
    axes.plot(rows["threshold"], rows[quantity], **look)


def _draw_estimates(
    axes: Axes, rows: pd.DataFrame, quantity: str, style: MethodStyle, color: str
) -> None:
    """Draw estimates with their intervals; on the axis of pf zero is an arrow at the upper end."""
    if rows.empty:
        return
    if quantity == "pf":
        none = rows[rows["pf"] == 0.0]
        axes.plot(none["threshold"], none["ci_high"], color=color, **ARROW)
        rows = rows[rows["pf"] > 0.0]
    y, low, high = (rows[name].to_numpy() for name in (quantity, "ci_low", "ci_high"))
    if quantity == "reliability":
        low, high = 1.0 - high, 1.0 - low
    _errorbars(axes, rows["threshold"], y, np.array([y - low, high - y]), style.marker, color)


def _errorbars(axes: Axes, x: Any, y: Any, bars: Any, marker: str, color: str) -> None:
    axes.errorbar(
        x, y, yerr=np.maximum(np.nan_to_num(bars), 0.0), fmt=marker, color=color,
        elinewidth=0.8, capsize=1.8, zorder=3.5, **MARK,
    )  # fmt: skip


def _draw_error(axes: Axes, line: Line) -> None:
    """Draw errors, hollow where the reference cannot judge them."""
    error = np.maximum(line.rows["error"], SMALLEST_ERROR)
    axes.plot(line.rows["threshold"], error, "-", color=line.style.color, linewidth=0.9)
    judged = ~unjudged(line.rows)
    for chosen, face in ((judged, line.style.color), (~judged, "white")):
        axes.plot(
            line.rows["threshold"][chosen], error[chosen], line.style.marker,
            color=line.style.color, markersize=3.6, markerfacecolor=face, markeredgewidth=0.9,
        )  # fmt: skip


def unjudged(rows: pd.DataFrame) -> Any:
    """Which errors that a figure can show are below two standard errors of the reference."""
    resolution = BAND * rows["reference_std_error"] / rows["reference_pf"]
    return (rows["error"] <= resolution) & (resolution > SMALLEST_ERROR)


def _limit_errors(axes: Axes, largest: float) -> None:
    """Make an axis of errors logarithmic, over at least two decades, with ticks in per cent."""
    from matplotlib.ticker import NullFormatter

    axes.set_yscale("log")
    axes.set_ylim(0.8 * SMALLEST_ERROR, max(1.5 * largest, 1.5e-2))
    axes.yaxis.set_major_formatter(
        # the smallest stands for all that are smaller still
        lambda value, _: f"{'≤ ' if value <= 1.01 * SMALLEST_ERROR else ''}{100.0 * value:g} %"
    )
    axes.yaxis.set_minor_formatter(NullFormatter())


def _draw_differences(axes: Axes, drawing: Drawing) -> None:
    """Draw R of the first problem less that of the second, by curves or by paired runs."""
    if len(drawing.problems) != 2:
        raise refused("frame", drawing.problems, "a difference is that of two problems")
    first = [line for line in drawing.lines if line.group == drawing.problems[0]]
    second = {line.value: line for line in drawing.lines if line.group == drawing.problems[1]}
    axes.axhline(0.0, color="black", linewidth=0.6)
    drawn = [0.0]
    for line in first:
        look: Any = {"color": line.style.color, "marker": line.style.marker, **_CURVE}
        if drawing.paired is not None:
            own = having(drawing.paired, drawing.column, line.value).sort_values("threshold")
            T, value, half = own["threshold"], own["difference"], BAND * own["std_error"]
            band: Any = {"color": line.style.color, "alpha": 0.2, "linewidth": 0.0}
            axes.fill_between(T, value - half, value + half, **band)
            axes.plot(T, value, **look)
            continue
        other = second[line.value]
        both = line.rows.merge(other.rows, on="threshold", suffixes=("", "_2"))
        difference = both["pf_2"] - both["pf"]
        drawn += difference.tolist()
        axes.plot(both["threshold"], difference, **look)
        marks = line.marks.merge(other.marks, on="threshold", suffixes=("", "_2"))
        half = 1.96 * np.hypot(marks["std_error"], marks["std_error_2"])
        _errorbars(axes, marks["threshold"], marks["pf_2"] - marks["pf"], half,
                   line.style.marker, "black")  # fmt: skip
    if drawing.paired is not None:
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
        return
    # long bars are cut off: they must not flatten the curves
    margin = max(0.15 * (max(drawn) - min(drawn)), 1e-4)
    axes.set_ylim(min(drawn) - margin, max(drawn) + margin)
