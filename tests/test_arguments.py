"""Every public signature: wrong arguments are refused by name, NumPy scalars are taken as numbers.

Each parameter gets every wrong value of `argument_calls.WRONG` while the other arguments are good.
It may only be accepted where the table says that it is good there; otherwise the answer is a
ValueError or a TypeError that names the parameter and shows the value or its type, and no
IndexError, AttributeError or OverflowError from inside.
"""

from __future__ import annotations

import inspect
import pkgutil
import re
import warnings
from collections.abc import Iterator
from contextlib import chdir
from importlib import import_module
from typing import Any

import pytest

import uqfold
from tests.argument_calls import WITHOUT_ARGUMENT_CHECKS, WRONG, Call, calls
from uqfold.checks import shown

SELF_EXPLAINING = {"source": "records", "x": "X", "u": "U"}
"""Parameters that messages may call by another name."""


def public_callables() -> dict[str, Any]:
    """Return everything with a signature that the rooms export, without exceptions."""
    rooms = ["uqfold"] + [
        f"uqfold.{m.name}" for m in pkgutil.iter_modules(uqfold.__path__) if m.ispkg
    ]
    found: dict[str, Any] = {}
    # under its first name only, which is that of the top level
    known: set[int] = set()
    for room in rooms:
        module = import_module(room)
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            literal = not (
                inspect.isclass(value) or inspect.isroutine(value) or hasattr(value, "__wrapped__")
            )
            error = inspect.isclass(value) and issubclass(value, BaseException)
            if literal or error or id(value) in known:
                continue
            known.add(id(value))
            label = f"{room}.{name}".removeprefix("uqfold.")
            found[label] = value
            if inspect.isclass(value):
                found |= _methods(label, value)
    return found


def _methods(label: str, owner: type) -> dict[str, Any]:
    """Return the public methods that a class defines itself, if they take arguments."""
    found = {}
    for name, value in vars(owner).items():
        plain = value.__func__ if isinstance(value, classmethod) else value
        overrides = any(hasattr(base, name) for base in owner.__mro__[1:])
        if name.startswith("_") or not inspect.isfunction(plain) or overrides:
            continue
        if len(inspect.signature(plain).parameters) > 1:
            found[f"{label}.{name}"] = plain
    return found


def parameters_of(function: Any) -> set[str]:
    """Return the names of the parameters that a caller fills in."""
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return {
        name
        for name, parameter in inspect.signature(function).parameters.items()
        if name not in ("self", "cls") and parameter.kind not in kinds and not name.startswith("_")
    }


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Call]]:
    folder = tmp_path_factory.mktemp("arguments")
    with chdir(folder):  # some wrong values are good names of files
        yield calls(folder / "files")


def test_every_public_signature_is_in_the_table(table: dict[str, Call]) -> None:
    public = public_callables()
    assert set(public) == set(table) | (WITHOUT_ARGUMENT_CHECKS & set(public))
    assert set(public) >= WITHOUT_ARGUMENT_CHECKS
    assert not set(table) & WITHOUT_ARGUMENT_CHECKS
    for name, call in table.items():
        assert parameters_of(public[name]) <= set(call.kinds), name


def verdict(name: str, call: Call, parameter: str, key: str) -> str:
    """Return what is wrong with the answer to one wrong argument; empty if nothing is."""
    value = WRONG[key]
    given = {one: kind.good for one, kind in call.kinds.items()} | {parameter: value}
    where = f"{name}({parameter}={shown(value)})"
    try:
        call.function(**given)
    except (ValueError, TypeError) as error:
        if key in call.kinds[parameter].takes:  # of the right type, but of no use here
            return ""
        said = str(error)
        words = {parameter, SELF_EXPLAINING.get(parameter, parameter)}
        named = any(re.search(rf"\b{word}\b", said) for word in words)
        items = list(value) if isinstance(value, list | dict | set) else []
        inner = items[0] if items and isinstance(items[0], list) else []
        shapes = [value, tuple(items), *items, *inner]
        texts = {piece for one in shapes for piece in (shown(one), type(one).__name__)}
        if not named or not any(text in said for text in texts):
            return f"{where}: {type(error).__name__}: {said}"
    except OSError as error:
        return "" if key in call.kinds[parameter].takes else f"{where}: {error!r}"
    except Exception as error:
        return f"{where}: {error!r}"
    else:
        return "" if key in call.kinds[parameter].takes else f"{where} is accepted"
    return ""


@pytest.mark.parametrize(
    "taken", [False, pytest.param(True, marks=pytest.mark.thorough)], ids=["wrong", "good here"]
)
def test_wrong_arguments_are_refused_by_name(table: dict[str, Call], taken: bool) -> None:
    """Values that are good in their place are tried too, though most of them take a whole run."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = [
            verdict(name, call, parameter, key)
            for name, call in table.items()
            for parameter, kind in call.kinds.items()
            for key in WRONG
            if key not in kind.untried and (key in kind.takes) == taken
        ]
    wrong = [one for one in found if one]
    assert not wrong, f"{len(wrong)} of {len(found)} end wrongly:\n" + "\n".join(wrong)


def answer(call: Call, given: dict[str, Any]) -> str:
    """Return an answer as text, without times and addresses."""
    found = call.function(**given)
    # what prints as a table has rows, in which nothing is rounded
    text = repr(getattr(found, "rows", found))
    return re.sub(r"seconds=[^,)]*|at 0x[0-9a-f]*", "", text)


@pytest.mark.thorough
def test_numpy_scalars_are_as_good_as_numbers(table: dict[str, Call]) -> None:
    for name, call in table.items():
        plain = {parameter: kind.good for parameter, kind in call.kinds.items()}
        same = {p: kind.same for p, kind in call.kinds.items() if kind.same is not None}
        if same:
            assert answer(call, plain | same) == answer(call, plain), name
