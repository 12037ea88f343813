"""Text on its way into a document."""

from __future__ import annotations

import re

_INVISIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
_MINUS = re.compile(r"(?<!\w)-(?=\d)")
_POWER = re.compile(r"(?<![\w.])(-?\d+(?:\.\d+)?)e(-?\d+)(?!\w)")


def visible(text: str) -> str:
    """Replace what no document may hold (control characters, halves of surrogate pairs)."""
    return _INVISIBLE.sub("\N{REPLACEMENT CHARACTER}", text)


def split_powers(text: str) -> list[tuple[str, str]]:
    """Cut a text at its numbers like ``1.5e-4``: pieces of text, each with the exponent behind it.

    Examples
    --------
    >>> split_powers("1.5e-4 .. 2")
    [('1.5 × 10', '−4'), (' .. 2', '')]
    """
    pieces, start = [], 0
    for match in _POWER.finditer(text):
        mantissa, exponent = match[1], f"{int(match[2])}".replace("-", "−")
        before = text[start : match.start()]
        pieces.append((_MINUS.sub("−", f"{before}{mantissa} × 10"), exponent))
        start = match.end()
    if start < len(text) or not pieces:
        pieces.append((_MINUS.sub("−", text[start:]), ""))
    return pieces
