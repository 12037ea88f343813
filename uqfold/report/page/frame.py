"""Where a chart lies in its picture: margins, and the two scales."""

from __future__ import annotations

import math
from dataclasses import dataclass

from uqfold.report.page.chart import Chart
from uqfold.report.page.scales import Line, line_around, tick_texts

WIDTH, HEIGHT = 480.0, 300.0
WIDTH_ALONE, HEIGHT_ALONE = 580.0, 340.0
ROW_HEIGHT = 28.0
TOP, BOTTOM, RIGHT = 26.0, 44.0, 14.0
CHARACTER = 6.6
"""Width of a digit at the size of tick labels."""


@dataclass(frozen=True)
class Frame:
    """Where a chart lies in its picture: edges of the plot, and the two scales."""

    left: float
    right: float
    top: float
    bottom: float
    x: Line
    y: Line

    def at_x(self, value: float) -> float:
        """Give the place of a value of x."""
        return self.left + self.x.place(value) * (self.right - self.left)

    def at_y(self, value: float) -> float:
        """Give the place of a value of y."""
        return self.bottom - self.y.place(value) * (self.bottom - self.top)

    def spread(self, side: str, low: float, high: float) -> tuple[float, float]:
        """Give the places of two values along an axis, cut off just outside the plot."""
        scale, start, end = self.x, self.left, self.right
        if side == "y":
            scale, start, end = self.y, self.bottom, self.top
        first, last = (start + _cut(scale.place(value)) * (end - start) for value in (low, high))
        return first, last


def frame_of(chart: Chart, *, alone: bool) -> Frame:
    """Find margins and scales of a chart, which may have the width of the page to itself."""
    width, full_height = (WIDTH_ALONE, HEIGHT_ALONE) if alone else (WIDTH, HEIGHT)
    x, y = _lines(chart)
    if chart.y.categories:
        labels = list(chart.y.categories)
        height = ROW_HEIGHT * len(labels)
    else:
        labels = tick_texts(y.ticks(), percent=chart.y.percent)
        height = full_height - TOP - BOTTOM
    longest = max(map(_label_width, labels), default=0.0)
    left = min(max(longest + 14.0, 30.0), 0.4 * width)
    return Frame(left, width - RIGHT, TOP, TOP + height, x, y)


def _cut(place: float) -> float:
    """Keep a place near the plot; what a logarithm cannot take lies below it."""
    return -0.05 if math.isnan(place) else min(max(place, -0.05), 1.05)


def _label_width(label: str) -> float:
    power = split_power(label)
    return CHARACTER * len(label) if power is None else CHARACTER * (len(power[0]) + 3.2)


def _lines(chart: Chart) -> tuple[Line, Line]:
    """Find the two scales."""
    points = list(chart.points())
    bars = [bar for point in points for bar in (point.low, point.high)]
    banded = [
        bar for one in chart.series if one.band for p in one.points for bar in (p.low, p.high)
    ]
    horizontal = [point.x for point in points] + [m.at for m in chart.marks if m.side == "x"]
    vertical = [point.y for point in points] + [m.at for m in chart.marks if m.side == "y"]
    if chart.bars == "x":
        horizontal += bars
    else:
        vertical += bars if chart.y.scale == "linear" else banded
    x = line_around(horizontal, chart.x.scale)
    if chart.y.categories:
        # the first category is on top
        return x, _Reversed(-0.5, len(chart.y.categories) - 0.5)
    if chart.limits is not None:
        return x, Line(*chart.limits, chart.y.scale)
    return x, line_around(vertical, chart.y.scale)


class _Reversed(Line):
    """A linear scale with its low end on top."""

    def place(self, value: float) -> float:
        return 1.0 - super().place(value)


def split_power(text: str) -> tuple[str, str, str] | None:
    """Give ``1e-3`` as ``10``, ``−3`` and what follows; None if it is no such number."""
    mantissa, e, rest = text.partition("e")
    exponent, _, after = rest.partition(" ")
    if not e or not exponent.lstrip("-").isdecimal():
        return None
    base = "10" if mantissa == "1" else f"{mantissa}·10"
    return base, exponent.replace("-", "−"), f" {after}" if after else ""
