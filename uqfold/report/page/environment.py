"""The templates of pages, read so that they escape whatever they are given."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from uqfold.report.page.text import visible

if TYPE_CHECKING:
    from jinja2 import Environment, Template


def template(name: str) -> Template:
    """Give one of the files in ``templates``."""
    return _environment().get_template(name)


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    def finalized(value: Any) -> Any:
        # what is written already is a Markup, which is no plain str
        return visible(value) if type(value) is str else value

    return Environment(
        loader=PackageLoader("uqfold.report.page", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=finalized,
    )
