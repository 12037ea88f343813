"""The paper's examples that have references of their own."""

from collections.abc import Callable

from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem

EXAMPLES: dict[str, Callable[[], Problem]] = {
    "Example 1": series,
    "Example 2": four_bar,
    "Example 3": folding_wing,
}
