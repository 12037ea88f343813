"""Several methods, one problem, one grid of criteria: run them, keep the records."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.comparison.benchmark import benchmark_summary
    from uqfold.comparison.entries import Records, records_from_frame
    from uqfold.comparison.frames import checked_frame, comparison_header
    from uqfold.comparison.header import criteria_of
    from uqfold.comparison.named_problems import NamedProblem, available_problems, named_problem
    from uqfold.comparison.plan import ComparisonPlan, plan_comparison
    from uqfold.comparison.records import RecordsError, read_records, write_records
    from uqfold.comparison.run import compare, run_comparison

__all__ = [
    "ComparisonPlan",
    "NamedProblem",
    "Records",
    "RecordsError",
    "available_problems",
    "benchmark_summary",
    "checked_frame",
    "compare",
    "comparison_header",
    "criteria_of",
    "named_problem",
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
        "ComparisonPlan": "uqfold.comparison.plan",
        "NamedProblem": "uqfold.comparison.named_problems",
        "Records": "uqfold.comparison.entries",
        "records_from_frame": "uqfold.comparison.entries",
        "RecordsError": "uqfold.comparison.records",
        "available_problems": "uqfold.comparison.named_problems",
        "benchmark_summary": "uqfold.comparison.benchmark",
        "checked_frame": "uqfold.comparison.frames",
        "compare": "uqfold.comparison.run",
        "comparison_header": "uqfold.comparison.frames",
        "criteria_of": "uqfold.comparison.header",
        "named_problem": "uqfold.comparison.named_problems",
        "plan_comparison": "uqfold.comparison.plan",
        "read_records": "uqfold.comparison.records",
        "run_comparison": "uqfold.comparison.run",
        "write_records": "uqfold.comparison.records",
    },
)
