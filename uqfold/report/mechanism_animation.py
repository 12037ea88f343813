"""The deploying wing as an animated SVG picture: one file, no script, plays in any browser.

Animation is that of SVG itself (SMIL), so that the picture also moves where it is shown as an
image. A program that knows no animation shows the pose halfway.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from uqfold.report.mechanism_joints import JOINTS, clearance
from uqfold.report.mechanism_motion import CRANK, ROD, SLIDER
from uqfold.typing import FloatArray

WIDTH, HEIGHT = 760, 430
SCALE = 270.0
"""Points per metre."""
ORIGIN = (40.0, 375.0)
"""Where A is."""
BEARING = 44.0
"""Radius (points) at which a clearance is drawn."""
FRAMES = 400
HOLD = 0.15
"""Share of the time for which the last pose stands still."""


def mechanism_animation(table: Mapping[str, ArrayLike], slowdown: float = 12.0) -> str:
    """Give the motion of one wing as an animated SVG picture.

    The mechanism moves; beside it, each joint is magnified, so that its journal can be seen to
    rattle in the clearance and then to lie against the bearing.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    slowdown
        How many times slower than the real motion it plays.

    Raises
    ------
    ValueError
        If `slowdown` is not positive.
    """
    if not slowdown > 0.0:
        raise ValueError(f"slowdown = {slowdown}: give a positive number")
    film = _film(table, slowdown)
    x_B, y_B = film.column("x_B", ORIGIN[0], SCALE), film.column("y_B", ORIGIN[1], -SCALE)
    x_C, y_C = film.column("x_C", ORIGIN[0], SCALE), film.column("y_C", ORIGIN[1], -SCALE)
    ground = y_C[0] + 9.0
    parts = [
        f'<line x1="8" y1="{ground:g}" x2="480" y2="{ground:g}" stroke="#999999"/>',
        film.line(CRANK, {"x2": x_B, "y2": y_B}, x1=ORIGIN[0], y1=ORIGIN[1]),
        film.line(ROD, {"x1": x_C, "y1": y_C, "x2": x_B, "y2": y_B}),
        film.rectangle(SLIDER, x_C - 11.0, y_C - 9.0),
        f'<circle cx="{ORIGIN[0]:g}" cy="{ORIGIN[1]:g}" r="5"/>',
        _text(ORIGIN[0] - 5.0, ORIGIN[1] - 12.0, "A"),
        *(
            _moving_label(film, joint, x, y)
            for joint, x, y in (("B", x_B + 8.0, y_B - 6.0), ("C", x_C - 5.0, y_C + 26.0))
        ),
    ]
    for k, (joint, name, color) in enumerate(JOINTS):
        parts += _magnified(film, joint, name, color, (640.0, 95.0 + 150.0 * k))
    parts += _clock(film, slowdown)
    body = "\n".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" font-family="DejaVu Sans, Arial, sans-serif" '
        'font-size="13">\n'
        "<title>Deployment of one folding wing</title>\n"
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>\n{body}\n</svg>\n'
    )


@dataclass(frozen=True)
class _Film:
    """The motion at equal steps of time, then standing still.

    Attributes
    ----------
    table
        Columns over the steps of the simulation.
    time
        Times (s) of the frames.
    duration
        How long it plays (s).
    """

    table: Mapping[str, ArrayLike]
    time: FloatArray
    duration: float

    def column(self, name: str, offset: float = 0.0, scale: float = 1.0) -> FloatArray:
        """Give a column at the frames, moved into the picture."""
        values = np.interp(self.time, np.asarray(self.table["time"]), np.asarray(self.table[name]))
        return np.asarray(offset + scale * values)

    def animate(self, attribute: str, values: FloatArray) -> str:
        """Let an attribute follow the values, unless they stand still."""
        if np.ptp(values) < 0.01:
            return ""
        return (
            f'<animate attributeName="{attribute}" dur="{self.duration:.3f}s" '
            f'repeatCount="indefinite" values="{";".join(f"{value:.2f}" for value in values)}"/>'
        )

    def moving(self, tag: str, attributes: Mapping[str, FloatArray], constant: str) -> str:
        """Give an element with moving attributes; the pose halfway is what stands still."""
        middle = len(self.time) // 2
        fixed = " ".join(f'{name}="{values[middle]:.2f}"' for name, values in attributes.items())
        inner = "".join(self.animate(name, values) for name, values in attributes.items())
        return f"<{tag} {fixed} {constant}>{inner}</{tag}>"

    def line(self, color: str, ends: Mapping[str, FloatArray], **fixed: float) -> str:
        constant = " ".join(f'{name}="{value:g}"' for name, value in fixed.items())
        look = f'stroke="{color}" stroke-width="6" stroke-linecap="round" {constant}'
        return self.moving("line", ends, look.strip())

    def rectangle(self, color: str, x: FloatArray, y: FloatArray) -> str:
        return self.moving("rect", {"x": x}, f'y="{y[0]:g}" width="22" height="18" fill="{color}"')


def _film(table: Mapping[str, ArrayLike], slowdown: float) -> _Film:
    end = float(np.asarray(table["time"])[-1])
    frames = np.linspace(0.0, end, FRAMES)
    still = np.full(round(FRAMES * HOLD), end)
    step = slowdown * end / (FRAMES - 1)
    return _Film(table, np.concatenate([frames, still]), step * (FRAMES - 1 + still.size))


def _magnified(
    film: _Film, joint: str, name: str, color: str, centre: Sequence[float]
) -> list[str]:
    """Draw a joint's clearance as a circle, and the journal's centre moving in it."""
    gap = float(clearance(film.table, joint))
    scale = BEARING / gap
    x = film.column(f"e_{joint}_x", centre[0], scale)
    y = film.column(f"e_{joint}_y", centre[1], -scale)
    return [
        f'<circle cx="{centre[0]:g}" cy="{centre[1]:g}" r="{BEARING:g}" fill="#F4F4F4" '
        'stroke="#666666"/>',
        film.moving("circle", {"cx": x, "cy": y}, f'r="6" fill="{color}"'),
        _text(centre[0], centre[1] - BEARING - 12.0, name, anchor="middle"),
        _text(centre[0], centre[1] + BEARING + 18.0, f"clearance {1e3 * gap:.3g} mm", "middle"),
    ]


def _clock(film: _Film, slowdown: float) -> list[str]:
    """Draw a bar that fills as time goes by."""
    x, y, width = 500.0, 375.0, 240.0
    end = float(film.time[-1])
    filled = width * film.time / end
    return [
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="8" fill="#E6E6E6"/>',
        film.moving("rect", {"width": filled}, f'x="{x:g}" y="{y:g}" height="8" fill="#444444"'),
        _text(x, y - 10.0, f"0 to {end:.3f} s, {slowdown:g} times slower"),
    ]


def _moving_label(film: _Film, word: str, x: FloatArray, y: FloatArray) -> str:
    middle = len(film.time) // 2
    inner = film.animate("x", x) + film.animate("y", y)
    return f'<text x="{x[middle]:.2f}" y="{y[middle]:.2f}">{escape(word)}{inner}</text>'


def _text(x: float, y: float, words: str, anchor: str = "start") -> str:
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}">{escape(words)}</text>'
