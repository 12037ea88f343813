"""A comparison of methods as one figure: the curve of pf once, and every method against it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.plots.panels import key
from uqfold.plots.style import (
    BAND_COLOR,
    HEADER,
    REFERENCE_LINE,
    SOFT_COLOR,
    MethodStyle,
    figure_settings,
    logarithmic,
    method_styles,
)
from uqfold.plots.telling import gid, tell
from uqfold.plots.wording import (
    REFERENCE_STANDARD_ERRORS,
    answer_text,
    comparison_rows,
    count_text,
    criterion_key,
    criterion_text,
    drawable,
    in_figure,
    panel_key,
    panel_text,
    percent,
    probability,
)

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

WIDTH_INCHES = 8.4
REFERENCE = "the reference"
ABREAST = 3
"""Panels side by side; further ones stand below."""
SMALLEST_PF = 1e-16
"""Failure probabilities below are not drawn."""
SPREADS = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Largest ratio on an axis: the first that shows every answer, or the last."""
_DOWN, _UP = {"y": 7, "x": 4}, {"y": 6, "x": 5}
"""Markers on the edge that point to what lies beyond it."""


@figure_settings()
def comparison(frame: pd.DataFrame) -> Figure:
    """Draw how methods compare: the curve of pf once, and the answers of every method against it.

    On top stands pf over the threshold, the reference with its band; below it one narrow row per
    method: pf over that of the reference, with the interval that the method states itself. There
    is a column for each tau and number of missions. Without references the methods are measured
    by the one with the narrowest intervals. Under a single threshold there is one line per method.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or some rows of it; rows without an answer leave gaps.

    Raises
    ------
    TypeError, ValueError
        If `frame` is none of these, or holds no answer.
    """
    import pandas as pd
    from matplotlib.figure import Figure

    rows = drawable(comparison_rows(frame))
    if not drawable(rows, "pf"):
        raise ValueError("frame has no answer at a finite threshold: there is nothing to draw")
    header = frame.attrs.get(HEADER, {})
    unit = header.get("response_unit", "")
    answers, by = measured(pd.DataFrame(rows))
    answers["panel"] = [panel_text(panel_key(row), unit) for row in rows]
    answers["text"] = [answer_text(row, unit) for row in rows]
    spread = _spread(answers) if by else math.inf
    placed = _placed(answers, spread**1.04).sort_values("threshold", kind="stable")
    drawing = _Drawing(placed, method_styles(answers["label"].unique()), by, spread, header)
    curves = answers["threshold"].nunique() > 1
    panels = list(answers["panel"].unique())
    abreast = math.ceil(len(panels) / math.ceil(len(panels) / ABREAST))
    blocks = [panels[i : i + abreast] for i in range(0, len(panels), abreast)]
    height = drawing.height(curves)
    figure = Figure(figsize=(WIDTH_INCHES, height * len(blocks) + 0.6), layout="constrained")
    for part, block in zip(figure.subfigures(len(blocks), 1, squeeze=False)[:, 0], blocks,
                           strict=True):  # fmt: skip
        if curves:
            drawing.curves(part, block, abreast)
        else:
            drawing.lines(part, block, abreast)
    if handles := drawing.handles():
        figure.legend(handles=handles, loc="outside lower left", ncols=len(handles))
    title = f"methods against {in_figure(by)}" if by else "failure probability"
    without = ", without a reference" if by not in ("", REFERENCE) else ""
    problem = in_figure(rows[0]["problem"], 40)
    figure.suptitle(f"{problem}: {title}{without}", x=0.01, ha="left", fontweight="bold")
    return figure


def measured(answers: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """Return answers beside what they are measured by, and its name.

    That is the reference, or else the method with the narrowest intervals: its pf, and the lower
    and the upper end of it, are the columns ``level``, ``level_low`` and ``level_high``. Where
    there is neither, the level is 1 and the name empty.
    """
    names = ["level", "level_low", "level_high"]
    known = answers["reference_pf"].where(answers["reference_pf"] > SMALLEST_PF)
    if known.notna().any():
        half = REFERENCE_STANDARD_ERRORS * answers["reference_std_error"]
        ends = {"level_low": np.maximum(known - half, SMALLEST_PF),
                "level_high": np.minimum(known + half, 1.0)}  # fmt: skip
        return answers.assign(level=known, **ends), REFERENCE
    positive = answers[answers["pf"] > SMALLEST_PF]
    width = (positive["ci_high"] - positive["ci_low"]) / positive["pf"]
    widths = width[width > 0.0].groupby(positive["label"], sort=False).agg(["size", "median"])
    if widths.empty or answers["label"].nunique() == 1:
        return answers.assign(level=1.0, level_low=math.nan, level_high=math.nan), ""
    best = str(widths.sort_values(["size", "median"], ascending=[False, True]).index[0])
    criterion = ["threshold", "tau", "missions"]
    own = positive.loc[positive["label"] == best, [*criterion, "pf", "ci_low", "ci_high"]]
    return answers.merge(own.set_axis([*criterion, *names], axis=1), "left", criterion), best


def _spread(answers: pd.DataFrame) -> float:
    """Return the largest ratio on the axes; long intervals are cut off, not to squeeze the rest."""
    farthest = 1.0
    for name, most in (("pf", SPREADS[-1]), ("ci_low", 1.9), ("ci_high", 1.9), ("level_low", 1.9),
                       ("level_high", 1.9)):  # fmt: skip
        own = answers[answers[name] > SMALLEST_PF]
        ratio = np.exp(np.abs(np.log(own[name] / own["level"]))).max()
        farthest = max(farthest, min(ratio, most)) if ratio > 1.0 else farthest
    return next((one for one in SPREADS if 0.95 * (one - 1.0) >= farthest - 1.0), SPREADS[-1])


def _placed(answers: pd.DataFrame, room: float) -> pd.DataFrame:
    """Return answers with their ratios, and where arrows on the edge point beyond the axis.

    An answer of zero is an arrow down at the upper end of its interval.
    """
    value, low, high = (answers[name] / answers["level"] for name in ("pf", "ci_low", "ci_high"))
    zero, over = answers["pf"] < SMALLEST_PF, value > room
    under = (value < 1.0 / room) & ~zero
    down = np.minimum(high, room).where(zero).mask(under, 1.0 / room)
    return answers.assign(
        value=value.mask(zero | over | under), low=low.mask(zero), high=high.mask(zero),
        down=down, up=value.where(over) / value * room,
    )  # fmt: skip


@dataclass(frozen=True)
class _Drawing:
    """What all panels share: answers, looks, by what they are measured, the largest ratio."""

    answers: pd.DataFrame
    styles: dict[str, MethodStyle]
    by: str
    spread: float
    header: dict[str, Any]

    @property
    def unit(self) -> str:
        return str(self.header.get("response_unit", ""))

    def height(self, curves: bool) -> float:
        """Return the height of a block of panels (inches)."""
        if not curves:
            return 0.9 + 0.3 * len(self.styles)
        return 2.4 + (0.5 * len(self.styles) if self.by else 0.6)

    def rows(self, panel: str, label: str | None = None) -> pd.DataFrame:
        own = self.answers[self.answers["panel"] == panel]
        return own if label is None else own[own["label"] == label]

    def curves(self, part: SubFigure, panels: list[str], abreast: int) -> None:
        """Draw pf over the threshold, and below it the ratios of every method."""
        below = list(self.styles) if self.by else []
        grid = part.subplots(
            1 + len(below), abreast, sharex=True, sharey="row", squeeze=False,
            height_ratios=[3.4, *([1.0] * len(below))],
        )  # fmt: skip
        for axes in grid[:, len(panels) :].flat:
            axes.set_axis_off()
        for axes in grid[:-1].flat:
            axes.tick_params(axis="x", bottom=False)
        unit = f" ({in_figure(self.unit, 12)})" if self.unit else ""
        response = in_figure(self.header.get("response", "response"))
        for column, panel in zip(grid.T, panels, strict=False):
            column[0].set_title(in_figure(panel, 48), loc="left")
            self.pf_curve(column[0], panel)
            for axes, label in zip(column[1:], below, strict=True):
                self.ratios(axes, panel, label)
            column[-1].locator_params(axis="x", nbins=5 if abreast < ABREAST else 4)
            column[-1].set_xlabel(f"threshold T on {response}{unit}")
        shown = ["pf", "level"] if self.by else ["pf"]
        _fit(grid[0, 0], "y", self.answers[shown], 1.5)
        grid[0, 0].set_ylabel("failure probability pf")
        for row, label in zip(grid[1:], below, strict=True):
            row[0].set_ylabel(in_figure(label), rotation=0, ha="right", va="center")
            row[len(panels) - 1].annotate(
                self.remark(label, "\n"), (1.015, 0.5), xycoords="axes fraction", va="center",
                fontsize=7.5, color=SOFT_COLOR,
            )  # fmt: skip
        if self.by:
            said = f"pf / pf of {in_figure(self.by)}"
            grid[1, 0].set_title(said, loc="left", fontsize=8.0, color=SOFT_COLOR)

    def pf_curve(self, axes: Axes, panel: str) -> None:
        for label, style in self.styles.items():
            own = self.rows(panel, label)
            if not self.by:
                self.points(axes, own, own["threshold"], "y")
                continue
            # the rows below tell the methods apart
            pf = own["pf"].where(own["pf"] > SMALLEST_PF)
            drawn = axes.plot(own["threshold"], pf, color=style.color, linewidth=1.0, alpha=0.8)
            tell(drawn, gid(method=label, criterion=panel))
        if self.by:
            levels = self.rows(panel).drop_duplicates("threshold")
            T, pf = levels["threshold"], levels["level"]
            axes.fill_between(
                T, levels["level_low"], levels["level_high"], color=BAND_COLOR, linewidth=0.0,
                zorder=0.5,
            )  # fmt: skip
            drawn = axes.plot(T, pf, **REFERENCE_LINE, marker="o", markersize=3.0, zorder=3.0)
            words = [
                f"{criterion_text(criterion_key(row), self.unit)}\n"
                f"pf = {probability(row['level'], 4)}"
                for row in levels.to_dict("records")
            ]
            tell(drawn, gid(reference=self.by, criterion=panel), words)

    def ratios(self, axes: Axes, panel: str, label: str) -> None:
        """Draw the narrow row of one method."""
        own = self.rows(panel, label)
        axes.set_gid(gid(method=label, criterion=panel))
        self.ratio_axis(axes, "y")
        if own["pf"].isna().all():
            axes.text(0.5, 0.5, _status(own), transform=axes.transAxes, ha="center", va="center",
                      fontsize=8.0, color=SOFT_COLOR)  # fmt: skip
            return
        low, high = own["level_low"] / own["level"], own["level_high"] / own["level"]
        axes.fill_between(own["threshold"], low, high, color=BAND_COLOR, linewidth=0.0)
        axes.axhline(1.0, **REFERENCE_LINE)
        self.points(axes, own, own["threshold"], "y")

    def lines(self, part: SubFigure, panels: list[str], abreast: int) -> None:
        """Draw one line per method: its ratio, or its pf where there is no yardstick."""
        grid = part.subplots(1, abreast, sharex=True, sharey=True, squeeze=False)[0]
        for axes in grid[len(panels) :]:
            axes.set_axis_off()
        for axes, panel in zip(grid, panels, strict=False):
            first = self.rows(panel).iloc[0]
            title = in_figure(criterion_text(criterion_key(first), self.unit), 48)
            axes.set_gid(gid(criterion=panel))
            axes.set_xlabel("failure probability pf")
            if self.by:
                pf, low, high = first["level"], first["level_low"], first["level_high"]
                axes.axvspan(low / pf, high / pf, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
                axes.axvline(1.0, **REFERENCE_LINE)
                title += f"\n{in_figure(self.by)}: pf = {probability(pf, 4)}"
                self.ratio_axis(axes, "x")
                axes.set_xlabel(f"pf / pf of {in_figure(self.by)}")
            axes.set_title(title, loc="left")
            axes.grid(visible=False, axis="y")
            for place, label in enumerate(self.styles):
                own = self.rows(panel, label)
                self.points(axes, own, np.full(len(own), float(place)), "x")
                if own["pf"].isna().all():
                    at = axes.text(0.02, place, _status(own), va="center", fontsize=8.0,
                                   transform=axes.get_yaxis_transform(),
                                   color=SOFT_COLOR)  # fmt: skip
                    tell(at, gid(method=label, criterion=panel))
        if not self.by:
            _fit(grid[0], "x", self.answers[["pf", "ci_low", "ci_high"]], math.inf)
        grid[0].set_yticks(range(len(self.styles)), list(map(in_figure, self.styles)))
        grid[0].set_ylim(len(self.styles) - 0.4, -0.6)
        for place, label in enumerate(self.styles):
            grid[len(panels) - 1].annotate(
                self.remark(label, ", "), (1.015, place), xycoords=("axes fraction", "data"),
                va="center", fontsize=7.5, color=SOFT_COLOR,
            )  # fmt: skip

    def ratio_axis(self, axes: Axes, side: str) -> None:
        from matplotlib.ticker import FixedLocator, NullLocator

        logarithmic(axes, side, self.spread**-1.12, self.spread**1.12)
        axis = axes.yaxis if side == "y" else axes.xaxis
        axis.set_major_locator(FixedLocator([1.0 / self.spread, 1.0, self.spread]))
        axis.set_minor_locator(NullLocator())
        digits = 2 if self.spread > 1.04 else 4
        axis.set_major_formatter(lambda value, _: f"{value:.{digits}g}")

    def points(self, axes: Axes, own: pd.DataFrame, places: Any, side: str) -> None:
        """Draw answers of one method along one side, with intervals and arrows on the edge."""
        if own.empty:
            return
        label, panel = own[["label", "panel"]].iloc[0]
        style, belongs = self.styles[label], gid(method=label, criterion=panel)
        look: dict[str, Any] = {"color": style.color, "linestyle": ""}
        barred = (own["low"] + own["high"]).notna()
        if barred.any():
            bars = axes.vlines if side == "y" else axes.hlines
            ends = own.loc[barred, ["low", "high"]].to_numpy().T
            tell(bars(np.asarray(places)[barred], *ends, color=style.color, linewidth=1.1), belongs)
        elif side == "y":
            look |= {"linestyle": "-", "linewidth": 0.9}
        arrows: dict[str, Any] = {"linestyle": "", "markersize": 7.0, "clip_on": False}
        for name, more in (
            ("value", {"marker": style.marker, "markersize": 4.8}),
            ("down", {"marker": _DOWN[side], **arrows}),
            ("up", {"marker": _UP[side], **arrows}),
        ):
            if name == "value" or own[name].notna().any():
                xy = (places, own[name]) if side == "y" else (own[name], places)
                tell(axes.plot(*xy, **{**look, **more}), belongs, own["text"])

    def remark(self, label: str, between: str) -> str:
        """Return what a method cost, and how far it erred."""
        own = self.answers[self.answers["label"] == label]
        said = f"{count_text(int(own['n_evals'].max()), short=True)} evaluations"
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
            band = "its interval"
            if self.by == REFERENCE:
                band = f"its ± {REFERENCE_STANDARD_ERRORS:g} standard errors"
            found = [key(in_figure(self.by), **REFERENCE_LINE), Patch(color=BAND_COLOR, label=band)]
        if (self.answers["ci_low"] + self.answers["ci_high"]).notna().any():
            found.append(key("interval that the method states", color=SOFT_COLOR, linewidth=1.1))
        if ((self.answers["pf"] < SMALLEST_PF) & (self.answers["ci_high"] > SMALLEST_PF)).any():
            text = "pf = 0: upper end of the interval"
            found.append(key(text, linestyle="", marker=_DOWN["y"], color=SOFT_COLOR))
        return found


def _fit(axes: Axes, side: str, values: pd.DataFrame, most: float) -> None:
    """Make an axis logarithmic that shows all positive values."""
    shown = values.where(values > SMALLEST_PF)
    low, high = shown.min(axis=None), shown.max(axis=None)
    if low > 0.0:
        margin = 1.1 * (high / low) ** 0.06
        logarithmic(axes, side, low / margin, min(high * margin, most))


def _status(rows: pd.DataFrame) -> str:
    return "not asked" if rows.empty else str(rows["status"].iloc[0]).replace("_", " ")
