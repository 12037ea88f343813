"""Describing the parameters of a model exactly, as JSON.

Two values have the same description only if a model computes the same with both: every description
starts with the kind of the value, so that 1, 1.0, True and "1" differ, and numbers are kept to the
last bit. What cannot be described so is refused, never left out: an object is described only if all
that its class lets it hold is. A class or function that its module has under its name is code, for
which name and version of the problem stand; one made while the program runs may differ each time.
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
import zoneinfo
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
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
# What dataclass writes into a class: it follows from the fields.
_WRITTEN = frozenset(
    f"__{name}__"
    for name in ("init", "repr", "eq", "lt", "le", "gt", "ge", "hash", "setattr", "delattr")
)
# What Enum itself keeps in a member, beside what its value says.
_OF_A_MEMBER = {"_name_", "_value_", "__objclass__", "_sort_order_", "_inverted_"}
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
    if isinstance(value, np.generic) and not _made_by_statement(type(value)):
        return ["scalar", *_array(np.asarray(value), where)]
    if type(value) is np.ma.MaskedArray:
        mask = _array(np.ma.getmaskarray(value), where)
        return ["masked", *_array(value.data, where), mask, *_fill(value, where)]
    if type(value) is np.ndarray:
        return ["array", *_array(value, where)]
    container = _container(value, where)
    if container is not None:
        return container
    if isinstance(value, enum.Enum):
        return _member(value, where)
    if isinstance(value, PurePath) and type(value).__module__.startswith("pathlib"):
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
    function = uncompiled(value)
    if function is not value:
        return ["compiled", described(function, where)]
    if isinstance(value, np.ufunc) and _is_known(value):
        return ["ufunc", value.__name__]
    if isinstance(value, type):
        if issubclass(value, enum.Enum) and not _has_its_name(value):
            raise UndescribedError(_nameless(value, where))
        return ["type", _named(value), _of_local_class(value, where)]
    if isinstance(value, types.ModuleType) and sys.modules.get(value.__name__) is value:
        return ["module", value.__name__]
    raise UndescribedError(f"{where} is a {_named(type(value))}, whose content cannot be told")


def uncompiled(model: Any) -> Any:
    """Return the function of which Numba has made a model, or the model itself."""
    if type(model).__module__.partition(".")[0] != "numba":
        return model
    function = getattr(model, "py_func", None)
    return function if isinstance(function, types.FunctionType) else model


def captured(function: types.FunctionType, where: str = "model") -> list[Any]:
    """Return what tells a function from others of its name.

    These are its defaults, closure and attributes, and the code of a lambda or of a function that
    is defined inside another or compiled from text. What it reads from elsewhere (global
    variables, files) is not seen.

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
    # so has what is compiled from text that a program has put together
    of_no_file = function.__code__.co_filename.startswith("<") and not (
        _has_its_name(function) or str(function.__module__).startswith("namedtuple_")
    )
    return [
        described(function.__defaults__, f"{where}.__defaults__"),
        described(function.__kwdefaults__, f"{where}.__kwdefaults__"),
        cells,
        described(vars(function), f"{where}.__dict__"),
        _code(function.__code__, where) if of_no_name or of_no_file else None,
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
        return [_named(kind), items, _of_local_class(kind, where), *_more(value, set(), where)]
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
    if (base := _base_with_content(type(value))) is not None:
        raise UndescribedError(
            f"{where} is a {_named(type(value))}, which has content of the type {base.__name__} "
            "beside its fields: keep that in a field"
        )
    fields = dataclasses.fields(value)
    content = {field.name: getattr(value, field.name) for field in fields if field.compare}
    # what __post_init__ has made of an InitVar, say
    content.update(_beyond(value, {field.name for field in fields}))
    return [
        "record",
        _named(type(value)),
        [[name, described(one, f"{where}.{name}")] for name, one in content.items()],
        _of_local_class(type(value), where),
    ]


def _member(value: enum.Enum, where: str) -> list[Any]:
    kind: Any = type(value)
    if not _has_its_name(kind):
        raise UndescribedError(_nameless(kind, where))
    told = described(value.value, f"{where}.value")
    mixed = kind._member_type_
    inner = []
    # a __new__ of its own may give the number or text that a member is another value
    if mixed is not object and isinstance(kind._new_member_, types.FunctionType):
        if mixed not in _EXACT:
            raise UndescribedError(f"{where} is a {_named(kind)} with a __new__ of its own")
        own = described(mixed(value), where)
        inner = [] if own == told else [own]
    return ["enum", _named(kind), value.name, told, *inner, *_more(value, _OF_A_MEMBER, where)]


def _nameless(kind: type, where: str) -> str:
    return f"{where}: the Enum {_named(kind)} is made while the program runs: define it in a module"


def _more(value: Any, known: set[str], where: str) -> list[Any]:
    """Return what an object holds beside what is known, as a list that is empty if that is all."""
    more = {name: described(one, f"{where}.{name}") for name, one in _beyond(value, known)}
    return [more] if more else []


def _beyond(value: Any, known: set[str]) -> Iterator[tuple[str, Any]]:
    """Yield the attributes of an object that are not known, from its slots and its __dict__."""
    for kind in type(value).__mro__:
        for name, slot in vars(kind).items():
            is_slot = isinstance(slot, types.MemberDescriptorType) and _made_by_statement(kind)
            # what a subclass hides under a name of its own is there nevertheless
            if is_slot and not (name in known and getattr(type(value), name, None) is slot):
                with suppress(AttributeError):  # it has no value
                    yield f"{kind.__qualname__}.{name}", slot.__get__(value)
    for name, one in getattr(value, "__dict__", {}).items():
        # what is only remembered follows from the rest
        remembered = isinstance(getattr(type(value), name, None), functools.cached_property)
        if name not in known and not remembered:
            yield name, one


def _base_with_content(kind: type) -> type | None:
    """Return a base that holds more than slots and a __dict__, such as dict or float."""
    for one in kind.__mro__:
        new = one.__new__
        own_new = isinstance(new, types.BuiltinFunctionType) and new.__self__ is one
        in_c = own_new or not _made_by_statement(one)
        if in_c and (one.__basicsize__, one.__itemsize__) != (object.__basicsize__, 0):
            return one
    return None


def _made_by_statement(kind: type) -> bool:
    """Whether a class is made by Python's class statement or `type`, not written in C."""
    heap, immutable = 1 << 9, 1 << 8  # Py_TPFLAGS_HEAPTYPE, Py_TPFLAGS_IMMUTABLETYPE
    return bool(kind.__flags__ & heap) and not kind.__flags__ & immutable


def _fill(value: np.ma.MaskedArray[Any, Any], where: str) -> list[Any]:
    fill = getattr(value, "_fill_value", None)
    if fill is None or value.dtype.names is not None:
        return []
    own, usual = described(fill, where), np.asarray(np.ma.default_fill_value(value), fill.dtype)
    return [] if own == described(usual, where) else [own]


def _is_known(ufunc: np.ufunc) -> bool:
    """Whether it is NumPy's or SciPy's of that name, not one made of a function."""
    homes = (np, sys.modules.get("scipy.special"))
    return any(getattr(home, ufunc.__name__, None) is ufunc for home in homes)


def _has_its_name(value: Any) -> bool:
    """Whether a class or function is what its module has under its name."""
    found = sys.modules.get(value.__module__)
    for part in value.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is value


def _of_local_class(kind: type, where: str) -> list[Any]:
    """Return what classes that are made while the program runs have from there, bases too.

    So do their metaclasses.
    """
    if issubclass(kind, enum.Enum) or kind in _under_way.get():
        return []
    token = _under_way.set((*_under_way.get(), kind))
    try:
        made = [one for one in kind.__mro__ if _made_by_statement(one) and not _has_its_name(one)]
        content = [[_named(one), _own_attributes(one, where)] for one in made]
        return content + (_of_local_class(type(kind), where) if made else [])
    finally:
        _under_way.reset(token)


def _own_attributes(kind: type, where: str) -> list[Any]:
    content: list[Any] = []
    for name, value in sorted(vars(kind).items()):
        here = f"{where}.{name}"
        special = name.startswith("__")
        if isinstance(value, types.FunctionType):
            written = value.__code__.co_filename == "<string>" and name in _WRITTEN
            # nor is what NamedTuple writes the class's own
            library = str(value.__module__).partition(".")[0] in sys.stdlib_module_names
            foreign = library and value.__module__ != kind.__module__
            if name == "__call__" or not (written or foreign):
                content.append([name, captured(value, here)])
        elif isinstance(value, _WRAPPERS):
            parts = [getattr(value, part, None) for part in ("__func__", "func", "fget", "fset")]
            content.append([name, [described(part, here) for part in parts]])
        elif special and (callable(value) or hasattr(type(value), "__get__")):
            if not isinstance(value, _PLACES):
                content.append([name, described(value, here)])
        elif not (special or name == "_abc_impl" or isinstance(value, _PLACES)):
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
    named = isinstance(zone, zoneinfo.ZoneInfo) and zone.key is not None
    if isinstance(zone, datetime.timezone) or named:
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
