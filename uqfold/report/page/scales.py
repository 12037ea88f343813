"""From numbers to places on a chart, and the ticks between."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from uqfold.report.page.chart import Scale

LARGEST = 1e280
"""Numbers beyond have no place on a scale."""
SMALLEST = 1e-280
"""Numbers below have no place on a logarithmic scale."""
_MOST_DECADES = 7
_SUBDIVIDED_DECADES = 2.2
"""A logarithmic axis shorter than this many decades also has ticks at 2 and 5."""


@dataclass(frozen=True)
class Line:
    """A scale between two ends, laid on the line from 0 to 1.

    Attributes
    ----------
    low, high
        Its ends, low < high; both positive where it is logarithmic.
    scale
        ``linear`` or ``log``.
    """

    low: float
    high: float
    scale: Scale = "linear"

    def place(self, value: float) -> float:
        """Give the place of a value; NaN for NaN and for what a logarithm cannot take."""
        if self.scale == "linear":
            return (value - self.low) / (self.high - self.low)
        if not value > 0.0:
            return math.nan
        # differences of logarithms: the ratio of the ends may be no number
        low = math.log(self.low)
        return (math.log(value) - low) / (math.log(self.high) - low)

    def ticks(self, most: int = 6) -> list[float]:
        """Give round values between the ends, about `most` of them."""
        found = self._decades(most) if self.scale == "log" else _round_steps(self, most)
        slack = 1e-9
        return [value for value in found if -slack <= self.place(value) <= 1.0 + slack]

    def _decades(self, most: int) -> list[float]:
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        if math.log10(self.high) - math.log10(self.low) < _SUBDIVIDED_DECADES:
            found = [
                float(f"{digit}e{decade}")
                for decade in range(first, last + 1)
                for digit in (1, 2, 5)
            ]
            inside = [value for value in found if self.low <= value <= self.high]
            return inside if len(inside) > 1 else _round_steps(self, most)
        step = -(-(last - first) // max(most, _MOST_DECADES))
        # counted from 10^0, so that panels with different ends have ticks in common
        start = first + (-first) % step
        return [float(f"1e{decade}") for decade in range(start, last + 1, step)]


def _round_steps(line: Line, most: int) -> list[float]:
    rough = (line.high - line.low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if power * factor >= rough)
    first = math.ceil(line.low / step - 1e-9)
    count = math.floor(line.high / step + 1e-9) - first + 1
    # adding zero turns -0.0 into 0.0
    return [
        round((first + i) * step, 12 - math.floor(math.log10(step))) + 0.0 for i in range(count)
    ]


def line_around(values: Iterable[float], scale: Scale, *, margin: float = 0.05) -> Line:
    """Give the scale that shows all finite values, with some room at the ends.

    Values that the scale cannot show are left out: those beyond `LARGEST`, and on a logarithmic
    scale those below `SMALLEST`. Without any value it goes from 0 to 1, or from 0.1 to 1.
    """
    shown = [v for v in values if abs(v) <= LARGEST and (scale == "linear" or v >= SMALLEST)]
    if not shown:
        return Line(0.1, 1.0, "log") if scale == "log" else Line(0.0, 1.0)
    low, high = min(shown), max(shown)
    if scale == "log":
        room = max(math.exp(margin * (math.log(high) - math.log(low))), 1.15)
        return Line(low / room, high * room, "log")
    size = max(abs(low), abs(high))
    room = margin * (high - low)
    if not room > 1e-9 * size:
        room = 0.05 * size
    # what differs by less than this is drawn on one spot
    return Line(low - max(room, SMALLEST), high + max(room, SMALLEST))


def tick_texts(ticks: Sequence[float], *, percent: bool = False) -> list[str]:
    """Write ticks alike: ``1e-3`` for powers of ten far from one, otherwise plain digits."""
    scaled = [100.0 * tick if percent else tick for tick in ticks]
    sizes = [abs(tick) for tick in scaled if tick != 0.0]
    if sizes and (max(sizes) >= 1e5 or min(sizes) < 1e-4):
        texts = [_power(tick) for tick in scaled]
    else:
        texts = [f"{tick:,.10g}" for tick in scaled]
        if _evenly_spaced(scaled):
            digits = max((len(text.partition(".")[2]) for text in texts), default=0)
            texts = [f"{tick:,.{digits}f}" for tick in scaled]
    return [f"{text} %" if percent else text for text in texts]


def _evenly_spaced(values: Sequence[float]) -> bool:
    steps = [after - before for before, after in pairwise(values)]
    return bool(steps) and max(steps) - min(steps) <= 1e-6 * max(map(abs, steps))


def _power(value: float) -> str:
    if value == 0.0:
        return "0"
    mantissa, _, exponent = f"{value:.6e}".partition("e")
    digits = f"{float(mantissa):g}"
    return f"{digits}e{int(exponent)}"
