"""Pages, tables on a terminal and progress: how results are told; nothing here runs a model."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.report.cost import error_against_evaluations
    from uqfold.report.curves import reliability_curves
    from uqfold.report.figures import write_figures
    from uqfold.report.page.builder import Page
    from uqfold.report.page.markup import literal
    from uqfold.report.reports import report_page, write_report
    from uqfold.report.table import ComparisonTable

__all__ = [
    "ComparisonTable",
    "Page",
    "error_against_evaluations",
    "literal",
    "reliability_curves",
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
        "error_against_evaluations": "uqfold.report.cost",
        "literal": "uqfold.report.page.markup",
        "reliability_curves": "uqfold.report.curves",
        "report_page": "uqfold.report.reports",
        "write_figures": "uqfold.report.figures",
        "write_report": "uqfold.report.reports",
    },
)
