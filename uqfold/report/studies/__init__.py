"""What a study shows: figures and tables drawn from its results, and its report. Runs no model."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.report.studies.exhibits import write_exhibits
    from uqfold.report.studies.page import write_page
    from uqfold.report.studies.registry import figure_kinds, table_kinds

__all__ = ["figure_kinds", "table_kinds", "write_exhibits", "write_page"]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "figure_kinds": "uqfold.report.studies.registry",
        "table_kinds": "uqfold.report.studies.registry",
        "write_exhibits": "uqfold.report.studies.exhibits",
        "write_page": "uqfold.report.studies.page",
    },
)
