r"""Equations as MathML, typeset by browsers themselves: no script, no fonts, no network.

Reports typeset theirs in the same way. A ``\tag{...}`` at the end becomes the number on the right.
"""

from __future__ import annotations

import re
from html import escape
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

from uqfold.report.page.mathml import mathml

_TAG = re.compile(r"\\tag\{([^{}]*)\}\s*$")


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer under the name ``mathml``."""
    app.add_html_math_renderer("mathml", (_inline, None), (_displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(translator: Any, node: Any) -> None:
    translator.body.append(convert(node.astext(), display="inline"))
    raise nodes.SkipNode


def _displayed(translator: Any, node: Any) -> None:
    latex = node.astext()
    tag = _TAG.search(latex)
    drawn = mathml(_TAG.sub("", latex).strip())
    if drawn is None:
        raise ValueError(f"no MathML can be made of {latex}")
    number = f'<span class="number">{escape(tag[1])}</span>' if tag else ""
    translator.body.append(f'<div class="equation">{drawn}{number}</div>\n')
    raise nodes.SkipNode
