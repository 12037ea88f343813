"""Pages, tables on a terminal and progress: how results are told; nothing here runs a model."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.report.figures import write_figures
    from uqfold.report.page.builder import Page
    from uqfold.report.page.markup import literal
    from uqfold.report.reports import report_page, write_report
    from uqfold.report.table import ComparisonTable

__all__ = [
    "ComparisonTable",
    "Page",
    "literal",
    "report_page",
    "write_figures",
    "write_report",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "ComparisonTable": "uqfold.report.table",
        "Page": "uqfold.report.page.builder",
        "literal": "uqfold.report.page.markup",
        "report_page": "uqfold.report.reports",
        "write_figures": "uqfold.report.figures",
        "write_report": "uqfold.report.reports",
    },
)
