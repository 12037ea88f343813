"""LaTeX as MathML, which browsers typeset themselves: no script, no fonts.

LaTeX may come from a record. What the converter makes of it is therefore parsed again, and let
through only if its elements are those of MathML and no attribute refers, runs or styles.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from functools import cache

_SPACE = "http://www.w3.org/1998/Math/MathML"
_LONGEST = 4000
# a name such as "mfrac"; "maction" is switched by clicks
_ELEMENT = re.compile(re.escape(f"{{{_SPACE}}}") + r"m(?!action)[a-z]+")
_FORBIDDEN = re.compile(r"on.*|.*href|src|style|class|id|.*:.*|\{.*")


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
    except Exception:
        # the converter raises whatever its tables and indices raise
        return None
    for element in root.iter():
        if not _ELEMENT.fullmatch(element.tag) or any(map(_FORBIDDEN.fullmatch, element.attrib)):
            return None
    for element in root.iter():
        element.tag = element.tag.removeprefix(f"{{{_SPACE}}}")
    root.set("xmlns", _SPACE)
    return ET.tostring(root, encoding="unicode")
