"""Pages of methods: what is written in the code is not written again.

A page ``methods/<name>.md`` says in its own words when to take the method, when not, and what it
costs. As it is read, the idea goes below its title, and equations, settings and references to its
end: from the theory note of the method and from the docstring of its class.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from functools import cache
from pathlib import Path
from typing import Any

from uqfold.methods import available
from uqfold.methods.registry import built_in
from uqfold.methods.theory import Theory
from uqfold.report.methods_section import DEFINITION

FOLDER = "methods/"
OF_THE_SYSTEM = "<!-- equations of the system -->"
WANTED = ("## When", "## When not", "## Cost")


def setup(app: Any) -> dict[str, bool]:
    """Fill pages as they are read."""
    app.connect("source-read", _fill)
    app.connect("builder-inited", _every_method_has_a_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _every_method_has_a_page(app: Any) -> None:
    pages = {page.stem for page in Path(app.srcdir, FOLDER).glob("*.md")} - {"index"}
    if pages != set(built_in()):
        raise ValueError(f"pages without a method, or the reverse: {pages ^ set(built_in())}")


def _fill(app: Any, docname: str, source: list[str]) -> None:
    name = docname.removeprefix(FOLDER)
    if docname.startswith(FOLDER) and name != "index":
        source[0] = filled(name, source[0])
    system = "\n\n".join(equation(lead, latex, number) for latex, lead, number in DEFINITION)
    source[0] = source[0].replace(OF_THE_SYSTEM, system)


def filled(name: str, page: str) -> str:
    """Return the page of a method with its idea, equations, settings and references."""
    missing = [heading for heading in WANTED if f"\n{heading}\n" not in page]
    if missing:
        raise ValueError(f"methods/{name}.md lacks {missing}")
    method = available()[name]
    theory = Theory.of(method)
    title, _, said = page.partition("\n")
    parts = [title, literal(theory.summary), said.strip()]
    if theory.equations:
        parts.append("## Equations")
        parts += [equation(one.lead, one.latex, one.source) for one in theory.equations]
    parts += ["## Settings", settings(method)]
    if theory.references:
        parts += ["## References", "\n".join(f"- {literal(one)}" for one in theory.references)]
    return "\n\n".join(parts) + "\n"


def equation(lead: str, latex: str, source: str) -> str:
    """Return one displayed equation, numbered as its source numbers it."""
    tag = rf" \tag{{{source}}}" if source else ""
    return f"{literal(lead)}\n\n```{{math}}\n{latex}{tag}\n```"


def settings(method: type) -> str:
    """Return the settings of a method as a table: default and meaning."""
    said = attributes(inspect.cleandoc(method.__doc__ or ""))
    rows = ["| setting | default | meaning |", "| --- | --- | --- |"]
    for field in dataclasses.fields(method):
        value: Any = field.default
        if field.default_factory is not dataclasses.MISSING:
            value = field.default_factory()
        rows.append(f"| `{field.name}` | `{value!r}` | {said[field.name]} |")
    name = f"{method.__module__.split('.')[0]}.methods.{method.__name__}"
    return f"The fields of `{name}(...)`:\n\n" + "\n".join(rows)


@cache
def attributes(docstring: str) -> dict[str, str]:
    """Map each attribute of a numpydoc docstring to what is said of it, in one line of Markdown."""
    section = re.search(r"Attributes\n-+\n(.*?)(?=\n\n\w+\n-+\n|\Z)", docstring, re.DOTALL)
    assert section is not None
    found: dict[str, str] = {}
    for names, said in re.findall(r"^(\w[\w, ]*)\n((?:    .*\n?|\n)+)", section[1], re.MULTILINE):
        text = " ".join(said.split()).replace("``", "`")
        found |= dict.fromkeys((one.strip() for one in names.split(",")), text.replace("|", r"\|"))
    return found


def literal(text: str) -> str:
    """Return text of which Markdown takes nothing for markup."""
    return re.sub(r"([\\`*_\[\]<>|$])", r"\\\1", text)
