"""Problems with a name, which the command line can compare methods on."""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeGuard

from uqfold.checks import choice, function, keep, text, whole
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
        A name, or ``file.py:function`` for a function without arguments that returns a problem;
        a problem itself may also stand there.

    Raises
    ------
    ValueError
        If there is none (the message lists those that exist), the file fails while it is loaded,
        or what it holds by that name cannot be called without arguments.
    """
    if is_of_a_file(name):
        file, _, own = name.rpartition(":")
        build = _of_a_file(Path(file), own, "a uqfold.Problem", _is_problem)
        return NamedProblem(f"{Path(file).stem}-{own}", f"{own} of {file}", build, OWN_EVALS)
    problems = available_problems()
    if isinstance(name, str) and name.endswith(".py"):
        raise ValueError(
            f"name = {name!r}: give FILE.py:FUNCTION, as in {name}:problem, where the function "
            "returns a uqfold.Problem"
        )
    return problems[choice("name", name, problems)]


def is_of_a_file(name: object) -> TypeGuard[str]:
    """Whether a name is ``file.py:function``."""
    return isinstance(name, str) and ".py:" in name


def methods_of_a_file(name: str) -> dict[str, Any]:
    """Return label -> method as a function in a file returns it, named as for problems.

    Raises
    ------
    ValueError
        As `named_problem` does.
    """
    file, _, own = name.rpartition(":")
    found: dict[str, Any] = _of_a_file(Path(file), own, "a dict of label -> method", _is_dict)()
    return found


def _is_problem(value: object) -> bool:
    from uqfold.problems.base import Problem

    return isinstance(value, Problem)


def _is_dict(value: object) -> bool:
    return isinstance(value, dict)


def _of_the_catalogue(name: str) -> Problem:
    from uqfold.problems import catalogue

    return catalogue.problem(name)


def _of_the_package(name: str) -> Callable[[], Problem]:
    def build() -> Problem:
        from uqfold import problems

        built: Problem = getattr(problems, name.replace("-", "_"))()
        return built

    return build


def _of_a_file(
    file: Path, name: str, returns: str, is_right: Callable[[object], bool]
) -> Callable[[], Any]:
    """Return what calls a function in a file, which is loaded at once, or is what it should return.

    `returns` says in words what `is_right` checks.
    """
    if not file.is_file():
        raise ValueError(f"name = '{file}:{name}': there is no file {file}")
    own = getattr(_loaded(file.resolve()), name, None)
    if own is None:
        raise ValueError(f"name = '{file}:{name}': {file} has no function {name!r}")

    wanted = f"{file}: {name} must be a function without arguments that returns {returns}"

    def build() -> Any:
        if is_right(own):
            return own
        try:
            inspect.signature(own).bind()
        except TypeError as error:
            raise ValueError(f"{wanted}, but {error}") from None
        except ValueError:  # a function that does not tell its arguments
            pass
        with _told_by_line(file):
            built = own()
        if not is_right(built):
            raise ValueError(f"{wanted}, but it returns {type(built).__name__}")
        return built

    return build


@cache
def _loaded(file: Path) -> ModuleType:
    """Return the module in a file, which stays importable by its name for other processes.

    As when Python runs the file, its folder comes first where modules are looked for, and stays
    there: a model may import a neighbour late, or in another process.
    """
    spec: Any = spec_from_file_location(file.stem, file)
    module = module_from_spec(spec)
    if str(file.parent) not in sys.path:
        sys.path.insert(0, str(file.parent))
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
        frames = traceback.extract_tb(error.__traceback__)
        lines = [one.lineno for one in frames if Path(one.filename).resolve() == file.resolve()]
        if isinstance(error, SyntaxError) and error.filename is not None:
            place, lines = Path(error.filename).name, [error.lineno]
        if lines:
            place += f", line {lines[-1]}"
        said = " ".join(str(error).split())
        raise ValueError(f"{place}: {type(error).__name__}: {said}") from error
