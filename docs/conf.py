"""Sphinx configuration: `pip install -e '.[docs]' && sphinx-build -W docs docs/_build`."""

from typing import Any

project = "uqfold"
author = "The uqfold developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
exclude_patterns = ["_build"]
myst_heading_anchors = 3
napoleon_use_ivar = True
autodoc_typehints = "description"
# links to reports and records outside this folder; attributes of one name in several classes
suppress_warnings = ["myst.xref_missing", "ref.python"]


def setup(app: Any) -> None:
    """Take the bars of absolute values in docstrings for what they are."""

    def plain_bars(*arguments: Any) -> None:
        lines = arguments[-1]
        lines[:] = [line.replace("|", r"\|") for line in lines]

    app.connect("autodoc-process-docstring", plain_bars)
