"""Where to cut the axis so that a Pearson density is a short Chebyshev sum on every panel."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.moments.pearson_types import PearsonEquation, SupportEnd
from uqfold.typing import FloatArray

# ln f may change by this much across a panel in the body and in the far tail (Chebyshev sums of
# 20 terms hold 1e-14 and 1e-12 then), and panels stop where f is below exp(-DEPTH) of its peak.
_BODY_CHANGE, _TAIL_CHANGE, _BODY_DEPTH = 4.0, 8.0, 40.0
DEPTH = 720.0
_MOST_PANELS = 4000


@dataclass(frozen=True)
class Side:
    """Panels from the mean outwards on one side.

    Attributes
    ----------
    edges
        Increasing distances |z| of the panel edges, the first one 0; (P + 1,).
    end
        Width of the strip next to a finite end that is left to its power series; 0 if the panels
        run until the density is negligible.
    """

    edges: FloatArray
    strip: float


def strip_width(end: SupportEnd, d: float) -> float:
    """Width on which the power series at a finite end converges to rounding in 30 terms."""
    width = abs(end.position)
    if d != 0.0:
        width = min(width, 0.2 * end.slope / abs(d))
    if end.regular != 0.0:
        width = min(width, 0.5 * end.slope / abs(end.regular))
    return width


def march(equation: PearsonEquation, direction: int) -> Side:
    """Panel edges from z = 0 towards `direction` (+1 or -1).

    A panel keeps three half-widths away from each pole of f'/f, and bounds the change of ln f.
    """
    a, b, c, d = equation.a, equation.b, equation.c, equation.d
    lower, upper = equation.ends
    ahead, behind = (upper, lower) if direction > 0 else (lower, upper)
    strip = 0.0 if ahead is None else strip_width(ahead, d)
    limit = math.inf if ahead is None else abs(ahead.position)
    back = math.inf if behind is None else abs(behind.position)
    pole = equation.complex_root if lower is None and d > 0 else None

    def slope(distance: float) -> float:
        """Slope of ln f outwards, from the same factors as `PearsonEquation.denominator`."""
        z = direction * distance
        if upper is not None:
            denominator = -d * (limit - distance) * (back + distance)
        elif lower is not None:
            x = (limit - distance) if direction < 0 else (back + distance)
            denominator = x * (lower.slope + d * x)
        elif pole is not None:
            denominator = d * ((z - pole[0]) ** 2 + pole[1] ** 2)
        else:
            denominator = c
        return -direction * (a * z + b) / denominator

    def widest(distance: float) -> float:
        """Half-width allowed by the poles."""
        half = min((limit - distance) / 4.0, (back + distance) / 2.0)
        if pole is not None:
            offset = direction * distance - pole[0]
            radius = math.hypot(offset, pole[1])
            half = min(half, radius / 4.0 if direction * offset < 0 else radius / 2.9)
        return half

    edges = [0.0]
    distance, log_density, peak = 0.0, 0.0, 0.0
    here = slope(0.0)
    while limit - distance > strip and len(edges) < _MOST_PANELS:
        allowed = _BODY_CHANGE if peak - log_density < _BODY_DEPTH else _TAIL_CHANGE
        half = min(widest(distance), max(1.0, distance))
        if here != 0.0:
            half = min(half, 0.5 * allowed / abs(here))
        while True:
            there = slope(distance + 2.0 * half)
            if 2.0 * half * abs(there) <= 1.25 * allowed:
                break
            half *= 0.7
        if limit - distance - 2.0 * half < strip:
            half = 0.5 * (limit - strip - distance)
            there = slope(distance + 2.0 * half)
        middle = slope(distance + half)
        log_density += half * (here + 4.0 * middle + there) / 3.0
        peak = max(peak, log_density)
        distance += 2.0 * half
        edges.append(distance)
        here = there
        if peak - log_density > DEPTH and here < 0:
            return Side(np.array(edges), 0.0)
        if limit - distance <= strip * (1.0 + 1e-12):
            break
    return Side(np.array(edges), strip)
