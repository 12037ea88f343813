"""Colours that can be told from light and from dark paper."""

from __future__ import annotations

import re

LIGHT_PAPER, DARK_PAPER = "#ffffff", "#14171a"
LEAST_CONTRAST = 3.2
"""Contrast of lines and markers with the paper; WCAG 2.2 asks for 3."""

_HEXADECIMAL = re.compile(r"#[0-9a-fA-F]{6}")
_STEPS = 50


def readable(color: str, paper: str) -> str:
    """Give a colour, darkened or lightened until its contrast with the paper is large enough.

    Raises
    ------
    ValueError
        If a colour is not written as six hexadecimal digits.
    """
    own, ground = _channels(color), _channels(paper)
    end = 0.0 if _luminance(ground) > 0.4 else 1.0
    for step in range(_STEPS + 1):
        share = step / _STEPS
        mixed = tuple((1.0 - share) * value + share * end for value in own)
        if contrast(mixed, ground) >= LEAST_CONTRAST:
            break
    return "#" + "".join(f"{round(255.0 * value):02x}" for value in mixed)


def contrast(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """Contrast ratio of two colours, channels from 0 to 1 (WCAG 2.2)."""
    darker, lighter = sorted((_luminance(one), _luminance(other)))
    return (lighter + 0.05) / (darker + 0.05)


def _channels(color: str) -> tuple[float, ...]:
    if not _HEXADECIMAL.fullmatch(color):
        raise ValueError(f"{color!r} is no colour: give six hexadecimal digits after #")
    return tuple(int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5))


def _luminance(channels: tuple[float, ...]) -> float:
    red, green, blue = (
        value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
        for value in channels
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
