"""Pages: a report as data, written as one HTML file or as Markdown.

A page is built from blocks (`uqfold.report.page.blocks`) and charts (`uqfold.report.page.chart`).
All text in them is text: nothing that it holds can become markup or code of the report.
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.report.page.blocks import Page
    from uqfold.report.page.html import page_html
    from uqfold.report.page.markdown import page_markdown
    from uqfold.report.page.write import write_page

__all__ = ["Page", "page_html", "page_markdown", "write_page"]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Page": "uqfold.report.page.blocks",
        "page_html": "uqfold.report.page.html",
        "page_markdown": "uqfold.report.page.markdown",
        "write_page": "uqfold.report.page.write",
    },
)
