"""Reliability, failure probability, error or difference of two problems over the threshold T.

Colours tell problems apart, or else labels; curves of one colour (missions, or tau) have shades of
it and markers of their own. Answers with an interval are hollow marks that no line joins.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from uqfold.checks import choice, instance, or_none, refused, several
from uqfold.plots.panels import key, legend_below, mark, percent_axis
from uqfold.plots.rows import Comparable, answers_frame, distinct, having
from uqfold.plots.style import (
    BAND_COLOR,
    COLUMN_INCHES,
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

Quantity: TypeAlias = Literal["reliability", "pf", "error", "difference"]
PANELS = {
    "reliability": ("reliability", 1.8),
    "pf": ("failure probability", 1.9),
    "error": ("error of pf, Eq. (49)", 1.8),
    "difference": ("difference of $R$,\nfirst less second", 1.6),
}
"""Quantity -> its name on the axis, and the height of its panel (inches)."""
PANEL_INCHES = 2.4
"""Width of a panel where several stand side by side."""
NEEDS = ("problem", "label", "threshold", "tau", "missions", "pf")
MAY_HAVE = ["std_error", "ci_low", "ci_high", "reference_pf", "reference_std_error", "error"]
BAND = 2.0
"""Standard errors of a reference in its band, and of a difference in its bar, on either side."""
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
    differences: pd.DataFrame | None = None,
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
    differences
        Rows with ``difference`` and ``std_error``, such as `uqfold.analysis.paired_differences`
        returns, to be drawn in place of those of the curves, with two standard errors.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If there is nothing to draw, or a difference is not of two problems.
    """
    import pandas as pd
    from matplotlib.ticker import MaxNLocator

    from uqfold.plots.shown import ShownFigure

    if not (quantities := several("quantities", quantities, choice, get_args(Quantity))):
        raise refused("quantities", quantities, "give one or more")
    rows = answers_frame(frame, NEEDS)
    rows = rows.reindex(columns=list(dict.fromkeys([*rows.columns, *MAY_HAVE])))
    rows = rows.sort_values("threshold", kind="stable", ignore_index=True)
    for name, column in (("curves", curves), ("panels", panels)):
        or_none(name, column, choice, rows.columns)
    or_none("differences", differences, instance, pd.DataFrame, "give rows of paired_differences")
    group = "problem" if rows["problem"].nunique() > 1 else "label"
    styles = method_styles(distinct(rows, group))
    each, beside = distinct(rows, curves), distinct(rows, panels)
    heights = [PANELS[one][1] for one in quantities]
    width = COLUMN_INCHES if len(beside) == 1 else PANEL_INCHES * len(beside)
    figure = ShownFigure(figsize=(width, sum(heights) + 0.55), layout="constrained")
    grid = figure.subplots(
        len(heights), len(beside), squeeze=False, sharex=True, sharey="row", height_ratios=heights
    )
    ticks = MaxNLocator(7 if len(beside) == 1 else 5, steps=[1, 2, 5, 10])
    grid[0, 0].xaxis.set_major_locator(ticks)
    for quantity, line in zip(quantities, grid, strict=True):
        shown = _shown(rows, quantity, differences)
        line[0].set_ylabel(PANELS[quantity][0])
        for axes, value in zip(line, beside, strict=True):
            for name, style in styles.items():
                own = having(having(shown, panels, value), group, name)
                for one, look in zip(each, shades(style, len(each)), strict=True):
                    _draw(axes, quantity, having(own, curves, one), look)
            _limit(axes, quantity, shown)
    for axes, value in zip(grid[0], beside if panels else (), strict=False):
        axes.set_title(value_text(str(panels), value, response_of(rows)[1]))
    # in the middle of several panels, where there is room for it
    middle, even = len(beside) // 2, len(beside) % 2 == 0
    grid[-1, middle].set_xlabel(threshold_label(rows), x=0.0 if even else 0.5)
    figure.align_ylabels(grid[:, 0])
    stated = differences is not None or (rows["ci_low"] + rows["ci_high"]).notna().any()
    handles = [*_named(rows, styles, curves), *_explained(rows, quantities, stated)]
    legend_below(figure, handles)
    return figure


def _shown(rows: pd.DataFrame, quantity: str, differences: pd.DataFrame | None) -> pd.DataFrame:
    """Return rows with the ``value`` of a quantity and its interval ``low`` to ``high``."""
    if quantity == "error":
        return rows.assign(value=rows["error"].clip(lower=SMALLEST_ERROR))
    if quantity == "pf":
        return rows.assign(value=rows["pf"], low=rows["ci_low"], high=rows["ci_high"])
    if quantity == "reliability":
        low, high = 1.0 - rows["ci_high"], 1.0 - rows["ci_low"]
        return rows.assign(value=1.0 - rows["pf"], low=low, high=high)
    problems = distinct(rows, "problem")
    if len(problems) != 2:
        raise refused("frame", problems, "a difference is that of two problems")
    if differences is None:
        first, second = (having(rows, "problem", one) for one in problems)
        criterion = ["label", "threshold", "tau", "missions"]
        both = first.merge(second, on=criterion, suffixes=("", "_2"))
        error = np.hypot(both["std_error"], both["std_error_2"])
        differences = both.assign(difference=both["pf_2"] - both["pf"], std_error=error)
    own = differences.sort_values("threshold", kind="stable").assign(problem=problems[0])
    value, half = own["difference"], BAND * own["std_error"]
    return own.assign(value=value, low=value - half, high=value + half)


def _draw(axes: Axes, quantity: str, rows: pd.DataFrame, look: MethodStyle) -> None:
    """Draw one curve, its marks with intervals, and its reference."""
    color = look.color
    if quantity == "error":
        axes.plot(rows["threshold"], rows["value"], color=color, linewidth=0.9)
        for hollow, own in rows.groupby(_unjudged(rows)):
            face = "white" if hollow else color
            axes.plot(own["threshold"], own["value"], look.marker, color=color,
                      markerfacecolor=face, **_SMALL)  # fmt: skip
        return
    if quantity != "difference":
        _draw_reference(axes, rows, quantity)
    stated = rows["low"].notna()
    drawn, own = ~stated & ((rows["value"] > 0.0) | (quantity != "pf")), rows[stated]
    # a line joins neighbours: it is not led past a method's answers with intervals
    label = rows.get("label", rows["problem"])
    lined = label.isin(label[drawn]) & (drawn | stated)
    for _, line in rows.assign(value=rows["value"].where(drawn))[lined].groupby(label[lined]):
        axes.plot(line["threshold"], line["value"], color=color, marker=look.marker, **_CURVE)
    if own.empty:
        return
    value = own["value"]
    if quantity == "pf":
        axes.plot(own["threshold"], own["high"].where(value == 0.0), color=color, **_ARROW)
        value = value.where(value > 0.0)
    bars = np.clip([value - own["low"], own["high"] - value], 0.0, None)
    axes.errorbar(own["threshold"], value, bars, fmt=look.marker, color=color, elinewidth=0.8,
                  capsize=1.8, zorder=3.5, **_HOLLOW)  # fmt: skip


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
        values = [value for value in (*shown["pf"], *shown["reference_pf"]) if value > SMALLEST_PF]
        decade = np.floor(np.log10(min(values, default=SMALLEST_PF)) - 0.1)
        axes.set(yscale="log", ylim=(10.0**decade, 1.6))
    elif quantity == "error":
        # over at least two decades
        percent_axis(axes, SMALLEST_ERROR, max(1.5 * shown["error"].max(), 1.5e-2))
    else:
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 2), useMathText=True)
        curves = shown.loc[shown["low"].isna(), "value"]
        if len(curves):
            # long bars are cut off: they must not flatten the curves
            margin = max(0.15 * np.ptp([0.0, *curves]), 1e-4)
            axes.set_ylim(min(0.0, curves.min()) - margin, max(0.0, curves.max()) + margin)


def _named(rows: pd.DataFrame, styles: dict[str, MethodStyle], curves: str | None) -> Iterator[Any]:
    """Return entries of a legend: problems or labels by their colours, curves by their markers."""
    if curves is None:
        yield from (key(name, **vars(style), markersize=3.8) for name, style in styles.items())
        return
    if len(styles) > 1:
        yield from (key(name, color=style.color, linewidth=2.0) for name, style in styles.items())
    values = distinct(rows, curves)
    looks = shades(next(iter(styles.values())), len(values))
    for value, look in zip(values, looks, strict=True):
        color = SOFT_COLOR if len(styles) > 1 else look.color
        words = value_text(curves, value, response_of(rows)[1])
        yield key(words, color=color, marker=look.marker, markersize=3.8)


def _explained(rows: pd.DataFrame, quantities: Sequence[str], stated: bool) -> Iterator[Any]:
    """Return entries of a legend for what is no curve."""
    from matplotlib.patches import Patch

    if set(quantities) == {"error"}:
        if _unjudged(rows).any():
            yield mark("within 2 std. errors of ref.", hollow=True, color=SOFT_COLOR, **_SMALL)
        return
    if stated:
        yield mark("with its interval", color=SOFT_COLOR, **_HOLLOW)
    if "pf" in quantities and ((rows["pf"] == 0.0) & (rows["ci_high"] > 0.0)).any():
        yield key("no failure: upper end", color="black", **_ARROW)
    known = rows[rows["reference_pf"].notna()]
    if not known.empty:
        yield key("reference", **REFERENCE_LINE)
        if (known["reference_std_error"] > 1e-6 * known["reference_pf"]).any():
            yield Patch(color=BAND_COLOR, label=f"its ± {BAND:g} std. errors")
