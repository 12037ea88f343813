"""Colours that can be told from light and from dark paper."""

from __future__ import annotations

from colorsys import hls_to_rgb, rgb_to_hls

LIGHT_PAPER, DARK_PAPER = "#ffffff", "#14171a"
LEAST_CONTRAST = 3.2
"""Contrast of lines and markers with the paper; WCAG 2.2 asks for 3."""

_STEPS = 50
_PALE = 1.6
"""Contrast with light paper below which a colour is one of areas and grids."""
_CALM = 0.7
_DARKEST, _LIGHTEST = 0.1, 0.92
"""Lightness on dark paper of what is white and black on light paper."""


def readable(color: str, paper: str) -> str:
    """Return a colour, darkened or lightened until its contrast with the paper is large enough."""
    own, ground = _channels(color), _channels(paper)
    end = 0.0 if paper == LIGHT_PAPER else 1.0
    shares = (step / _STEPS for step in range(_STEPS + 1))
    mixtures = (tuple((1.0 - share) * one + share * end for one in own) for share in shares)
    return _written(next(one for one in mixtures if contrast(one, ground) >= LEAST_CONTRAST))


def by_day(color: str) -> str:
    """Return a colour of a figure as it is drawn on light paper: pale ones stay pale."""
    if contrast(_channels(color), _channels(LIGHT_PAPER)) < _PALE:
        return color
    return readable(color, LIGHT_PAPER)


def by_night(color: str) -> str:
    """Return a colour of a figure as it is drawn on dark paper: dark and light change places."""
    if color == "#ffffff":
        return DARK_PAPER
    hue, lightness, saturation = rgb_to_hls(*_channels(color))
    turned = _DARKEST + (_LIGHTEST - _DARKEST) * (1.0 - lightness)
    pale = contrast(_channels(color), _channels(LIGHT_PAPER)) < _PALE
    if not pale:
        # what is light already stays so, and full colours would glow
        turned, saturation = max(turned, lightness), _CALM * saturation
    night = _written(hls_to_rgb(hue, turned, saturation))
    return night if pale else readable(night, DARK_PAPER)


def contrast(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """Contrast ratio of two colours, channels from 0 to 1 (WCAG 2.2)."""
    darker, lighter = sorted((_luminance(one), _luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def _written(channels: tuple[float, ...]) -> str:
    return "#" + "".join(f"{round(255.0 * value):02x}" for value in channels)


def _channels(color: str) -> tuple[float, ...]:
    return tuple(int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5))


def _luminance(channels: tuple[float, ...]) -> float:
    red, green, blue = (
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
        for value in channels
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
