"""The gallery: scripts that are run as the pages are built, shown with their figures.

The directive ``gallery`` names one script of the folder ``gallery``. Its docstring is the title and
the text, its code is shown, its ``figure`` is drawn, and what it prints is shown below. A script
that raises or warns ends the build.
"""

from __future__ import annotations

import ast
import contextlib
import io
import runpy
import warnings
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from uqfold import plots

FIGURES = "gallery/figures"


class Script(SphinxDirective):
    """One script: text, code, figure, output."""

    required_arguments: ClassVar[int] = 1

    def run(self) -> list[nodes.Node]:
        """Run the script and show all of it."""
        name = self.arguments[0]
        path = Path(self.env.srcdir, "gallery", f"{name}.py")
        self.env.note_dependency(str(path))
        source = path.read_text(encoding="utf-8")
        module = ast.parse(source)
        title, _, text = (ast.get_docstring(module) or "").partition("\n\n")
        code = "\n".join(source.splitlines()[module.body[1].lineno - 1 :])
        picture = Path(self.env.srcdir, FIGURES, name)
        printed = drawn(path, picture)
        section = nodes.section(ids=[name], names=[name])
        section += nodes.title(text=title.rstrip("."))
        section += self.parse_text_to_nodes(text)
        section += nodes.image(uri=f"/{FIGURES}/{name}.svg", alt=title, classes=["drawing"])
        section += nodes.literal_block(code, code, language="python")
        if printed:
            section += nodes.literal_block(printed, printed, language="text")
        return [section]


def drawn(script: Path, picture: Path) -> str:
    """Run a script, keep its ``figure`` without a suffix, and return what was printed."""
    said = io.StringIO()
    with warnings.catch_warnings(), contextlib.redirect_stdout(said):
        warnings.simplefilter("error")
        names = runpy.run_path(str(script), run_name="__main__")
    picture.parent.mkdir(exist_ok=True)
    plots.save(names["figure"], picture, formats=("svg",))
    return said.getvalue().rstrip()


def setup(app: Any) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("gallery", Script)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
