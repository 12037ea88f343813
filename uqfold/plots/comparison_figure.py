"""A comparison of methods as one figure: the curve of pf once, and every method against it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

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
    CriterionKey,
    answer_text,
    comparison_rows,
    count_text,
    criterion_key,
    criterion_text,
    drawable,
    finite,
    in_figure,
    panel_key,
    panel_text,
    percent,
    probability,
    quantity,
)
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

    from uqfold.plots.wording import Row

    Panels: TypeAlias = Mapping[tuple[float | None, str], list[Row]]

WIDTH_INCHES = 8.4
REFERENCE = "the reference"
ABREAST = 3
"""Panels side by side; further ones stand below."""
SMALLEST_PF = 1e-16
"""Failure probabilities below are not drawn."""
_SPREADS = (1.001, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Largest ratio on an axis: the first that shows every answer, or the last."""
_BEYOND = {("y", False): 7, ("y", True): 6, ("x", False): 4, ("x", True): 5}
"""Markers on the edge that point to what lies beyond it: below and above, left and right."""


@dataclass(frozen=True)
class Yardstick:
    """What answers are measured by: its name, and criterion -> pf with its lower and upper end."""

    name: str
    levels: Mapping[CriterionKey, tuple[float, float, float]]

    def level(self, row: Row) -> tuple[float, float, float]:
        """Return pf and its ends under the criterion of a row; NaN where there is none."""
        return self.levels.get(criterion_key(row), (math.nan,) * 3)


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
    from matplotlib.figure import Figure

    rows = drawable(comparison_rows(frame))
    if not drawable(rows, "pf"):
        raise ValueError("frame has no answer at a finite threshold: there is nothing to draw")
    panels: dict[tuple[float | None, str], list[Row]] = {}
    for row in rows:
        panels.setdefault(panel_key(row), []).append(row)
    labels = list(dict.fromkeys(row["label"] for row in rows))
    drawing = _Drawing(
        frame.attrs.get(HEADER, {}), rows, method_styles(labels), yardstick(rows)
    )  # fmt: skip
    curves = len({row["threshold"] for row in rows}) > 1
    keys = list(panels)
    abreast = math.ceil(len(keys) / math.ceil(len(keys) / ABREAST))
    blocks = [keys[i : i + abreast] for i in range(0, len(keys), abreast)]
    heights = [drawing.height(curves) for _ in blocks]
    size = (WIDTH_INCHES, sum(heights) + 0.6)
    figure = Figure(figsize=size, layout="constrained")
    parts = figure.subfigures(len(blocks), 1, height_ratios=heights, squeeze=False)[:, 0]
    for part, block in zip(parts, blocks, strict=True):
        draw = drawing.curves if curves else drawing.lines
        draw(part, {key: panels[key] for key in block}, abreast)
    _legend(figure, drawing)
    title = f"{in_figure(rows[0]['problem'], 40)}: {_title(drawing.by)}"
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    return figure


def _title(by: Yardstick | None) -> str:
    if by is None:
        return "failure probability"
    return f"methods against {in_figure(by.name)}" + (
        "" if by.name == REFERENCE else ", without a reference"
    )


def yardstick(rows: Sequence[Row]) -> Yardstick | None:
    """Return the references, or else the method with the narrowest intervals, or None."""
    known = {}
    for row in rows:
        pf, half = row["reference_pf"], REFERENCE_STANDARD_ERRORS * row["reference_std_error"]
        if pf > SMALLEST_PF:
            known[criterion_key(row)] = (pf, max(pf - half, SMALLEST_PF), min(pf + half, 1.0))
    if known:
        return Yardstick(REFERENCE, known)
    widths: dict[str, list[float]] = {}
    for row in rows:
        if row["pf"] > SMALLEST_PF and row["ci_high"] > row["ci_low"]:
            width = (row["ci_high"] - row["ci_low"]) / row["pf"]
            widths.setdefault(row["label"], []).append(width)
    if not widths or len({row["label"] for row in rows}) == 1:
        return None
    best = min(widths, key=lambda label: (-len(widths[label]), median(widths[label])))
    own = [row for row in rows if row["label"] == best and row["pf"] > SMALLEST_PF]
    return Yardstick(
        best, {criterion_key(row): (row["pf"], row["ci_low"], row["ci_high"]) for row in own}
    )


class _Drawing:
    """What all panels share."""

    def __init__(
        self,
        header: Mapping[str, Any],
        rows: Sequence[Row],
        styles: Mapping[str, MethodStyle],
        by: Yardstick | None,
    ) -> None:
        self.header, self.rows, self.styles, self.by = header, rows, styles, by
        self.unit: str = header.get("response_unit", "")
        self.spread = self._spread()

    def _spread(self) -> float:
        """Return the largest ratio on the axes."""
        if self.by is None:
            return 1.0
        farthest = 1.0
        for row in self.rows:
            level, *band = self.by.level(row)
            # long intervals are cut off rather than squeeze the rest
            for end, most in ((row["pf"], _SPREADS[-1]), *((one, 1.9) for one in
                              (row["ci_low"], row["ci_high"], *band))):  # fmt: skip
                if end > SMALLEST_PF and level > 0.0:
                    ratio = math.exp(abs(math.log(end / level)))
                    farthest = max(farthest, min(ratio, most))
        return next((one for one in _SPREADS if 0.95 * (one - 1.0) >= farthest - 1.0), _SPREADS[-1])

    def height(self, curves: bool) -> float:
        """Return the height of a block of panels (inches)."""
        if not curves:
            return 0.9 + 0.3 * len(self.styles)
        return 2.4 + (0.5 * len(self.styles) if self.by else 0.6)

    def curves(self, part: SubFigure, panels: Panels, abreast: int) -> None:
        """Draw pf over the threshold, and below it the ratios of every method."""
        below = list(self.styles) if self.by else []
        ratios = [3.4, *([1.0] * len(below))]
        grid = part.subplots(
            1 + len(below), abreast, sharex=True, sharey="row", squeeze=False,
            height_ratios=ratios,
        )  # fmt: skip
        for axes in grid[:, len(panels) :].flat:
            axes.set_axis_off()
        for axes in grid[:-1].flat:
            axes.tick_params(axis="x", bottom=False)
        for column, (key, rows) in zip(grid.T, panels.items(), strict=False):
            name = panel_text(key, self.unit)
            column[0].set_title(in_figure(name, 48), loc="left")
            self._pf_curve(column[0], rows, name)
            for axes, label in zip(column[1:], below, strict=True):
                self._ratio_row(axes, label, [row for row in rows if row["label"] == label], name)
            unit = f" ({in_figure(self.unit, 12)})" if self.unit else ""
            response = in_figure(self.header.get("response", "response"))
            column[-1].locator_params(axis="x", nbins=5 if abreast < ABREAST else 4)
            column[-1].set_xlabel(f"threshold T on {response}{unit}")
        self._pf_limits(grid[0, 0])
        grid[0, 0].set_ylabel("failure probability pf")
        for axes, label in zip(grid[1:, 0], below, strict=True):
            axes.set_ylabel(in_figure(label), rotation=0, ha="right", va="center")
        for axes, label in zip(grid[1:, len(panels) - 1], below, strict=True):
            self._remark(axes, label)
        if self.by:
            said = f"pf / pf of {in_figure(self.by.name)}"
            grid[1, 0].set_title(said, loc="left", fontsize=8.0, color=SOFT_COLOR)

    def _pf_curve(self, axes: Axes, rows: Sequence[Row], name: str) -> None:
        for label, style in self.styles.items():
            own = sorted((r for r in rows if r["label"] == label), key=lambda r: r["threshold"])
            x = np.array([row["threshold"] for row in own])
            belongs = gid(method=label, criterion=name)
            if self.by is None:
                self._draw(axes, label, belongs, x, own, "y")
                continue
            # the rows below tell the methods apart
            pf = [row["pf"] if row["pf"] > SMALLEST_PF else math.nan for row in own]
            (line,) = axes.plot(x, pf, color=style.color, linewidth=1.0, alpha=0.8)
            tell(line, belongs)
        levels = {row["threshold"]: self.by.level(row) for row in rows} if self.by else {}
        if levels:
            thresholds = sorted(levels)
            pf, low, high = np.array([levels[one] for one in thresholds]).T
            axes.fill_between(thresholds, low, high, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
            (line,) = axes.plot(thresholds, pf, **REFERENCE_LINE, marker="o", markersize=3.0,
                                zorder=3.0)  # fmt: skip
            words = [
                f"T = {quantity(one, self.unit)}, {name}\npf = {probability(levels[one][0], 4)}"
                for one in thresholds
            ]
            tell(line, gid(reference=self.by.name if self.by else "", criterion=name), words)

    def _pf_limits(self, axes: Axes) -> None:
        found = [row["pf"] for row in self.rows]
        found += [self.by.level(row)[0] for row in self.rows] if self.by else []
        positive = [one for one in found if one > SMALLEST_PF]
        if positive:
            low, high = min(positive), max(positive)
            margin = 1.1 * (high / low) ** 0.06
            logarithmic(axes, "y", low / margin, min(high * margin, 1.5))

    def _ratio_row(self, axes: Axes, label: str, rows: Sequence[Row], name: str) -> None:
        rows = sorted(rows, key=lambda row: row["threshold"])
        belongs = gid(method=label, criterion=name)
        axes.set_gid(belongs)
        x = np.array([row["threshold"] for row in rows])
        answered = any(not math.isnan(row["pf"]) for row in rows)
        if self.by and answered:
            levels = np.array([self.by.level(row) for row in rows])
            with np.errstate(invalid="ignore", divide="ignore"):
                ends = levels[:, 1:] / levels[:, :1]
            axes.fill_between(x, ends[:, 0], ends[:, 1], color=BAND_COLOR, linewidth=0.0)
            axes.axhline(1.0, **REFERENCE_LINE)
            self._draw(axes, label, belongs, x, rows, "y")
        self._ratio_axis(axes, "y")
        if not answered:
            axes.text(0.5, 0.5, _status(rows), transform=axes.transAxes, ha="center", va="center",
                      fontsize=8.0, color=SOFT_COLOR)  # fmt: skip

    def lines(self, part: SubFigure, panels: Panels, abreast: int) -> None:
        """Draw one line per method: its ratio, or its pf where there is no yardstick."""
        grid = part.subplots(1, abreast, sharex=True, sharey=True, squeeze=False)[0]
        for axes in grid[len(panels) :]:
            axes.set_axis_off()
        places = {label: float(i) for i, label in enumerate(self.styles)}
        for axes, (key, rows) in zip(grid, panels.items(), strict=False):
            name = panel_text(key, self.unit)
            title = in_figure(criterion_text(criterion_key(rows[0]), self.unit), 48)
            axes.set_gid(gid(criterion=name))
            if self.by:
                pf, low, high = self.by.level(rows[0])
                axes.axvspan(low / pf, high / pf, color=BAND_COLOR, linewidth=0.0, zorder=0.5)
                axes.axvline(1.0, **REFERENCE_LINE)
                title += f"\n{in_figure(self.by.name)}: pf = {probability(pf, 4)}"
            axes.set_title(title, loc="left")
            for label, place in places.items():
                own = [row for row in rows if row["label"] == label]
                belongs = gid(method=label, criterion=name)
                self._draw(axes, label, belongs, np.full(len(own), place), own, "x")
                if all(math.isnan(row["pf"]) for row in own):
                    at = axes.text(0.02, place, _status(own), va="center", fontsize=8.0,
                                   transform=axes.get_yaxis_transform(),
                                   color=SOFT_COLOR)  # fmt: skip
                    tell(at, belongs)
            if self.by:
                self._ratio_axis(axes, "x")
                axes.set_xlabel(f"pf / pf of {in_figure(self.by.name)}")
            else:
                axes.set_xlabel("failure probability pf")
            axes.grid(visible=False, axis="y")
        grid[0].set_yticks(list(places.values()), list(map(in_figure, places)))
        grid[0].set_ylim(len(places) - 0.4, -0.6)
        if not self.by:
            self._lines_limits(grid[0])
        for label, place in places.items():
            self._remark(grid[len(panels) - 1], label, place)

    def _lines_limits(self, axes: Axes) -> None:
        ends = [row[name] for row in self.rows for name in ("pf", "ci_low", "ci_high")]
        positive = [end for end in ends if end > SMALLEST_PF]
        margin = 1.1 * (max(positive) / min(positive)) ** 0.06 if positive else 1.0
        if positive:
            logarithmic(axes, "x", min(positive) / margin, max(positive) * margin)

    def _ratio_axis(self, axes: Axes, side: str) -> None:
        from matplotlib.ticker import FixedLocator, NullLocator

        room = self.spread**1.12
        logarithmic(axes, side, 1.0 / room, room)
        axis = axes.yaxis if side == "y" else axes.xaxis
        axis.set_major_locator(FixedLocator([1.0 / self.spread, 1.0, self.spread]))
        axis.set_minor_locator(NullLocator())
        digits = 2 if self.spread > 1.04 else 4
        axis.set_major_formatter(lambda value, _: f"{value:.{digits}g}")

    def _draw(
        self,
        axes: Axes,
        label: str,
        belongs: str,
        places: FloatArray,
        rows: Sequence[Row],
        side: str,
    ) -> None:
        """Draw answers along one side of the axes, with intervals, and marks of what lies beyond.

        An answer of zero appears as the upper end of its interval, with an arrow.
        """
        style, upright = self.styles[label], side == "y"
        scale = np.array([self.by.level(row)[0] if self.by else 1.0 for row in rows])
        value, low, high = (
            np.array([row[name] for row in rows]) / scale for name in ("pf", "ci_low", "ci_high")
        )
        zero = value < SMALLEST_PF
        room = self.spread**1.04
        over = np.full(len(rows), False) if self.by is None else value > room
        under = np.full(len(rows), False) if self.by is None else (value < 1.0 / room) & ~zero

        def pair(along: FloatArray) -> tuple[FloatArray, FloatArray]:
            return (places, along) if upright else (along, places)

        barred = np.isfinite(low + high) & ~zero
        if barred.any():
            bars = np.abs(np.vstack([value - low, high - value]))[:, barred]
            at = pair(value)
            tell(
                axes.errorbar(
                    at[0][barred], at[1][barred], fmt="none", ecolor=style.color, elinewidth=1.1,
                    capsize=2.0, **{f"{side}err": bars},
                ).get_children(),
                belongs,
            )  # fmt: skip
        shown = np.where(zero | over | under, math.nan, value)
        joined = "-" if upright and not barred.any() else ""
        (line,) = axes.plot(*pair(shown), linestyle=joined, linewidth=0.9, color=style.color,
                            marker=style.marker, markersize=4.8)  # fmt: skip
        tell(line, belongs, [self._text(row) for row in rows])
        edges = ((zero, np.minimum(high, room) if self.by else high, False),
                 (over, np.full(len(rows), room), True),
                 (under, np.full(len(rows), 1.0 / room), False))  # fmt: skip
        for chosen, along, above in edges:
            if chosen.any():
                (line,) = axes.plot(*pair(np.where(chosen, along, math.nan)), linestyle="",
                                    color=style.color, marker=_BEYOND[side, above],
                                    markersize=7.0, clip_on=False)  # fmt: skip
                tell(line, belongs, [self._text(row) for row in rows])

    def _remark(self, axes: Axes, label: str, place: float | None = None) -> None:
        """Write beside a method what it cost and how far it erred."""
        own = [row for row in self.rows if row["label"] == label]
        errors = finite(row["error"] for row in own)
        said = f"{count_text(max(row['n_evals'] for row in own), short=True)} evaluations"
        if errors:
            kind = "error" if len(errors) == 1 else "median error"
            said = f"{kind} {percent(median(errors))}\n{said}"
        at = (1.015, 0.5) if place is None else (1.015, place)
        coordinates: Any = "axes fraction" if place is None else ("axes fraction", "data")
        axes.annotate(said if place is None else said.replace("\n", ", "), at,
                      xycoords=coordinates, va="center", fontsize=7.5,
                      color=SOFT_COLOR)  # fmt: skip

    def _text(self, row: Row) -> str:
        return answer_text(row, self.unit)


def _status(rows: Sequence[Row]) -> str:
    return str(rows[0]["status"]).replace("_", " ") if rows else "not asked"


def _legend(figure: Figure, drawing: _Drawing) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Artist] = []
    if drawing.by is not None:
        band = f"its ± {REFERENCE_STANDARD_ERRORS:g} standard errors"
        if drawing.by.name != REFERENCE:
            band = "its interval"
        handles += [Line2D([], [], **REFERENCE_LINE, label=in_figure(drawing.by.name)),
                    Patch(color=BAND_COLOR, label=band)]  # fmt: skip
    if any(not math.isnan(row["ci_low"] + row["ci_high"]) for row in drawing.rows):
        handles.append(Line2D([], [], color=SOFT_COLOR, marker="|", markersize=6.0,
                              linewidth=1.1, label="interval that the method states"))  # fmt: skip
    if any(row["pf"] < SMALLEST_PF < row["ci_high"] for row in drawing.rows):
        handles.append(Line2D([], [], linestyle="", marker=7, color=SOFT_COLOR,
                              label="pf = 0: upper end of the interval"))  # fmt: skip
    if handles:
        figure.legend(handles=handles, loc="outside lower left", ncols=len(handles))
