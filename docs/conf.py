"""Sphinx configuration: `pip install -e '.[docs]' && sphinx-build -W docs docs/_build`."""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "uqfold"
author = "The uqfold developers"
extensions = [
    "myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon",
    "typesetting", "method_pages", "gallery", "reports_made",
]  # fmt: skip
html_theme = "furo"
html_title = "uqfold"
html_show_copyright = False
html_static_path = ["site"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
exclude_patterns = ["_build", "gallery/figures"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
napoleon_google_docstring = False
napoleon_use_ivar = True
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
# attributes of one name in several classes
suppress_warnings = ["ref.python"]


def setup(app: Any) -> None:
    """Show docstrings as they are meant."""

    def meant(_app: Any, what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
        # bars are those of absolute values
        lines[:] = [line.replace("|", r"\|") for line in lines]
        # napoleon takes what stands before a colon in the first line for a type
        if what in ("attribute", "data", "property"):
            lines[:0] = ["..", ""]  # an empty comment

    app.connect("autodoc-process-docstring", meant, priority=400)
