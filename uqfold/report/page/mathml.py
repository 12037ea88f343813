"""LaTeX as MathML, which browsers typeset themselves: no script, no fonts.

LaTeX may come from a record. What the converter makes of it is therefore parsed again, and only
elements and attributes that do nothing but typeset are let through.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import cache

_SPACE = "http://www.w3.org/1998/Math/MathML"
# fmt: off
_ELEMENTS = frozenset({
    "math", "mrow", "mi", "mo", "mn", "ms", "mtext", "mspace", "mfrac", "msqrt", "mroot", "msub",
    "msup", "msubsup", "munder", "mover", "munderover", "mtable", "mtr", "mtd", "mstyle",
    "mpadded", "mphantom",
})
_ATTRIBUTES = frozenset({
    "display", "mathvariant", "stretchy", "fence", "form", "separator", "accent", "accentunder",
    "movablelimits", "largeop", "lspace", "rspace", "width", "height", "depth", "linethickness",
    "displaystyle", "scriptlevel", "minsize", "maxsize", "symmetric", "columnalign", "rowspacing",
    "columnspacing", "linebreak",
})
# fmt: on
_LONGEST = 4000


@cache
def mathml(latex: str) -> str | None:
    """Return a displayed equation as MathML, or None where it cannot be had.

    Parameters
    ----------
    latex
        The equation. Reports show it as it is where the answer is None.
    """
    from latex2mathml.converter import convert

    if len(latex) > _LONGEST:
        return None
    try:
        root = ET.fromstring(convert(latex, display="block"))
        _check(root)
    except Exception:
        # the converter raises whatever its tables and indices raise
        return None
    for element in root.iter():
        element.tag = element.tag.removeprefix(f"{{{_SPACE}}}")
    root.set("xmlns", _SPACE)
    return ET.tostring(root, encoding="unicode")


def _check(root: ET.Element) -> None:
    for element in root.iter():
        tag = element.tag.removeprefix(f"{{{_SPACE}}}")
        if tag not in _ELEMENTS or not _ATTRIBUTES.issuperset(element.attrib):
            raise ValueError(f"{element.tag} {element.attrib} does more than typeset")
