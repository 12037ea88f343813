"""Problems with a name, which the command line can compare methods on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, cast

from uqfold.checks import choice, keep, text, whole

if TYPE_CHECKING:
    from uqfold.problems.base import Problem


@dataclass(frozen=True)
class NamedProblem:
    """A problem with a name, and a budget that suits the cost of its model.

    Attributes
    ----------
    name
        How the command line calls it.
    description
        One line for lists.
    factory
        Where the problem is built, as ``module:function``; imported when first needed.
    max_evals
        Budget of each method unless another is given.
    """

    name: str
    description: str
    factory: str
    max_evals: int

    def __post_init__(self) -> None:
        for name in ("name", "description", "factory"):
            keep(self, name, text)
        keep(self, "max_evals", whole, at_least=1)

    def function(self) -> Callable[..., Problem]:
        """Return the function that builds the problem, and takes its options."""
        module, _, function = self.factory.partition(":")
        return cast("Callable[..., Problem]", getattr(import_module(module), function))

    def problem(self) -> Problem:
        """Build the problem."""
        return self.function()()


_PROBLEMS = (
    NamedProblem(
        "folding-wing",
        "four folding wings: deployment time of a mechanism with joint clearances",
        "uqfold.problems:folding_wing",
        max_evals=40_000,
    ),
    NamedProblem(
        "folding-wing-random-lengths",
        "the same with random lengths of crank and rod",
        "uqfold.problems:folding_wing_random_lengths",
        max_evals=40_000,
    ),
    NamedProblem(
        "series",
        "series system with a nonlinear response: a formula",
        "uqfold.problems:series",
        max_evals=2_000_000,
    ),
    NamedProblem(
        "four-bar",
        "two four-bar linkages on one crank: rocker angle, a formula",
        "uqfold.problems:four_bar",
        max_evals=2_000_000,
    ),
)


def available_problems() -> dict[str, NamedProblem]:
    """Return name -> problem with that name."""
    return {one.name: one for one in _PROBLEMS}


def named_problem(name: str) -> NamedProblem:
    """Return the problem of that name.

    Raises
    ------
    ValueError
        If there is none; the message lists those that exist.
    """
    problems = available_problems()
    return problems[choice("name", name, problems)]
