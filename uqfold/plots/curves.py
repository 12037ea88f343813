"""Reliability, failure probability, error or difference of two problems over the threshold T.

A method keeps its colour; its curves (missions, or tau) are shades of it with markers of their own.
Where rows of two problems are drawn, the colours tell these apart instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from uqfold.checks import choice, instance, listed, or_none, real, refused, several, text
from uqfold.plots.panels import GREY, axes_or_new, key, limit_pf, stacked
from uqfold.plots.rows import distinct, having, joined, response_of, threshold_label, value_text
from uqfold.plots.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    MethodStyle,
    figure_settings,
    method_styles,
    shades,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from uqfold.plots.rows import Frames

Quantity: TypeAlias = Literal["reliability", "pf", "error", "difference"]
LABELS: dict[str, str] = {
    "reliability": "reliability",
    "pf": "failure probability",
    "error": "error of pf, Eq. (49)",
    "difference": "difference of $R$,\nfirst less second",
}
HEIGHTS = {"reliability": 1.8, "pf": 1.9, "error": 1.8, "difference": 1.6}
PROBLEM_COLORS = ("#117733", "#882255")
"""Colours of two problems; no method has them in a figure of two problems."""
NEEDS = (
    "problem", "label", "method", "threshold", "tau", "missions", "pf", "reliability", "std_error",
    "ci_low", "ci_high", "reference_pf", "reference_std_error", "error",
)  # fmt: skip
BAND = 2.0
"""Standard errors of a reference, or of a paired difference, in its band on either side."""
SMALLEST_ERROR = 1e-4
SETTLED = 1e-3
"""Share of reliability up to which a curve has not begun to rise; of pf, has settled."""
_MARK: Any = {"markerfacecolor": "white", "markersize": 4.2, "markeredgewidth": 0.8}
_CURVE: Any = {"markersize": 2.8, "linewidth": 0.9}
_ARROW: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}


@dataclass(frozen=True)
class _Line:
    """One curve: what its group and value are, how it looks, its rows, and marks beside them."""

    group: Any
    value: Any
    style: MethodStyle
    rows: pd.DataFrame
    marks: pd.DataFrame
    mark_color: str


@dataclass(frozen=True)
class _Drawing:
    """The curves of a figure, and what is common to them."""

    frame: pd.DataFrame
    lines: Sequence[_Line]
    column: str | None
    problems: Sequence[str]
    paired: pd.DataFrame | None
    smallest_pf: float | None

    @property
    def marks(self) -> pd.DataFrame:
        import pandas as pd

        return pd.concat([line.marks for line in self.lines], ignore_index=True)


@figure_settings()
def reliability(
    frame: Frames,
    quantity: Quantity = "reliability",
    *,
    curves: str | None = None,
    check: str | None = None,
    paired: pd.DataFrame | None = None,
    smallest_pf: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw one quantity over the threshold T.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or several of these; of one problem, or of two.
    quantity
        ``reliability``; ``pf`` on a logarithmic axis; ``error`` of Eq. (49) against the
        reference, hollow where the reference cannot judge it; or ``difference`` of R of the first
        of two problems less that of the second.
    curves
        Column whose values are curves of their own: ``missions`` or ``tau``.
    check
        Label of a method (a simulation) drawn as marks with its intervals.
    paired
        Rows of `uqfold.analysis.paired_differences`, drawn as the difference with a band of two
        standard errors in place of that of the curves.
    smallest_pf
        Lower end of the axis of pf; None: that of what is drawn.
    ax
        Where to draw; None makes a figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError
        If there is nothing to draw, or a difference is not of two problems.
    """
    choice("quantity", quantity, LABELS)
    drawing = _drawing(frame, curves, check, paired, smallest_pf)
    axes = axes_or_new(ax)
    _draw(axes, drawing, quantity)
    axes.set_xlabel(threshold_label(drawing.frame))
    axes.legend(handles=list(_handles(drawing, [quantity], drawing.problems)))
    return axes


@figure_settings()
def reliability_panels(
    frame: Frames,
    quantities: Sequence[Quantity] = ("reliability", "pf"),
    *,
    curves: str | None = None,
    panels: str | None = None,
    check: str | None = None,
    paired: pd.DataFrame | None = None,
    names: Sequence[str] | None = None,
    smallest_pf: float | None = None,
) -> Figure:
    """Draw several quantities one above another, and values of a column side by side.

    Parameters
    ----------
    frame, curves, check, paired, smallest_pf
        As in `reliability`.
    quantities
        What to draw, from top to bottom.
    panels
        Column whose values are panels side by side.
    names
        What the legend calls two problems; None: their names.

    Returns
    -------
    matplotlib.figure.Figure
    """
    if not listed("quantities", quantities):
        raise refused("quantities", quantities, "give one or more")
    for i, quantity in enumerate(quantities):
        choice(f"quantities[{i}]", quantity, LABELS)
    or_none("names", names, several, text)
    drawing = _drawing(frame, curves, check, paired, smallest_pf)
    or_none("panels", panels, choice, drawing.frame.columns)
    side_by_side = distinct(drawing.frame, panels)
    handles = list(_handles(drawing, quantities, names or drawing.problems))
    figure, grid = stacked([HEIGHTS[one] for one in quantities], len(side_by_side), handles)
    unit = response_of(drawing.frame)[1]
    for j, panel in enumerate(side_by_side):
        own = drawing if panels is None else _within(drawing, panels, panel)
        for axes, quantity in zip(grid[:, j], quantities, strict=True):
            _draw(axes, own, quantity)
            axes.set_ylabel(LABELS[quantity] if j == 0 else "")
        if panels is not None:
            grid[0, j].set_title(value_text(panels, panel, unit))
    if "pf" in quantities:
        axes = grid[list(quantities).index("pf"), 0]
        limit_pf(axes, [*drawing.frame["pf"], *drawing.frame["reference_pf"]], smallest_pf)
    if len(drawing.problems) > 1:
        grid[-1, 0].set_xlim(*_moving(drawing))
    # in the middle of several panels, where there is room for it
    middle, even = len(side_by_side) // 2, len(side_by_side) % 2 == 0
    grid[-1, middle].set_xlabel(threshold_label(drawing.frame), x=0.0 if even else 0.5)
    figure.align_ylabels(grid[:, 0])
    return figure


def _drawing(
    frames: Frames,
    curves: str | None,
    check: str | None,
    paired: pd.DataFrame | None,
    smallest_pf: float | None,
) -> _Drawing:
    import pandas as pd

    frame = joined(frames, NEEDS).sort_values("threshold", kind="stable")
    or_none("curves", curves, choice, frame.columns)
    or_none("check", check, text)
    or_none("paired", paired, instance, pd.DataFrame, "give rows of paired_differences")
    or_none("smallest_pf", smallest_pf, real, above=0.0)
    drawn, marks = frame[frame["label"] != check], frame[frame["label"] == check]
    if drawn.empty:
        raise refused("check", check, "there is no curve besides its rows")
    problems = distinct(drawn, "problem")
    if len(problems) > len(PROBLEM_COLORS):
        raise refused(
            "frame", problems, f"at most {len(PROBLEM_COLORS)} problems can be told apart"
        )
    two = len(problems) == 2
    column = "problem" if two else "label"
    groups, values = distinct(drawn, column), distinct(drawn, curves)
    if two:
        looks = [MethodStyle(color, "o") for color in PROBLEM_COLORS]
    else:
        looks = list(method_styles(_style_names(drawn, groups)).values())
    lines = []
    for group, look in zip(groups, looks, strict=True):
        own_markers = two or len(groups) == 1
        beside = having(marks, "problem", group) if two else marks
        for value, style in zip(
            values, shades(look, len(values), own_markers=own_markers), strict=True
        ):
            rows = having(having(drawn, column, group), curves, value)
            if not rows.empty:
                color = look.color if two else "black"
                own_marks = having(beside, curves, value)
                lines.append(_Line(group, value, style, rows, own_marks, color))
    return _Drawing(frame, lines, curves, problems, paired, smallest_pf)


def _style_names(frame: pd.DataFrame, labels: Sequence[str]) -> list[str]:
    """Return the name by which each label finds its look: its method's, if no other has it."""
    methods = [str(having(frame, "label", label)["method"].iloc[0]) for label in labels]
    return [
        method if methods.count(method) == 1 and method not in labels else label
        for label, method in zip(labels, methods, strict=True)
    ]


def _within(drawing: _Drawing, column: str, value: Any) -> _Drawing:
    """Return the part of a drawing that has a value in a column."""
    lines = [
        _Line(
            line.group, line.value, line.style, having(line.rows, column, value),
            having(line.marks, column, value), line.mark_color,
        )
        for line in drawing.lines
    ]  # fmt: skip
    return _Drawing(
        drawing.frame, lines, drawing.column, drawing.problems, drawing.paired, drawing.smallest_pf
    )


def _draw(axes: Axes, drawing: _Drawing, quantity: str) -> None:
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
            _draw_marks(axes, line, quantity)
        if quantity == "pf":
            values = [*drawing.frame["pf"], *drawing.frame["reference_pf"]]
            limit_pf(axes, values, drawing.smallest_pf)
        else:
            axes.set_ylim(-0.03, 1.03)
    axes.set_ylabel(LABELS[quantity])


def _draw_reference(axes: Axes, line: _Line, quantity: str) -> None:
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


def _draw_curve(axes: Axes, line: _Line, quantity: str) -> None:
    """Draw a curve; points with intervals of their own are not joined."""
    stated = line.rows["ci_high"].notna()
    if stated.any():
        _draw_estimates(axes, line.rows[stated], quantity, line.style, line.style.color)
    rows = line.rows[~stated & ((line.rows["pf"] > 0.0) | (quantity != "pf"))]
    look: Any = {"color": line.style.color, "marker": line.style.marker, **_CURVE}
    axes.plot(rows["threshold"], rows[quantity], **look)


def _draw_marks(axes: Axes, line: _Line, quantity: str) -> None:
    if not line.marks.empty:
        _draw_estimates(axes, line.marks, quantity, line.style, line.mark_color)


def _draw_estimates(
    axes: Axes, rows: pd.DataFrame, quantity: str, style: MethodStyle, color: str
) -> None:
    """Draw estimates with their intervals; on the axis of pf zero is an arrow at the upper end."""
    if quantity == "pf":
        none = rows[rows["pf"] == 0.0]
        axes.plot(none["threshold"], none["ci_high"], color=color, **_ARROW)
        rows = rows[rows["pf"] > 0.0]
    y, low, high = (rows[name].to_numpy() for name in (quantity, "ci_low", "ci_high"))
    if quantity == "reliability":
        low, high = 1.0 - high, 1.0 - low
    _errorbars(axes, rows["threshold"], y, np.array([y - low, high - y]), style.marker, color)


def _errorbars(axes: Axes, x: Any, y: Any, bars: Any, marker: str, color: str) -> None:
    axes.errorbar(
        x, y, yerr=np.maximum(np.nan_to_num(bars), 0.0), fmt=marker, color=color,
        elinewidth=0.8, capsize=1.8, zorder=3.5, **_MARK,
    )  # fmt: skip


def _draw_error(axes: Axes, line: _Line) -> None:
    """Draw errors, hollow where the reference cannot judge them."""
    error = np.maximum(line.rows["error"], SMALLEST_ERROR)
    axes.plot(line.rows["threshold"], error, "-", color=line.style.color, linewidth=0.9)
    judged = ~_unjudged(line.rows)
    for chosen, face in ((judged, line.style.color), (~judged, "white")):
        axes.plot(
            line.rows["threshold"][chosen], error[chosen], line.style.marker,
            color=line.style.color, markersize=3.6, markerfacecolor=face, markeredgewidth=0.9,
        )  # fmt: skip


def _unjudged(rows: pd.DataFrame) -> Any:
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


def _draw_differences(axes: Axes, drawing: _Drawing) -> None:
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


def _moving(drawing: _Drawing) -> tuple[float, float]:
    """Return the range of T from where a first curve rises to where the last one has settled."""
    T = np.unique(np.concatenate([line.rows["threshold"] for line in drawing.lines]))
    first, last = [], []
    for line in drawing.lines:
        at, pf = line.rows["threshold"].to_numpy(), line.rows["pf"].to_numpy()
        first += at[line.rows["reliability"] >= SETTLED][:1].tolist()
        moves = (pf > (1.0 + SETTLED) * pf[-1]) & (pf >= (drawing.smallest_pf or 0.0))
        last += at[moves][-1:].tolist()
    if not first or not last or min(first) >= max(last):
        return float(T[0]), float(T[-1])
    # one step more on either side
    low, high = np.searchsorted(T, [min(first), max(last)])
    return float(T[max(low - 1, 0)]), float(T[min(high + 1, T.size - 1)])


def _handles(drawing: _Drawing, quantities: Sequence[str], names: Sequence[str]) -> Iterator[Any]:
    from matplotlib.patches import Patch

    unit, column = response_of(drawing.frame)[1], drawing.column
    two, groups = len(drawing.problems) == 2, {line.group for line in drawing.lines}
    if two:
        for color, name in zip(PROBLEM_COLORS, names, strict=True):
            yield key(name, color=color, linewidth=2.0)
    seen = set()
    for line in drawing.lines:
        words = [] if column is None else [value_text(column, line.value, unit)]
        if not two and (len(groups) > 1 or column is None):
            words.insert(0, str(line.group))
        text = ", ".join(words)
        if text and text not in seen:
            color = "#777777" if two else line.style.color
            yield key(text, color=color, marker=line.style.marker, markersize=3.8)
        seen.add(text)
    if set(quantities) == {"error"}:
        if any(_unjudged(line.rows).any() for line in drawing.lines):
            yield key("within 2 std. errors of ref.", linestyle="", color=GREY, marker="o",
                      markerfacecolor="white", markersize=3.6)  # fmt: skip
        return
    marks = drawing.marks
    if not marks.empty:
        yield key("simulation, 95 %", linestyle="", marker="o", color="black", **_MARK)
    bounded = drawing.frame[drawing.frame["ci_high"] > 0.0]
    if "pf" in quantities and (bounded["pf"] == 0.0).any():
        yield key("no failure: upper end", color="black", **_ARROW)
    known = drawing.frame[drawing.frame["reference_pf"].notna()]
    if not known.empty:
        yield key("reference", **REFERENCE_LINE)
        if (known["reference_std_error"] > 1e-6 * known["reference_pf"]).any():
            yield Patch(color=BAND_COLOR, label=f"its ± {BAND:g} std. errors")
