"""Declarative studies: a file that says what to compare, and the results that it leads to."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.comparison.studies.document import StudyError
    from uqfold.comparison.studies.loading import load_study
    from uqfold.comparison.studies.results import (
        ResultsError,
        read_record,
        read_tables,
        results_state,
    )
    from uqfold.comparison.studies.runner import StudyRunner
    from uqfold.comparison.studies.study import Study

__all__ = [
    "ResultsError",
    "Study",
    "StudyError",
    "StudyRunner",
    "load_study",
    "read_record",
    "read_tables",
    "results_state",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "ResultsError": "uqfold.comparison.studies.results",
        "Study": "uqfold.comparison.studies.study",
        "StudyError": "uqfold.comparison.studies.document",
        "StudyRunner": "uqfold.comparison.studies.runner",
        "load_study": "uqfold.comparison.studies.loading",
        "read_record": "uqfold.comparison.studies.results",
        "read_tables": "uqfold.comparison.studies.results",
        "results_state": "uqfold.comparison.studies.results",
    },
)
