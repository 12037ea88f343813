"""Problems with a name, which the command line can compare methods on."""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

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
        """Build the problem.

        Raises
        ------
        ValueError
            If a file of the caller's own fails, or does not return a problem.
        """
        module, _, function = self.factory.rpartition(":")
        if module.endswith(".py"):
            return _built(Path(module), function)
        built: Problem = getattr(import_module(module), function)()
        return built


_PROBLEMS = (
    NamedProblem(
        "folding-wing",
        "deployment time of four wings with clearances",
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
        "series system, nonlinear response: a formula",
        "uqfold.problems:series",
        max_evals=2_000_000,
    ),
    NamedProblem(
        "four-bar",
        "two four-bar linkages on a crank: a formula",
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
        If there is none (the message lists those that exist), the file fails while it is loaded,
        or what it holds by that name cannot be called without arguments.
    """
    if isinstance(name, str) and ".py:" in name:
        file, _, function = name.rpartition(":")
        if not Path(file).is_file():
            raise ValueError(f"name = {name!r}: there is no file {file}")
        _factory_in(Path(file), function)
        own = f"{Path(file).stem}-{function}"
        return NamedProblem(own, f"{function} of {file}", name, OWN_EVALS)
    problems = available_problems()
    if isinstance(name, str) and name.endswith(".py"):
        raise ValueError(
            f"name = {name!r}: give FILE.py:FUNCTION, as in {name}:problem, where the function "
            "returns a uqfold.Problem"
        )
    return problems[choice("name", name, problems)]


def _factory_in(file: Path, function: str) -> Callable[[], Any]:
    """Return the function of that name in a file."""
    loaded = _loaded_file(file.resolve())
    if not hasattr(loaded, function):
        raise ValueError(f"name = '{file}:{function}': {file} has no function {function!r}")
    factory = getattr(loaded, function)
    if not callable(factory):
        raise _no_factory(file, function, f"it is of type {type(factory).__name__}")
    try:
        inspect.signature(factory).bind()
    except TypeError as error:
        raise _no_factory(file, function, str(error)) from None
    except ValueError:  # a function that does not tell its arguments
        pass
    return factory  # type: ignore[no-any-return]


def _built(file: Path, function: str) -> Problem:
    """Return the problem that a function in a file builds."""
    from uqfold.problems.base import Problem

    factory = _factory_in(file, function)
    with _told_by_line(file):
        built = factory()
    if not isinstance(built, Problem):
        raise _no_factory(file, function, f"it returns {type(built).__name__}")
    return built


def _no_factory(file: Path, function: str, why: str) -> ValueError:
    return ValueError(
        f"{file}: {function} must be a function without arguments that returns a uqfold.Problem, "
        f"but {why}"
    )


@cache
def _loaded_file(file: Path) -> ModuleType:
    """Return the module in a file, which stays importable by its name for other processes.

    As when Python runs the file, its folder comes first where modules are looked for, and stays
    there: a model may import a neighbour late, or in another process.
    """
    spec = spec_from_file_location(file.stem, file)
    if spec is None or spec.loader is None:
        raise ValueError(f"{file} is not a Python file")
    module = module_from_spec(spec)
    folder = str(file.parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    registered = sys.modules.setdefault(file.stem, module)
    try:
        with _told_by_line(file):
            spec.loader.exec_module(module)
    except BaseException:
        if registered is module:
            del sys.modules[file.stem]
        raise
    return module


@contextmanager
def _told_by_line(file: Path) -> Iterator[None]:
    """Turn whatever the code in a file raises into one line with the place in the file."""
    try:
        yield
    except (Exception, SystemExit) as error:
        place = file.name
        lines = [
            frame.lineno
            for frame in traceback.extract_tb(error.__traceback__)
            if Path(frame.filename).resolve() == file.resolve()
        ]
        if isinstance(error, SyntaxError) and error.filename is not None:
            place, lines = Path(error.filename).name, [error.lineno]
        if lines:
            place += f", line {lines[-1]}"
        said = " ".join(str(error).split())
        raise ValueError(f"{place}: {type(error).__name__}: {said}") from error
