"""Problems with a name, which the command line can compare methods on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from uqfold.checks import choice, function, keep, text, whole
from uqfold.comparison.own_files import is_of_a_file, of_a_file
from uqfold.problems.catalogue.folder import titles

if TYPE_CHECKING:
    from uqfold.problems.base import Problem

OWN_EVALS = 100_000
"""Budget of each method for a problem of the caller's own."""


@dataclass(frozen=True)
class NamedProblem:
    """A problem with a name, and a budget that suits the cost of its model.

    Attributes
    ----------
    name
        How the command line calls it.
    description
        One line for lists.
    problem
        Builds the problem; called without arguments.
    max_evals
        Budget of each method unless another is given.
    """

    name: str
    description: str
    problem: Callable[[], Problem]
    max_evals: int

    def __post_init__(self) -> None:
        for name in ("name", "description"):
            keep(self, name, text)
        keep(self, "problem", function)
        keep(self, "max_evals", whole, at_least=1)


def available_problems() -> dict[str, NamedProblem]:
    """Return name -> problem with that name: the paper's, then the catalogue's."""
    listed = (
        ("folding-wing", "deployment time of four wings with clearances", 40_000),
        ("folding-wing-random-lengths", "the same with random lengths of crank and rod", 40_000),
        ("series", "series system, nonlinear response: a formula", 2_000_000),
        ("four-bar", "two four-bar linkages on a crank: a formula", 2_000_000),
        ("stress-strength", "redundant units under one stress: a formula", 2_000_000),
    )
    own = {
        name: NamedProblem(name, description, _of_the_package(name), max_evals)
        for name, description, max_evals in listed
    }
    return own | {
        name: NamedProblem(name, title, partial(_of_the_catalogue, name), OWN_EVALS)
        for name, title in titles().items()
    }


def named_problem(name: str) -> NamedProblem:
    """Return the problem of that name, or one of the caller's own.

    Parameters
    ----------
    name
        A name; ``file.py:function`` for a function without arguments that returns a problem (a
        problem itself may also stand there); or ``file.toml``, which states one.

    Raises
    ------
    ValueError
        If there is none (the message lists those that exist), the file fails while it is loaded,
        what it holds by that name cannot be called without arguments, or it states no problem.
    OSError
        If a file cannot be opened.
    """
    if is_of_a_file(name):
        file, _, own = name.rpartition(":")
        build = of_a_file(Path(file), own, "a uqfold.Problem", _is_problem)
        return NamedProblem(f"{Path(file).stem}-{own}", f"{own} of {file}", build, OWN_EVALS)
    if isinstance(name, str) and name.endswith(".toml"):
        from uqfold.comparison.problem_file import problem_of_a_file

        stated = Path(name)
        return NamedProblem(stated.stem, f"stated in {name}", problem_of_a_file(stated), OWN_EVALS)
    problems = available_problems()
    if isinstance(name, str) and name.endswith(".py"):
        raise ValueError(
            f"name = {name!r}: give FILE.py:FUNCTION, as in {name}:problem, where the function "
            "returns a uqfold.Problem"
        )
    return problems[choice("name", name, problems)]


def _is_problem(value: object) -> bool:
    from uqfold.problems.base import Problem

    return isinstance(value, Problem)


def _of_the_catalogue(name: str) -> Problem:
    from uqfold.problems import catalogue

    return catalogue.problem(name)


def _of_the_package(name: str) -> Callable[[], Problem]:
    def build() -> Problem:
        from uqfold import problems

        built: Problem = getattr(problems, name.replace("-", "_"))()
        return built

    return build
