from uqfold.problems import catalogue as catalogue
from uqfold.problems.base import Problem as Problem
from uqfold.problems.units import Unit as Unit
from uqfold.problems.four_bar_linkage import four_bar as four_bar
from uqfold.problems.four_branch_system import four_branch as four_branch
from uqfold.problems.reference import Reference as Reference, ReferenceTable as ReferenceTable
from uqfold.problems.series_system import series as series
from uqfold.problems.stress_strength import stress_strength as stress_strength
from uqfold.problems.wing import (
    folding_wing as folding_wing,
    folding_wing_random_lengths as folding_wing_random_lengths,
)
