"""A page as Markdown, and as one HTML file that needs nothing else: no network, no fonts.

Style and script are inline, and a content security policy names both by their hash: nothing else
in the file can style, run or load anything, even if a text should find its way through the
escaping. Templates escape whatever they are given.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from typing import TYPE_CHECKING, Any

from uqfold.report.page import markup
from uqfold.report.page.mathml import mathml
from uqfold.report.page.picture import describe, inline_svg

if TYPE_CHECKING:
    from jinja2 import Environment

_INVISIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


@dataclass
class Section:
    """A heading, the blocks below it, and the sections within it."""

    heading: Mapping[str, Any]
    blocks: list[Mapping[str, Any]] = field(default_factory=list)
    sections: list[Section] = field(default_factory=list)


def html(blocks: Sequence[Mapping[str, Any]], about: Mapping[str, Any]) -> str:
    """Return an HTML document; the same blocks always give the same text.

    Parameters
    ----------
    blocks
        What it shows, from top to bottom.
    about
        Its ``title``, ``lead``, ``kind`` and ``imprint``.
    """
    from markupsafe import Markup

    colors: set[str] = set()
    numbers = count(1)

    def picture(data: Mapping[str, Any]) -> Markup:
        said = ". ".join(part for part in (data["title"], describe(data["figure"])) if part)
        # serialised from a tree, so everything in it is escaped
        return Markup(inline_svg(data["figure"], f"p{next(numbers)}", f"{said}.", colors))

    body = _rendered("body.html.j2", page=about, whole=_tree(blocks), picture=picture)
    style = _rendered("page.css.j2", colors=sorted(colors))
    script = _rendered("page.js")
    return _rendered(
        "page.html.j2",
        page=about,
        # all three are our own: the body comes out of an escaping template
        body=Markup(visible(body)),
        style=Markup(style),
        script=Markup(script),
        style_hash=_hash(style),
        script_hash=_hash(script),
    )


def markdown(blocks: Sequence[Mapping[str, Any]], about: Mapping[str, Any]) -> str:
    """Return the same as Markdown, with anchors where a link leads."""
    linked = ""
    for _ in range(2):
        linked = _rendered("page.md.j2", page=about, blocks=blocks, linked=linked)
    return visible(linked.strip() + "\n")


def visible(text: str) -> str:
    """Replace what no document may hold (control characters, halves of surrogate pairs)."""
    return _INVISIBLE.sub("\N{REPLACEMENT CHARACTER}", text)


def _rendered(template: str, **data: Any) -> str:
    return _templates().get_template(template).render(**data)


@cache
def _templates() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    templates = Environment(
        loader=PackageLoader("uqfold.report.page", "templates"),
        autoescape=lambda name: name != "page.md.j2",
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    of_markdown = (markup.literal, markup.escaped, markup.fenced, markup.unbarred)
    templates.filters |= {one.__name__: one for one in of_markdown}
    templates.filters |= {
        "markdown": lambda text: Markup(markup.html(text)),
        "inline": lambda text: Markup(markup.inline_html(text)),
        "mathml": lambda latex: Markup(mathml(latex) or ""),
        "values": _values,
    }
    return templates


def _tree(blocks: Iterable[Mapping[str, Any]]) -> Section:
    """Put blocks below their headings, and headings below those of lower level."""
    path = [Section({"level": 0})]
    for block in blocks:
        if block["kind"] == "heading":
            while path[-1].heading["level"] >= block["level"]:
                path.pop()
            path[-1].sections.append(Section(block))
            path.append(path[-1].sections[-1])
        else:
            path[-1].blocks.append(block)
    return path[0]


def _values(figure: Any) -> list[tuple[str, list[str]]]:
    """Return whose points are marked in a figure, with their texts in one line each."""
    from uqfold.plots.telling import values

    return [
        (
            ", ".join(part.partition("=")[2] for part in name.split(";")),
            [text.replace("\n", ", ") for text in texts],
        )
        for name, texts in values(figure).items()
    ]


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
