"""Outlines of markers, after matplotlib's letters."""

from __future__ import annotations

import math
from collections.abc import Sequence

Corner = tuple[float, float]


def _regular(corners: int, turn: float = 0.0) -> tuple[Corner, ...]:
    angles = [turn - math.pi / 2.0 + 2.0 * math.pi * i / corners for i in range(corners)]
    return tuple((math.cos(angle), math.sin(angle)) for angle in angles)


def _turned(outline: Sequence[Corner], angle: float) -> tuple[Corner, ...]:
    c, s = math.cos(angle), math.sin(angle)
    return tuple((c * x - s * y, s * x + c * y) for x, y in outline)


_TRIANGLE = ((0.0, -1.05), (1.05, 0.85), (-1.05, 0.85))
_PLUS = (
    (-0.38, -1.05), (0.38, -1.05), (0.38, -0.38), (1.05, -0.38), (1.05, 0.38), (0.38, 0.38),
    (0.38, 1.05), (-0.38, 1.05), (-0.38, 0.38), (-1.05, 0.38), (-1.05, -0.38), (-0.38, -0.38),
)  # fmt: skip
_STAR = tuple(
    (reach * x, reach * y)
    for i, (x, y) in enumerate(_regular(10))
    for reach in (1.2 if i % 2 == 0 else 0.5,)
)
_OUTLINES: dict[str, tuple[Corner, ...]] = {
    "s": ((-0.88, -0.88), (0.88, -0.88), (0.88, 0.88), (-0.88, 0.88)),
    "D": ((0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)),
    "^": _TRIANGLE,
    "v": _turned(_TRIANGLE, math.pi),
    "<": _turned(_TRIANGLE, -math.pi / 2.0),
    ">": _turned(_TRIANGLE, math.pi / 2.0),
    "P": _PLUS,
    "X": _turned(_PLUS, math.pi / 4.0),
    "d": ((0.0, -1.2), (0.75, 0.0), (0.0, 1.2), (-0.75, 0.0)),
    "*": _STAR,
    "p": _regular(5),
    "h": _regular(6),
    "H": _regular(6, math.pi / 6.0),
    "8": _regular(8, math.pi / 8.0),
}


def marker_path(marker: str, x: float, y: float, size: float) -> str:
    """Give the outline of a marker as the data of an SVG path.

    Parameters
    ----------
    marker
        A letter of matplotlib; one that is not known gives a circle.
    x, y
        Its centre.
    size
        Its diameter.
    """
    r = size / 2.0
    outline = _OUTLINES.get(marker)
    if outline is None:
        return f"M{x - r:.2f} {y:.2f}a{r:.2f} {r:.2f} 0 1 0 {size:.2f} 0" + (
            f"a{r:.2f} {r:.2f} 0 1 0 {-size:.2f} 0z"
        )
    return "M" + "L".join(f"{x + r * px:.2f} {y + r * py:.2f}" for px, py in outline) + "z"
