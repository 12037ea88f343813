"""Several methods, one problem, one grid of criteria: run them, keep the records."""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(
    __name__,
    __file__,
    moved={
        "ComparisonPlan": "uqfold.comparison.plan.ComparisonPlan",
        "Case": "uqfold.comparison.NamedProblem",
        "available_cases": "uqfold.comparison.available_problems",
        "records_from_frame": "uqfold.comparison.checked_frame",
        "named_case": "uqfold.comparison.named_problem",
    },
)
