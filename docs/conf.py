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
napoleon_use_ivar = True
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
# attributes of one name in several classes
suppress_warnings = ["ref.python"]


def setup(app: Any) -> None:
    """Take the bars of absolute values in docstrings for what they are."""

    def plain_bars(*arguments: Any) -> None:
        lines = arguments[-1]
        lines[:] = [line.replace("|", r"\|") for line in lines]

    app.connect("autodoc-process-docstring", plain_bars)
