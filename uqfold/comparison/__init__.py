"""Several methods, one problem, one grid of criteria: run them, keep the records."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.comparison.cases import Case, available_cases, named_case
    from uqfold.comparison.frames import records_from_frame
    from uqfold.comparison.header import RunHeader
    from uqfold.comparison.records import Records, RecordsError, read_records, write_records
    from uqfold.comparison.run import (
        ComparisonPlan,
        MethodRun,
        compare,
        plan_comparison,
        run_comparison,
    )

__all__ = [
    "Case",
    "ComparisonPlan",
    "MethodRun",
    "Records",
    "RecordsError",
    "RunHeader",
    "available_cases",
    "compare",
    "named_case",
    "plan_comparison",
    "read_records",
    "records_from_frame",
    "run_comparison",
    "write_records",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Case": "uqfold.comparison.cases",
        "ComparisonPlan": "uqfold.comparison.run",
        "MethodRun": "uqfold.comparison.run",
        "Records": "uqfold.comparison.records",
        "RecordsError": "uqfold.comparison.records",
        "RunHeader": "uqfold.comparison.header",
        "available_cases": "uqfold.comparison.cases",
        "compare": "uqfold.comparison.run",
        "named_case": "uqfold.comparison.cases",
        "plan_comparison": "uqfold.comparison.run",
        "read_records": "uqfold.comparison.records",
        "records_from_frame": "uqfold.comparison.frames",
        "run_comparison": "uqfold.comparison.run",
        "write_records": "uqfold.comparison.records",
    },
)
