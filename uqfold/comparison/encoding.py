"""Values of records in strict JSON, which knows neither NaN nor infinity.

NaN becomes ``null``, infinities the texts ``"inf"`` and ``"-inf"``; every other number is written
in the shortest form that reads back to the same bits.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

from uqfold.checks import shown

Value = TypeVar("Value", float, int, str)

_LARGEST = 2**256
"""No whole number of a record is larger; a seed may have more than 64 bits."""
_INFINITE = {"inf": math.inf, "-inf": -math.inf}
_CALLED = {float: "a number", int: "a whole number", str: "a text"}


def encoded(value: float | str) -> float | str | None:
    """Give a number or text as a JSON value."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else ("inf" if value > 0 else "-inf")
    return value


def decoded(value: Any, kind: type[Value], where: str) -> Value:
    """Give back what `encoded` was given.

    Raises
    ------
    TypeError
        If the JSON value is not of that kind; the message says where.
    """
    if kind is float:
        if value is None:
            return kind(math.nan)
        if isinstance(value, str) and value in _INFINITE:
            return kind(_INFINITE[value])
    accepted: tuple[type, ...] = (float, int) if kind is float else (kind,)
    wrong = isinstance(value, bool) or not isinstance(value, accepted)
    if wrong:
        raise TypeError(f"{where} = {shown(value)} is not {_CALLED[kind]}")
    if isinstance(value, int) and abs(value) > _LARGEST:
        raise ValueError(f"{where} = {shown(value)} is too large")
    return kind(value)


def checked(value: Any, form: Any, where: str) -> Any:
    """Return a JSON value, whose numbers stay encoded, if it has a form.

    Parameters
    ----------
    value
        What was read.
    form
        `str`, `int` or `float`, or None for nothing; a tuple of forms that it may have; a list with
        the form of every item; a dict of field -> form, or of `str` -> form for every field.
        Fields that a form does not name are left out.
    where
        Name of the value, for messages.

    Raises
    ------
    KeyError, TypeError, ValueError
        If it lacks a field, or is none of the forms; the message says where.
    """
    if isinstance(form, tuple):
        fitting = next((one for one in form if _looks_like(value, one)), form[-1])
        return checked(value, fitting, where)
    if form is None:
        return None
    if isinstance(form, list):
        if not isinstance(value, list | tuple):
            raise TypeError(f"{where} = {shown(value)} is not a list")
        return [checked(one, form[0], where) for one in value]
    if isinstance(form, dict):
        if not isinstance(value, Mapping):
            raise TypeError(f"{where} = {shown(value)} is not an object")
        fields = form if str not in form else dict.fromkeys(value, form[str])
        return {name: checked(value[name], one, name) for name, one in fields.items()}
    return encoded(decoded(value, form, where))


def _looks_like(value: Any, form: Any) -> bool:
    if form is None:
        return value is None
    return isinstance(form, dict) == isinstance(value, Mapping)


def member(document: Mapping[str, Any], name: str, kind: type[Value]) -> Value:
    """Give one field of a JSON object, decoded; a missing one is a KeyError."""
    return decoded(document[name], kind, name)


def parsed_json(text: str) -> Any:
    """Return what a text of strict JSON holds.

    Raises
    ------
    ValueError
        If it is no JSON (the words NaN and Infinity are none), is nested too deeply, or holds a
        number that is too large for a float or has too many digits.
    """
    try:
        return json.loads(text, parse_constant=_refuse_constant, parse_float=_finite)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _finite(number: str) -> float:
    value = float(number)
    if math.isinf(value):
        raise ValueError(f"the number {number} is too large")
    return value


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")
