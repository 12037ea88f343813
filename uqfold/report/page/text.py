"""Text on its way into a document."""

from __future__ import annotations

import re

_INVISIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def visible(text: str) -> str:
    """Replace what no document may hold (control characters, halves of surrogate pairs)."""
    return _INVISIBLE.sub("\N{REPLACEMENT CHARACTER}", text)
