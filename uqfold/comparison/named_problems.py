"""Problems with a name, which the command line can compare methods on."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from uqfold.checks import choice, keep, text, whole

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
    factory
        Where the problem is built, as ``module:function`` or ``file.py:function``; imported when
        first needed.
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

    def problem(self) -> Problem:
        """Build the problem."""
        module, _, function = self.factory.rpartition(":")
        loaded = _loaded_file(Path(module)) if module.endswith(".py") else import_module(module)
        built: Problem = getattr(loaded, function)()
        return built


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
    """Return the problem of that name, or one of the caller's own.

    Parameters
    ----------
    name
        A name, or ``file.py:function`` for a function without arguments that returns a problem.

    Raises
    ------
    ValueError
        If there is none; the message lists those that exist.
    """
    if isinstance(name, str) and ".py:" in name:
        file, _, function = name.rpartition(":")
        if not Path(file).is_file():
            raise ValueError(f"name = {name!r}: there is no file {file}")
        own = NamedProblem(function or "problem", f"{function} of {file}", name, OWN_EVALS)
        if not hasattr(_loaded_file(Path(file)), own.name):
            raise ValueError(f"name = {name!r}: {file} has no function {own.name!r}")
        return own
    problems = available_problems()
    return problems[choice("name", name, problems)]


@cache
def _loaded_file(file: Path) -> ModuleType:
    """Return the module in a file, which stays importable by its name for other processes."""
    spec = spec_from_file_location(file.stem, file)
    if spec is None or spec.loader is None:
        raise ValueError(f"{file} is not a Python file")
    module = module_from_spec(spec)
    sys.modules.setdefault(file.stem, module)
    spec.loader.exec_module(module)
    return module
