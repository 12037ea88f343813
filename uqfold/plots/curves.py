"""Reliability, failure probability, error or difference of two problems over the threshold T.

A method keeps its colour; its curves (missions, or tau) are shades of it with markers of their own.
Where rows of two problems are drawn, the colours tell these apart instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from uqfold.checks import choice, instance, or_none, refused, several, text
from uqfold.plots.panels import key, legend_below, mark, percent_axis, stacked
from uqfold.plots.rows import Comparable, answers_frame, distinct, having
from uqfold.plots.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    SOFT_COLOR,
    MethodStyle,
    figure_settings,
    method_styles,
    shades,
)
from uqfold.plots.wording import response_of, threshold_label, value_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    Looks: TypeAlias = dict[tuple[str, Any], MethodStyle]

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
SMALLEST_PF = 1e-8
"""Failure probabilities below are not drawn."""
SMALLEST_ERROR = 1e-4
_CURVE: Any = {"markersize": 2.8, "linewidth": 0.9}
_ARROW: Any = {"linestyle": "", "marker": "$\\downarrow$", "markersize": 8.0}
_HOLLOW: Any = {"markerfacecolor": "white", "markersize": 4.2, "markeredgewidth": 0.8}
_SMALL: Any = {"markersize": 3.6, "markeredgewidth": 0.9}


@figure_settings()
def reliability_panels(
    frame: Comparable,
    quantities: Sequence[Quantity] = ("reliability", "pf"),
    *,
    curves: str | None = None,
    panels: str | None = None,
    check: str | None = None,
    paired: pd.DataFrame | None = None,
) -> Figure:
    """Draw several quantities one above another, and values of a column side by side.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, of one problem, or of two (`pandas.concat` joins frames);
        or a result of a method, several, or a dict of label -> result.
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

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If there is nothing to draw, or a difference is not of two problems.
    """
    import pandas as pd

    if not (quantities := several("quantities", quantities, choice, get_args(Quantity))):
        raise refused("quantities", quantities, "give one or more")
    rows = answers_frame(frame, NEEDS)
    rows = rows.sort_values("threshold", kind="stable", ignore_index=True)
    for name, column in (("curves", curves), ("panels", panels)):
        or_none(name, column, choice, rows.columns)
    or_none("check", check, text)
    or_none("paired", paired, instance, pd.DataFrame, "give rows of paired_differences")
    rows = rows.assign(is_check=rows["label"] == check)
    rows, looks = _grouped(rows, curves)
    values = distinct(rows[~rows["is_check"]], panels)
    figure, grid = stacked([HEIGHTS[one] for one in quantities], len(values))
    for quantity, line in zip(quantities, grid, strict=True):
        shown = _shown(rows, quantity, paired)
        line[0].set_ylabel(LABELS[quantity])
        for axes, value in zip(line, values, strict=True):
            for (group, one), look in looks.items():
                own = having(having(shown, panels, value), "group", group)
                _draw(axes, quantity, having(own, curves, one), look)
            _limit(axes, quantity, shown)
    for axes, value in zip(grid[0], values if panels else (), strict=False):
        axes.set_title(value_text(str(panels), value, response_of(rows)[1]))
    # in the middle of several panels, where there is room for it
    middle, even = len(values) // 2, len(values) % 2 == 0
    grid[-1, middle].set_xlabel(threshold_label(rows), x=0.0 if even else 0.5)
    figure.align_ylabels(grid[:, 0])
    legend_below(figure, list(_handles(rows, looks, quantities, curves)))
    return figure


def _grouped(rows: pd.DataFrame, curves: str | None) -> tuple[pd.DataFrame, Looks]:
    """Return rows with their ``group``, and the look of each curve of a group.

    Groups are two problems, or the labels of one; a check belongs to the first of these.
    """
    drawn = rows[~rows["is_check"]]
    if drawn.empty:
        raise refused("check", rows["label"].iloc[0], "there is no curve besides its rows")
    problems, values = distinct(rows, "problem"), distinct(drawn, curves)
    if len(problems) > len(PROBLEM_COLORS):
        remedy = f"at most {len(PROBLEM_COLORS)} problems can be told apart"
        raise refused("frame", problems, remedy)
    if len(problems) == 2:
        colors = dict(zip(problems, PROBLEM_COLORS, strict=True))
        styles = {name: MethodStyle(color, "o") for name, color in colors.items()}
        rows = rows.assign(group=rows["problem"], mark=rows["problem"].map(colors))
    else:
        methods = drawn.groupby("label", sort=False)["method"].first()
        # a label has the look of its method if no other label has it
        names = methods.mask(methods.duplicated(keep=False), methods.index.to_series())
        looks = method_styles(names)
        styles = {label: looks[name] for label, name in names.items()}
        group = rows["label"].mask(rows["is_check"], methods.index[0])
        rows = rows.assign(group=group, mark="black")
    own_markers = len(problems) == 2 or len(styles) == 1
    found = {}
    for name, style in styles.items():
        asked = distinct(having(rows, "group", name), curves)
        several_looks = shades(style, len(values), own_markers=own_markers)
        own = zip(values, several_looks, strict=True)
        found.update({(name, value): look for value, look in own if value in asked})
    return rows, found


def _shown(rows: pd.DataFrame, quantity: str, paired: pd.DataFrame | None) -> pd.DataFrame:
    """Return rows with the ``value`` of a quantity, its interval ``low`` to ``high``, or a band."""
    if quantity == "error":
        return rows.assign(value=rows["error"].clip(lower=SMALLEST_ERROR))
    if quantity == "pf":
        return rows.assign(value=rows["pf"], low=rows["ci_low"], high=rows["ci_high"])
    if quantity == "reliability":
        low, high = 1.0 - rows["ci_high"], 1.0 - rows["ci_low"]
        return rows.assign(value=rows["reliability"], low=low, high=high)
    problems = distinct(rows, "problem")
    if len(problems) != 2:
        raise refused("frame", problems, "a difference is that of two problems")
    if paired is not None:
        own = paired.sort_values("threshold", kind="stable")
        return own.assign(
            value=own["difference"], band=BAND * own["std_error"], low=np.nan, group=problems[0],
            is_check=False,
        )  # fmt: skip
    first, second = (having(rows, "problem", one) for one in problems)
    criterion = ["label", "threshold", "tau", "missions"]
    both = first.merge(second, on=criterion, suffixes=("", "_2"))
    value = both["pf_2"] - both["pf"]
    half = 1.96 * np.hypot(both["std_error"], both["std_error_2"])
    return both.assign(value=value, low=value - half, high=value + half)


def _draw(axes: Axes, quantity: str, rows: pd.DataFrame, look: MethodStyle) -> None:
    """Draw one curve, its marks with intervals, and its reference."""
    T, color = rows["threshold"], look.color
    if quantity == "error":
        axes.plot(T, rows["value"], color=color, linewidth=0.9)
        for hollow, own in rows.groupby(_unjudged(rows)):
            face = "white" if hollow else color
            axes.plot(own["threshold"], own["value"], look.marker, color=color,
                      markerfacecolor=face, **_SMALL)  # fmt: skip
        return
    if "band" in rows:
        ends = rows["value"] - rows["band"], rows["value"] + rows["band"]
        axes.fill_between(T, *ends, color=color, alpha=0.2, linewidth=0.0)
    if quantity in ("reliability", "pf"):
        _draw_reference(axes, rows[~rows["is_check"]], quantity)
    # points with intervals of their own are not joined
    stated = rows["low"].notna()
    line = rows[~stated & ((rows["value"] > 0.0) | (quantity != "pf"))]
    axes.plot(line["threshold"], line["value"], color=color, marker=look.marker, **_CURVE)
    for is_check, own in rows[stated].groupby("is_check"):
        color, value = own["mark"].iloc[0] if is_check else look.color, own["value"]
        if quantity == "pf":
            axes.plot(own["threshold"], own["high"].where(value == 0.0), color=color, **_ARROW)
            value = value.where(value > 0.0)
        bars = [value - own["low"], own["high"] - value]
        axes.errorbar(
            own["threshold"], value, np.clip(bars, 0.0, None), fmt=look.marker, color=color,
            elinewidth=0.8, capsize=1.8, zorder=3.5, **_HOLLOW,
        )  # fmt: skip


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


def _unjudged(rows: pd.DataFrame) -> Any:
    """Which errors that a figure can show are below two standard errors of the reference."""
    resolution = BAND * rows["reference_std_error"] / rows["reference_pf"]
    return (rows["error"] <= resolution) & (resolution > SMALLEST_ERROR)


def _limit(axes: Axes, quantity: str, shown: pd.DataFrame) -> None:
    if quantity == "reliability":
        axes.set_ylim(-0.03, 1.03)
    elif quantity == "pf":
        limit_pf(axes, [*shown["pf"], *shown["reference_pf"]])
    elif quantity == "error":
        # over at least two decades
        percent_axis(axes, SMALLEST_ERROR, max(1.5 * shown["error"].max(), 1.5e-2))
    else:
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
        if "band" not in shown:
            # long bars are cut off: they must not flatten the curves
            curves = [0.0, *shown.loc[~shown["is_check"], "value"]]
            margin = max(0.15 * np.ptp(curves), 1e-4)
            axes.set_ylim(min(curves) - margin, max(curves) + margin)


def limit_pf(axes: Axes, values: Iterable[float]) -> None:
    """Make an axis of pf logarithmic, from the smallest value up to one."""
    lowest = min((value for value in values if value > 0.0), default=SMALLEST_PF)
    decade = np.floor(np.log10(max(lowest, SMALLEST_PF)) - 0.1)
    axes.set(yscale="log", ylim=(10.0**decade, 1.6))


def _handles(
    rows: pd.DataFrame, looks: Looks, quantities: Sequence[str], curves: str | None
) -> Iterator[Any]:
    from matplotlib.patches import Patch

    problems, groups = distinct(rows, "problem"), {group for group, _ in looks}
    two = len(problems) == 2
    for problem, color in zip(problems if two else (), PROBLEM_COLORS, strict=False):
        yield key(problem, color=color, linewidth=2.0)
    named: dict[str, MethodStyle] = {}
    for (group, value), look in looks.items():
        words = [] if curves is None else [value_text(curves, value, response_of(rows)[1])]
        if not two and (len(groups) > 1 or curves is None):
            words.insert(0, group)
        named.setdefault(", ".join(words), look)
    for name, look in named.items():
        if name:
            color = "#777777" if two else look.color
            yield key(name, color=color, marker=look.marker, markersize=3.8)
    if set(quantities) == {"error"}:
        if _unjudged(rows).any():
            yield mark("within 2 std. errors of ref.", hollow=True, color=SOFT_COLOR, **_SMALL)
        return
    if rows["is_check"].any():
        yield mark("simulation, 95 %", color="black", **_HOLLOW)
    if "pf" in quantities and ((rows["pf"] == 0.0) & (rows["ci_high"] > 0.0)).any():
        yield key("no failure: upper end", color="black", **_ARROW)
    known = rows[rows["reference_pf"].notna()]
    if not known.empty:
        yield key("reference", **REFERENCE_LINE)
        if (known["reference_std_error"] > 1e-6 * known["reference_pf"]).any():
            yield Patch(color=BAND_COLOR, label=f"its ± {BAND:g} std. errors")
