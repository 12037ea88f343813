"""Describing the parameters of a model exactly, as JSON.

Two values have the same description only if a model computes the same with both: every description
starts with the kind of the value, so that 1, 1.0, True and "1" differ, and numbers are kept to the
last bit. What cannot be described so is refused, never left out.
"""

from __future__ import annotations

import dataclasses
import datetime
import enum
import functools
import hashlib
import importlib.util
import sys
import types
from collections.abc import Callable, Mapping
from decimal import Decimal
from fractions import Fraction
from pathlib import Path, PurePath
from typing import Any

import numpy as np

MOST_NESTED = 50


class UndescribedError(TypeError):
    """A value whose content cannot be told; says where it lies and what it is."""


def described(value: Any, where: str = "model") -> Any:
    """Return a value as JSON.

    Parameters
    ----------
    value
        Numbers, text, bytes, dates, paths, enumerations, NumPy's scalars and arrays, containers,
        frozen dataclasses, functions with what they have captured, `functools.partial`, bound
        methods, types and modules, and any nesting of these.
    where
        How messages call it.

    Raises
    ------
    UndescribedError
        If it is, or holds, something else.
    """
    if where.count(".") + where.count("[") > MOST_NESTED:
        raise UndescribedError(f"{where[:60]}... is nested too deeply, or holds itself")
    exact = _EXACT.get(type(value))
    if exact is not None:
        return [type(value).__name__, exact(value)]
    if isinstance(value, np.generic):
        return ["scalar", *_array(np.asarray(value), where)]
    if isinstance(value, np.ma.MaskedArray):
        mask = _array(np.ma.getmaskarray(value), where)
        return ["masked", *_array(value.data, where), mask]
    if type(value) is np.ndarray:
        return ["array", *_array(value, where)]
    container = _container(value, where)
    if container is not None:
        return container
    if isinstance(value, enum.Enum):
        return ["enum", _named(type(value)), value.name, described(value.value, f"{where}.value")]
    if isinstance(value, PurePath):
        return ["path", type(value).__name__, str(value)]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _record(value, where)
    if isinstance(value, functools.partial):
        parts = (value.func, value.args, value.keywords)
        return ["partial", *(described(part, f"{where}.partial") for part in parts)]
    if isinstance(value, types.MethodType):
        owner = described(value.__self__, f"{where}.__self__")
        return ["method", described(value.__func__, f"{where}.__func__"), owner]
    if isinstance(value, types.FunctionType):
        return ["function", _named(value), *captured(value, where)]
    if isinstance(value, types.BuiltinFunctionType):
        owner = value.__self__
        if owner is None or isinstance(owner, types.ModuleType | type):
            return ["builtin", value.__module__, value.__qualname__]
        return ["builtin", value.__qualname__, described(owner, f"{where}.__self__")]
    compiled = getattr(value, "py_func", None)
    if isinstance(compiled, types.FunctionType):
        return ["compiled", described(compiled, where)]
    if isinstance(value, np.ufunc):
        return ["ufunc", value.__name__]
    if isinstance(value, type):
        return ["type", _named(value)]
    if isinstance(value, types.ModuleType):
        return ["module", value.__name__]
    raise UndescribedError(f"{where} is a {_named(type(value))}, whose content cannot be told")


def captured(function: types.FunctionType, where: str = "model") -> list[Any]:
    """Return what tells a function from others of its name: defaults, closure, a lambda's code.

    What it reads from elsewhere (global variables, files) is not seen.

    Raises
    ------
    UndescribedError
        If something in it cannot be described.
    """
    names = function.__code__.co_freevars
    cells = {
        name: _content(cell, f"{where}.{name}")
        for name, cell in zip(names, function.__closure__ or (), strict=True)
        if not _holds(cell, function)
    }
    anonymous = function.__name__ == "<lambda>"
    return [
        described(function.__defaults__, f"{where}.__defaults__"),
        described(function.__kwdefaults__, f"{where}.__kwdefaults__"),
        cells,
        _code(function.__code__, where) if anonymous else None,
    ]


def _holds(cell: types.CellType, function: types.FunctionType) -> bool:
    # a function that calls itself
    try:
        return cell.cell_contents is function
    except ValueError:
        return False


def _content(cell: types.CellType, where: str) -> Any:
    try:
        content = cell.cell_contents
    except ValueError:
        raise UndescribedError(f"{where} has no value yet") from None
    return described(content, where)


def _code(code: types.CodeType, where: str) -> list[Any]:
    constants = [
        _code(one, where) if isinstance(one, types.CodeType) else described(one, where)
        for one in code.co_consts
    ]
    names = [code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars]
    version = importlib.util.MAGIC_NUMBER.hex()
    return [version, code.co_code.hex(), constants, names, code.co_argcount, code.co_flags]


def _array(value: np.ndarray[Any, Any], where: str) -> list[Any]:
    """Return dtype, shape and a digest of the bytes, or the items where bytes do not tell."""
    shape = list(value.shape)
    if value.dtype.names is not None:
        # without the gaps between the fields, whose bytes mean nothing
        fields = [[name, *_array(value[name], f"{where}.{name}")] for name in value.dtype.names]
        return ["record", shape, fields]
    if value.dtype.kind == "O":
        items = [described(one, f"{where}[{i}]") for i, one in enumerate(value.ravel())]
        return ["object", shape, items]
    if value.dtype.kind not in "biufcSUmM" or value.dtype.char in "gG":
        raise UndescribedError(f"{where} has dtype {value.dtype}, whose bytes do not tell it")
    digest = hashlib.blake2b(np.ascontiguousarray(value).tobytes(), digest_size=16).hexdigest()
    return [value.dtype.str, shape, digest]


def _container(value: Any, where: str) -> list[Any] | None:
    kind = type(value)
    if kind in {list, tuple} or (isinstance(value, tuple) and hasattr(kind, "_fields")):
        name = kind.__name__ if kind in {list, tuple} else _named(kind)
        return [name, [described(one, f"{where}[{i}]") for i, one in enumerate(value)]]
    if kind in {set, frozenset}:
        # in an order that does not depend on the process
        return [kind.__name__, sorted((described(one, f"{where}[]") for one in value), key=repr)]
    if kind in {dict, types.MappingProxyType}:
        mapping: Mapping[Any, Any] = value
        return [
            "mapping",
            [[described(k, f"{where}[]"), described(v, f"{where}[*]")] for k, v in mapping.items()],
        ]
    return None


def _record(value: Any, where: str) -> list[Any]:
    # what is not frozen may count its own calls, and would never be recognised again
    if not value.__dataclass_params__.frozen:
        raise UndescribedError(
            f"{where} is a {_named(type(value))}, a dataclass that is not frozen"
        )
    fields = [field.name for field in dataclasses.fields(value) if field.compare]
    content = [[name, described(getattr(value, name), f"{where}.{name}")] for name in fields]
    return ["record", _named(type(value)), content, _of_local_class(type(value), where)]


def _of_local_class(kind: type, where: str) -> list[Any]:
    """Return what a class that is defined inside a function has from there."""
    if "<locals>" not in kind.__qualname__:
        return []
    content = []
    for name, value in sorted(vars(kind).items()):
        own = name == "__call__" or not name.startswith("__")
        if isinstance(value, types.FunctionType):
            if own:
                content.append([name, captured(value, f"{where}.{name}")])
        elif own and not hasattr(type(value), "__get__"):
            content.append([name, described(value, f"{where}.{name}")])
    return content


def _named(value: Any) -> str:
    module = str(value.__module__)
    if module.startswith("_"):
        # a script, started or loaded by its workers or by a study: its file has the lasting name
        module = Path(getattr(sys.modules.get(module), "__file__", None) or module).stem
    return f"{module}.{value.__qualname__}"


def _zone(zone: datetime.tzinfo | None) -> str:
    if zone is None:
        return ""
    key = getattr(zone, "key", None)
    if isinstance(zone, datetime.timezone) or isinstance(key, str):
        return repr(zone)
    raise UndescribedError(f"the time zone {zone!r} cannot be told from others")


def _moment(value: datetime.datetime | datetime.time) -> list[Any]:
    return [value.replace(tzinfo=None).isoformat(), value.fold, _zone(value.tzinfo)]


_EXACT: Mapping[type, Callable[[Any], Any]] = {
    type(None): lambda value: None,
    type(...): lambda value: None,
    bool: bool,
    int: str,
    float: float.hex,
    complex: lambda value: [value.real.hex(), value.imag.hex()],
    str: str,
    bytes: bytes.hex,
    bytearray: bytearray.hex,
    Decimal: lambda value: str(value.as_tuple()),
    Fraction: lambda value: [str(value.numerator), str(value.denominator)],
    range: lambda value: [str(value.start), str(value.stop), str(value.step)],
    slice: lambda value: [described(one) for one in (value.start, value.stop, value.step)],
    datetime.date: datetime.date.isoformat,
    datetime.datetime: _moment,
    datetime.time: _moment,
    datetime.timedelta: lambda value: [value.days, value.seconds, value.microseconds],
}
