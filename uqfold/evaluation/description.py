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
from contextvars import ContextVar
from decimal import Decimal
from fractions import Fraction
from pathlib import Path, PurePath
from typing import Any, NamedTuple

import numpy as np

MOST_NESTED = 50


class _Pair(NamedTuple):
    first: int


# What is not an attribute of a class, but says where its instances keep one.
_PLACES = (types.MemberDescriptorType, types.GetSetDescriptorType, type(_Pair.first))
_WRAPPERS = (staticmethod, classmethod, property, functools.cached_property)
# Classes that are being described: their methods may name them.
_under_way: ContextVar[tuple[type, ...]] = ContextVar("_under_way", default=())


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
    if type(value) is functools.partial:
        parts = (value.func, value.args, value.keywords, vars(value))
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
    if isinstance(value, np.ufunc) and _has_its_name(value):
        return ["ufunc", value.__name__]
    if isinstance(value, type):
        return ["type", _named(value), _of_local_class(value, where)]
    if isinstance(value, types.ModuleType):
        return ["module", value.__name__]
    raise UndescribedError(f"{where} is a {_named(type(value))}, whose content cannot be told")


def captured(function: types.FunctionType, where: str = "model") -> list[Any]:
    """Return what tells a function from others of its name.

    These are its defaults, closure and attributes, and the code of a lambda or of a function that
    is defined inside another. What it reads from elsewhere (global variables, files) is not seen.

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
    # many of these may have one name: both branches of an if define it, say
    of_no_name = function.__name__ == "<lambda>" or "<locals>" in function.__qualname__
    return [
        described(function.__defaults__, f"{where}.__defaults__"),
        described(function.__kwdefaults__, f"{where}.__kwdefaults__"),
        cells,
        described(vars(function), f"{where}.__dict__"),
        _code(function.__code__, where) if of_no_name else None,
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
        items = [described(one, f"{where}[{i}]") for i, one in enumerate(value)]
        if kind in {list, tuple}:
            return [kind.__name__, items]
        return [_named(kind), items, _of_local_class(kind, where)]
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
    fields = dataclasses.fields(value)
    content = {field.name: getattr(value, field.name) for field in fields if field.compare}
    # what __post_init__ has made of an InitVar, say; what is only remembered follows from the rest
    named = {field.name for field in fields}
    for name, extra in getattr(value, "__dict__", {}).items():
        remembered = isinstance(getattr(type(value), name, None), functools.cached_property)
        if name not in named and not remembered:
            content[name] = extra
    return [
        "record",
        _named(type(value)),
        [[name, described(one, f"{where}.{name}")] for name, one in content.items()],
        _of_local_class(type(value), where),
    ]


def _has_its_name(ufunc: np.ufunc) -> bool:
    """Whether it is NumPy's or SciPy's of that name, not one made of a function."""
    homes = (np, sys.modules.get("scipy.special"))
    return any(getattr(home, ufunc.__name__, None) is ufunc for home in homes)


def _of_local_class(kind: type, where: str) -> list[Any]:
    """Return what classes that are defined inside a function have from there, bases too."""
    if issubclass(kind, enum.Enum) or kind in _under_way.get():
        return []
    token = _under_way.set((*_under_way.get(), kind))
    try:
        return [
            [_named(one), _own_attributes(one, where)]
            for one in kind.__mro__
            if "<locals>" in one.__qualname__
        ]
    finally:
        _under_way.reset(token)


def _own_attributes(kind: type, where: str) -> list[Any]:
    content: list[Any] = []
    for name, value in sorted(vars(kind).items()):
        here = f"{where}.{name}"
        if isinstance(value, types.FunctionType):
            # what dataclass and NamedTuple write themselves follows from the fields
            written = value.__code__.co_filename == "<string>" and name.startswith("__")
            if name == "__call__" or not (written or value.__module__ != kind.__module__):
                content.append([name, captured(value, here)])
        elif isinstance(value, _WRAPPERS):
            parts = [getattr(value, part, None) for part in ("__func__", "func", "fget", "fset")]
            content.append([name, [described(part, here) for part in parts]])
        elif not (name.startswith("__") or name == "_abc_impl" or isinstance(value, _PLACES)):
            content.append([name, described(value, here)])
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
