"""Problems: what may fail. The paper's examples, and the record to state others."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.problems.base import Problem, Unit
    from uqfold.problems.four_bar_linkage import four_bar
    from uqfold.problems.four_branch_system import four_branch
    from uqfold.problems.reference import Reference, ReferenceTable
    from uqfold.problems.series_system import series
    from uqfold.problems.wing import folding_wing, folding_wing_random_lengths

__all__ = [
    "Problem",
    "Reference",
    "ReferenceTable",
    "Unit",
    "folding_wing",
    "folding_wing_random_lengths",
    "four_bar",
    "four_branch",
    "series",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Problem": "uqfold.problems.base",
        "Reference": "uqfold.problems.reference",
        "ReferenceTable": "uqfold.problems.reference",
        "Unit": "uqfold.problems.base",
        "folding_wing": "uqfold.problems.wing",
        "folding_wing_random_lengths": "uqfold.problems.wing",
        "four_bar": "uqfold.problems.four_bar_linkage",
        "four_branch": "uqfold.problems.four_branch_system",
        "series": "uqfold.problems.series_system",
    },
)
