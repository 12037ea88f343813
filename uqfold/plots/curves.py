"""Reliability, failure probability, error or difference of two problems over the threshold T.

A method keeps its colour; its curves (missions, or tau) are shades of it with markers of their own.
Where rows of two problems are drawn, the colours tell these apart instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from uqfold.checks import choice, instance, listed, or_none, real, refused, several, text
from uqfold.plots.panels import (
    HOLLOW,
    draw_bars,
    draw_judged,
    key,
    limit_errors,
    limit_pf,
    stacked,
)
from uqfold.plots.rows import distinct, having, joined, response_of, threshold_label, value_text
from uqfold.plots.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    SOFT_COLOR,
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
_CURVE: Any = {"markersize": 2.8, "linewidth": 0.9}
_ARROW: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}


@dataclass(frozen=True)
class _Line:
    """One curve: its problem or label, its value, its look, its rows, and marks beside them."""

    group: Any
    value: Any
    style: MethodStyle
    rows: pd.DataFrame
    marks: pd.DataFrame
    mark_color: str

    def within(self, column: str | None, value: Any) -> _Line:
        """Return its part in one of several panels."""
        rows, marks = having(self.rows, column, value), having(self.marks, column, value)
        return replace(self, rows=rows, marks=marks)


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
    frame
        What `uqfold.compare` returned, or several of these; of one problem, or of two.
    quantities
        What to draw, from top to bottom: ``reliability``; ``pf`` on a logarithmic axis; ``error``
        of Eq. (49) against the reference, hollow where the reference cannot judge it;
        ``difference`` of R of the first of two problems less that of the second.
    curves
        Column whose values are curves of their own: ``missions`` or ``tau``.
    panels
        Column whose values are panels side by side.
    check
        Label of a method (a simulation) drawn as marks with its intervals.
    paired
        Rows of `uqfold.analysis.paired_differences`, drawn as the difference with a band of two
        standard errors in place of that of the curves.
    names
        What the legend calls two problems; None: their names.
    smallest_pf
        Lower end of the axis of pf; None: that of what is drawn.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If there is nothing to draw, or a difference is not of two problems.
    """
    if not listed("quantities", quantities):
        raise refused("quantities", quantities, "give one or more")
    for i, quantity in enumerate(quantities):
        choice(f"quantities[{i}]", quantity, LABELS)
    or_none("names", names, several, text)
    whole, lines = _lines(frame, curves, check, paired, smallest_pf)
    or_none("panels", panels, choice, whole.columns)
    values = distinct(whole, panels)
    handles = list(_handles(whole, lines, quantities, curves, names))
    figure, grid = stacked([HEIGHTS[one] for one in quantities], len(values), handles)
    for column, value in zip(grid.T, values, strict=True):
        own = [line.within(panels, value) for line in lines]
        for axes, quantity in zip(column, quantities, strict=True):
            _draw(axes, own, quantity, curves, paired)
        if panels is not None:
            column[0].set_title(value_text(panels, value, response_of(whole)[1]))
    for row, quantity in zip(grid, quantities, strict=True):
        row[0].set_ylabel(LABELS[quantity])
        for axes in row:
            _limit(axes, whole, quantity, smallest_pf)
    if whole["problem"].nunique() > 1:
        grid[-1, 0].set_xlim(*_moving(lines, smallest_pf or 0.0))
    # in the middle of several panels, where there is room for it
    middle, even = len(values) // 2, len(values) % 2 == 0
    grid[-1, middle].set_xlabel(threshold_label(whole), x=0.0 if even else 0.5)
    figure.align_ylabels(grid[:, 0])
    return figure


def _lines(
    frames: Frames,
    curves: str | None,
    check: str | None,
    paired: pd.DataFrame | None,
    smallest_pf: float | None,
) -> tuple[pd.DataFrame, list[_Line]]:
    """Return all rows, and the curves in them; arguments are checked."""
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
        remedy = f"at most {len(PROBLEM_COLORS)} problems can be told apart"
        raise refused("frame", problems, remedy)
    two = len(problems) == 2
    column = "problem" if two else "label"
    groups, values = distinct(drawn, column), distinct(drawn, curves)
    looks = [MethodStyle(color, "o") for color in PROBLEM_COLORS]
    if not two:
        looks = list(method_styles(_style_names(drawn, groups)).values())
    lines = []
    for group, look in zip(groups, looks, strict=True):
        rows, beside = having(drawn, column, group), having(marks, "problem", group)
        color = look.color if two else "black"
        styles = shades(look, len(values), own_markers=two or len(groups) == 1)
        for value, style in zip(values, styles, strict=True):
            own = having(rows, curves, value)
            if not own.empty:
                own_marks = having(beside if two else marks, curves, value)
                lines.append(_Line(group, value, style, own, own_marks, color))
    return frame, lines


def _style_names(frame: pd.DataFrame, labels: Sequence[str]) -> list[str]:
    """Return the name by which each label finds its look: its method's, if no other has it."""
    methods = [str(having(frame, "label", label)["method"].iloc[0]) for label in labels]
    return [
        method if methods.count(method) == 1 and method not in labels else label
        for label, method in zip(labels, methods, strict=True)
    ]


def _draw(
    axes: Axes,
    lines: Sequence[_Line],
    quantity: str,
    column: str | None,
    paired: pd.DataFrame | None,
) -> None:
    if quantity == "difference":
        _draw_differences(axes, lines, column, paired)
        return
    for line in lines:
        if quantity == "error":
            hollow = _unjudged(line.rows)
            errors = line.rows["error"].clip(lower=SMALLEST_ERROR)
            draw_judged(axes, line.rows["threshold"], errors, hollow, line.style)
            continue
        _draw_reference(axes, line.rows, quantity)
        # points with intervals of their own are not joined
        stated = line.rows["ci_high"].notna()
        _draw_estimates(axes, line.rows[stated], quantity, line.style.marker, line.style.color)
        rows = line.rows[~stated & ((line.rows["pf"] > 0.0) | (quantity != "pf"))]
        axes.plot(rows["threshold"], rows[quantity], **_look(line))
        _draw_estimates(axes, line.marks, quantity, line.style.marker, line.mark_color)


def _look(line: _Line) -> dict[str, Any]:
    return {"color": line.style.color, "marker": line.style.marker, **_CURVE}


def _draw_reference(axes: Axes, rows: pd.DataFrame, quantity: str) -> None:
    known = rows[rows["reference_pf"].notna()].drop_duplicates("threshold")
    if known.empty:
        return
    T, pf, half = known["threshold"], known["reference_pf"], BAND * known["reference_std_error"]
    ends = [(pf - half).clip(lower=1e-16), (pf + half).clip(upper=1.0), pf]
    low, high, middle = [1.0 - one for one in ends] if quantity == "reliability" else ends
    axes.fill_between(T, low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
    # on top: where methods agree their curves would hide it
    axes.plot(T, middle, **REFERENCE_LINE, zorder=3.0)


def _draw_estimates(axes: Axes, rows: pd.DataFrame, quantity: str, marker: str, color: str) -> None:
    """Draw estimates with their intervals; on the axis of pf zero is an arrow at the upper end."""
    if quantity == "pf" and not rows.empty:
        none = rows[rows["pf"] == 0.0]
        axes.plot(none["threshold"], none["ci_high"], color=color, **_ARROW)
        rows = rows[rows["pf"] > 0.0]
    if rows.empty:
        return
    pf, low, high = rows["pf"], rows["ci_low"], rows["ci_high"]
    below, above = (high - pf, pf - low) if quantity == "reliability" else (pf - low, high - pf)
    bars = np.nan_to_num([below, above]).clip(min=0.0)
    draw_bars(axes, rows["threshold"], rows[quantity], bars, marker, color)


def _unjudged(rows: pd.DataFrame) -> Any:
    """Which errors that a figure can show are below two standard errors of the reference."""
    resolution = BAND * rows["reference_std_error"] / rows["reference_pf"]
    return (rows["error"] <= resolution) & (resolution > SMALLEST_ERROR)


def _draw_differences(
    axes: Axes, lines: Sequence[_Line], column: str | None, paired: pd.DataFrame | None
) -> None:
    """Draw R of the first problem less that of the second, by curves or by paired runs."""
    problems = list(dict.fromkeys(one for line in lines for one in line.rows["problem"]))
    if len(problems) != 2:
        raise refused("frame", problems, "a difference is that of two problems")
    second = {line.value: line for line in lines if line.group == problems[1]}
    axes.axhline(0.0, color="black", linewidth=0.6)
    drawn = [0.0]
    for line in (line for line in lines if line.group == problems[0]):
        if paired is not None:
            own = having(paired, column, line.value).sort_values("threshold")
            T, value, half = own["threshold"], own["difference"], BAND * own["std_error"]
            axes.fill_between(
                T, value - half, value + half, color=line.style.color, alpha=0.2, linewidth=0.0
            )
            axes.plot(T, value, **_look(line))
            continue
        other = second[line.value]
        both = line.rows.merge(other.rows, on="threshold", suffixes=("", "_2"))
        difference = both["pf_2"] - both["pf"]
        drawn += difference.tolist()
        axes.plot(both["threshold"], difference, **_look(line))
        marks = line.marks.merge(other.marks, on="threshold", suffixes=("", "_2"))
        half = 1.96 * np.hypot(marks["std_error"], marks["std_error_2"])
        difference = marks["pf_2"] - marks["pf"]
        draw_bars(axes, marks["threshold"], difference, half, line.style.marker, "black")
    if paired is not None:
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
        return
    # long bars are cut off: they must not flatten the curves
    margin = max(0.15 * (max(drawn) - min(drawn)), 1e-4)
    axes.set_ylim(min(drawn) - margin, max(drawn) + margin)


def _limit(axes: Axes, frame: pd.DataFrame, quantity: str, smallest_pf: float | None) -> None:
    if quantity == "reliability":
        axes.set_ylim(-0.03, 1.03)
    elif quantity == "pf":
        limit_pf(axes, [*frame["pf"], *frame["reference_pf"]], smallest_pf)
    elif quantity == "error":
        # over at least two decades; the smallest stands for all that are smaller still
        limit_errors(axes, 0.8 * SMALLEST_ERROR, max(1.5 * frame["error"].max(), 1.5e-2))
        axes.yaxis.set_major_formatter(
            lambda value, _: f"{'≤ ' if value <= 1.01 * SMALLEST_ERROR else ''}{100.0 * value:g} %"
        )


def _moving(lines: Sequence[_Line], smallest_pf: float) -> tuple[float, float]:
    """Return the range of T from where a first curve rises to where the last one has settled."""
    T = np.unique(np.concatenate([line.rows["threshold"] for line in lines]))
    first, last = [], []
    for line in lines:
        at, pf = line.rows["threshold"].to_numpy(), line.rows["pf"].to_numpy()
        first += at[line.rows["reliability"] >= SETTLED][:1].tolist()
        moves = (pf > (1.0 + SETTLED) * pf[-1]) & (pf >= smallest_pf)
        last += at[moves][-1:].tolist()
    if not first or not last or min(first) >= max(last):
        return float(T[0]), float(T[-1])
    # one step more on either side
    low, high = np.searchsorted(T, [min(first), max(last)])
    return float(T[max(low - 1, 0)]), float(T[min(high + 1, T.size - 1)])


def _handles(
    frame: pd.DataFrame,
    lines: Sequence[_Line],
    quantities: Sequence[str],
    column: str | None,
    names: Sequence[str] | None,
) -> Iterator[Any]:
    from matplotlib.patches import Patch

    groups = list(dict.fromkeys(line.group for line in lines))
    two = frame["problem"].nunique() > 1
    if two:
        for color, name in zip(PROBLEM_COLORS, names or groups, strict=True):
            yield key(name, color=color, linewidth=2.0)
    named: dict[str, MethodStyle] = {}
    for line in lines:
        words = [] if column is None else [value_text(column, line.value, response_of(frame)[1])]
        if not two and (len(groups) > 1 or column is None):
            words.insert(0, str(line.group))
        named.setdefault(", ".join(words), line.style)
    named.pop("", None)
    for name, style in named.items():
        color = "#777777" if two else style.color
        yield key(name, color=color, marker=style.marker, markersize=3.8)
    if set(quantities) == {"error"}:
        if any(_unjudged(line.rows).any() for line in lines):
            yield key("within 2 std. errors of ref.", linestyle="", color=SOFT_COLOR, marker="o",
                      markerfacecolor="white", markersize=3.6)  # fmt: skip
        return
    if any(not line.marks.empty for line in lines):
        yield key("simulation, 95 %", linestyle="", marker="o", color="black", **HOLLOW)
    if "pf" in quantities and ((frame["pf"] == 0.0) & (frame["ci_high"] > 0.0)).any():
        yield key("no failure: upper end", color="black", **_ARROW)
    known = frame[frame["reference_pf"].notna()]
    if not known.empty:
        yield key("reference", **REFERENCE_LINE)
        if (known["reference_std_error"] > 1e-6 * known["reference_pf"]).any():
            yield Patch(color=BAND_COLOR, label=f"its ± {BAND:g} std. errors")
