"""A comparison of methods as one figure: the curve of pf once, and every method against it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.plots.panels import key, mark
from uqfold.plots.rows import Comparable, answers_frame
from uqfold.plots.style import (
    BAND_COLOR,
    REFERENCE_LINE,
    SOFT_COLOR,
    MethodStyle,
    figure_settings,
    method_styles,
)
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import (
    REFERENCE_STANDARD_ERRORS,
    answers_of,
    in_figure,
    percent,
    probability,
    threshold_label,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

WIDTH_INCHES = 8.4
REFERENCE = "the reference"
MEDIAN = "the median of the methods"
ABREAST = 3
"""Panels side by side; further ones stand below."""
SMALLEST_PF = 1e-16
"""Failure probabilities below are not drawn."""
SPREADS = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Largest ratio on an axis: the first that shows every answer, or the last."""
_ARROWS = {"down": 7, "up": 6}
"""Markers on the edge that point to what lies beyond it."""


@figure_settings()
def comparison(frame: Comparable) -> Figure:
    """Draw how methods compare: the curve of pf once, and the answers of every method against it.

    On top stands pf over the threshold, the reference with its band; below it one narrow row per
    method: pf over that of the reference, with the interval that the method states itself. There
    is a column for each tau and number of missions. Without references several methods are measured
    by their median. Under a single threshold there is one line per method.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or some rows of it; rows without an answer leave gaps. Or a
        result of a method, several, or a dict of label -> result.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or holds no answer.
    """
    from uqfold.plots.shown import ShownFigure

    answers = answers_of(frame)
    if answers["pf"].isna().all():
        raise ValueError("frame has no answer at a finite threshold: there is nothing to draw")
    problem = in_figure(answers["problem"].iloc[0], 40)
    answers, by = measured(answers)
    spread = _spread(answers) if by else math.inf
    answers = _placed(answers, spread**1.04).sort_values("threshold", kind="stable")
    styles = method_styles(answers["label"].unique())
    drawing = _Drawing(answers, styles, by, spread, threshold_label(answers_frame(frame, ())))
    panels = list(answers["panel"].unique())
    blocks = math.ceil(len(panels) / ABREAST)
    height, draw = 2.4 + (0.5 * len(styles) if by else 0.6), drawing.curves
    if answers["threshold"].nunique() == 1:
        height, draw = 0.8 + 0.36 * len(styles), drawing.lines
    figure = ShownFigure(figsize=(WIDTH_INCHES, height * blocks + 0.6), layout="constrained")
    parts = figure.subfigures(blocks, 1, squeeze=False)[:, 0]
    for part, beside in zip(parts, np.array_split(panels, blocks), strict=True):
        draw(part, list(beside))
    if handles := drawing.handles():
        figure.legend(handles=handles, loc="outside lower left", ncols=len(handles))
    title = f"methods against {by}" if by else "failure probability"
    title = f"{problem}: {title}" if problem else title
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    return figure


def measured(answers: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """Return answers beside what they are measured by, and its name.

    That is the reference, or else the median of several methods: its pf, and the lower and the
    upper end of it, are the columns ``level``, ``level_low`` and ``level_high``. Where there is
    neither, the level is 1 and the name empty.
    """
    known = answers["reference_pf"].where(answers["reference_pf"] > SMALLEST_PF)
    half = REFERENCE_STANDARD_ERRORS * answers["reference_std_error"]
    low, high = np.maximum(known - half, SMALLEST_PF), np.minimum(known + half, 1.0)
    level, by = known, REFERENCE
    if known.isna().all():
        positive = answers["pf"].where(answers["pf"] > SMALLEST_PF)
        level, by = positive.groupby(answers["criterion"]).transform("median"), MEDIAN
        if answers["label"].nunique() == 1 or level.isna().all():
            level, by = 1.0, ""
    return answers.assign(level=level, level_low=low, level_high=high), by


def _spread(answers: pd.DataFrame) -> float:
    """Return the largest ratio on the axes; long intervals are cut off, not to squeeze the rest."""
    shown = answers[["pf", "ci_low", "ci_high", "level_low", "level_high"]]
    ratios = shown.where(shown > SMALLEST_PF).div(answers["level"], axis=0)
    farthest = np.exp(np.log(ratios).abs()).max().fillna(1.0)
    most = max(farthest["pf"], min(farthest.max(), 1.9))
    return next((one for one in SPREADS if 0.95 * (one - 1.0) >= most - 1.0), SPREADS[-1])


def _placed(answers: pd.DataFrame, room: float) -> pd.DataFrame:
    """Return answers with their ratios, and which of them are arrows on the edge of the axis.

    An answer of zero is an arrow down at the upper end of its interval.
    """
    value, low, high = (answers[name] / answers["level"] for name in ("pf", "ci_low", "ci_high"))
    zero = answers["pf"] < SMALLEST_PF
    down, up = zero | (value < 1.0 / room), value > room
    return answers.assign(
        value=value.mask(zero, high).clip(1.0 / room, room), low=low.mask(zero),
        high=high.mask(zero), drawn_as=np.select([down, up], ["down", "up"], "answer"),
    )  # fmt: skip


@dataclass(frozen=True)
class _Drawing:
    """What all panels share: answers, looks, what measures them, the largest ratio, name of T."""

    answers: pd.DataFrame
    styles: dict[str, MethodStyle]
    by: str
    spread: float
    threshold: str

    def curves(self, part: SubFigure, panels: list[str]) -> None:
        """Draw panels side by side: pf over the threshold, below it the ratios of every method."""
        below = list(self.styles) if self.by else []
        grid = part.subplots(
            1 + len(below), len(panels), sharex=True, sharey="row", squeeze=False,
            height_ratios=[3.4, *([1.0] * len(below))],
        )  # fmt: skip
        for axes in grid[:-1].flat:
            axes.tick_params(axis="x", bottom=False)
        for column, panel in zip(grid.T, panels, strict=True):
            own = self.answers[self.answers["panel"] == panel]
            column[0].set_title(in_figure(panel, 48), loc="left")
            self.curve(column[0], own)
            for axes, label in zip(column[1:], below, strict=True):
                axes.set_gid(gid(method=label, criterion=panel))
                self.ratios(axes, own[own["label"] == label])
            column[-1].locator_params(axis="x", nbins=4)
            column[-1].set_xlabel(self.threshold)
        grid[0, 0].set_ylabel("failure probability pf")
        for row, label in zip(grid[1:], below, strict=True):
            row[0].set_ylabel(in_figure(label), rotation=0, ha="right", va="center")
            row[-1].annotate(
                self.remark(label), (1.015, 0.5), xycoords="axes fraction", va="center",
                fontsize=7.5, color=SOFT_COLOR,
            )  # fmt: skip
        if self.by:
            said = f"pf / pf of {self.by}"
            grid[1, 0].set_title(said, loc="left", fontsize=8.0, color=SOFT_COLOR)

    def lines(self, part: SubFigure, panels: list[str]) -> None:
        """Draw one line per method in each panel: its ratio, or its pf without a yardstick."""
        grid = part.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axes, panel in zip(grid, panels, strict=True):
            own = self.answers[self.answers["panel"] == panel]
            first = own.iloc[0]
            axes.set_gid(gid(criterion=panel))
            axes.set_xlabel(f"pf / pf of {self.by}" if self.by else "pf")
            title = in_figure(first["criterion"], 48)
            if self.by:
                title += f"\n{self.by}: pf = {probability(first['level'], 4)}"
                low, high = (first[name] / first["level"] for name in ("level_low", "level_high"))
                axes.axvspan(low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
                axes.axvline(1.0, **REFERENCE_LINE)
                axes.set_xlim(self.spread**-1.12, self.spread**1.12)
            axes.set_title(title, loc="left")
            for label, rows in own.groupby("label", sort=False):
                style, y = self.styles[label], [list(self.styles).index(label)]
                marker = {"down": 4, "up": 5}.get(rows["drawn_as"].iloc[0], style.marker)
                drawn = [
                    axes.hlines(y, rows["low"], rows["high"], color=style.color, linewidth=1.1),
                    *axes.plot(rows["value"], y, marker=marker, color=style.color),
                ]
                tell(drawn, gid(method=label, criterion=panel), rows["text"])
        names = [f"{in_figure(label)}\n{self.remark(label, ', ')}" for label in self.styles]
        grid[0].set_yticks(range(len(names)), names)
        grid[0].set_ylim(len(names) - 0.5, -0.5)

    def curve(self, axes: Axes, own: pd.DataFrame) -> None:
        """Draw pf of one panel, and what it is measured by."""
        shown = self.answers[["pf", *(["level"] if self.by else [])]]
        shown = shown.where(shown > SMALLEST_PF)
        low, high = shown.min(axis=None), shown.max(axis=None)
        axes.set_yscale("log")
        if low > 0.0:
            margin = 1.1 * (high / low) ** 0.06
            axes.set_ylim(low / margin, min(high * margin, 1.5))
        for label, rows in own.groupby("label", sort=False):
            if not self.by:
                self.points(axes, rows)
                continue
            # the rows below tell the methods apart
            pf, color = rows["pf"].where(rows["pf"] > SMALLEST_PF), self.styles[label].color
            drawn = axes.plot(rows["threshold"], pf, color=color, linewidth=1.0, alpha=0.8)
            tell(drawn, gid(method=label, criterion=own["panel"].iloc[0]))
        if self.by:
            levels = own.drop_duplicates("threshold")
            T, low, high = levels["threshold"], levels["level_low"], levels["level_high"]
            axes.fill_between(T, low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
            line: Any = {**REFERENCE_LINE, "marker": "o", "markersize": 3.0, "zorder": 3.0}
            drawn = axes.plot(T, levels["level"], **line)
            pf = levels["level"].map(lambda value: f"\npf = {probability(value, 4)}")
            belongs = gid(reference=self.by, criterion=own["panel"].iloc[0])
            tell(drawn, belongs, levels["criterion"] + pf)

    def ratios(self, axes: Axes, own: pd.DataFrame) -> None:
        """Draw the narrow row of one method in one panel."""
        from matplotlib.ticker import FixedLocator, NullLocator

        digits = 2 if self.spread > 1.04 else 4
        axes.set(yscale="log", ylim=(self.spread**-1.12, self.spread**1.12))
        axes.yaxis.set_major_locator(FixedLocator([1.0 / self.spread, 1.0, self.spread]))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:.{digits}g}")
        if own["pf"].isna().all():
            axes.text(0.5, 0.5, _status(own), transform=axes.transAxes, ha="center", va="center",
                      fontsize=8.0, color=SOFT_COLOR)  # fmt: skip
            return
        low, high = own["level_low"] / own["level"], own["level_high"] / own["level"]
        axes.fill_between(own["threshold"], low, high, color=BAND_COLOR, linewidth=0.0)
        axes.axhline(1.0, **REFERENCE_LINE)
        self.points(axes, own)

    def points(self, axes: Axes, own: pd.DataFrame) -> None:
        """Draw answers of one method, with intervals and arrows on the edge."""
        label, panel = own[["label", "panel"]].iloc[0]
        style, belongs = self.styles[label], gid(method=label, criterion=panel)
        T, barred = own["threshold"], own[(own["low"] + own["high"]).notna()]
        bars = axes.vlines(
            barred["threshold"], barred["low"], barred["high"], color=style.color, linewidth=1.1
        )
        tell(bars, belongs)
        joined = "-" if barred.empty else ""
        arrow: Any = {"linestyle": "", "markersize": 7.0, "clip_on": False}
        looks: dict[str, Any] = {
            "answer": {"marker": style.marker, "markersize": 4.8, "linestyle": joined},
            **{kind: {"marker": marker, **arrow} for kind, marker in _ARROWS.items()},
        }
        for kind, look in looks.items():
            values = own["value"].where(own["drawn_as"] == kind)
            if kind == "answer" or values.notna().any():
                drawn = axes.plot(T, values, color=style.color, linewidth=0.9, **look)
                tell(drawn, belongs, own["text"])

    def remark(self, label: str, between: str = "\n") -> str:
        """Return how far a method erred, or why it has no answer, and what it cost."""
        own = self.answers[self.answers["label"] == label]
        if own["pf"].isna().all():
            return _status(own)
        said = f"{own['n_evals'].max():,} evaluations"
        errors = own["error"].dropna()
        if errors.empty:
            return said
        kind = "error" if len(errors) == 1 else "median error"
        return f"{kind} {percent(errors.median())}{between}{said}"

    def handles(self) -> list[Any]:
        """Return what the legend shows."""
        from matplotlib.patches import Patch

        found: list[Any] = []
        if self.by:
            found.append(key(self.by, **REFERENCE_LINE))
        if self.by == REFERENCE:
            band = f"its ± {REFERENCE_STANDARD_ERRORS:g} standard errors"
            found.append(Patch(color=BAND_COLOR, label=band))
        if (self.answers["low"] + self.answers["high"]).notna().any():
            found.append(key("interval that the method states", color=SOFT_COLOR, linewidth=1.1))
        if ((self.answers["pf"] < SMALLEST_PF) & (self.answers["ci_high"] > SMALLEST_PF)).any():
            text = "pf = 0: upper end of the interval"
            found.append(mark(text, marker=_ARROWS["down"], color=SOFT_COLOR))
        return found


def _status(rows: pd.DataFrame) -> str:
    return "not asked" if rows.empty else str(rows["status"].iloc[0]).replace("_", " ")
