"""What counts as a response: the one judge of everything that a model gives back."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Set
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np

from uqfold.checks import raised, said_by
from uqfold.typing import FloatArray

_NUMBERS = "iuf"
"""Kinds of NumPy's types that are real numbers: no bool, date, time span, text or record."""


_NO_ARRAYS = (str, bytes, bytearray, memoryview, Mapping, Set, Iterator)


class ResponseError(TypeError):
    """What a model gave back holds something that is not a number."""


def numbers_in(returned: Any) -> FloatArray:
    """Return the numbers that a model gave back as floats, in the shape in which they came.

    Real numbers of any kind are taken, exact ones (`fractions.Fraction`, `decimal.Decimal`) too. A
    run has failed, and its response is NaN, where an entry is masked, None or `pandas.NA`, where a
    complex number has an imaginary part, and where a finite number is too large for a float.

    Raises
    ------
    ResponseError
        If something is not a number: text (also "1.5"), a bool, date, time span or record, a
        mapping, set or generator, lists of different lengths.
    """
    if isinstance(returned, _NO_ARRAYS):
        raise _refused(f"a {type(returned).__name__}")
    try:
        given = np.asanyarray(_listed(returned))
    except ResponseError:
        raise
    except Exception as error:  # an object makes an array of itself as it likes
        raise _refused(
            f"a {type(returned).__name__} that is not an array ({said_by(error)})"
        ) from error
    y = _as_floats(np.asarray(given))
    if isinstance(given, np.ma.MaskedArray):
        y = np.where(np.ma.getmaskarray(given), np.nan, y)
    return y


def one_number(returned: Any) -> float:
    """Return the response of one sample; NaN if the run failed, as in `numbers_in`.

    Raises
    ------
    ResponseError
        If it is not a number.
    ValueError
        If it is more or less than one number.
    """
    y = numbers_in(returned)
    if y.size != 1:
        raise ValueError(f"it returned shape {y.shape} for one sample, expected one number")
    return float(y.item())


def _as_floats(given: np.ndarray[Any, Any]) -> FloatArray:
    kind = given.dtype.kind
    if kind == "O":
        y = np.empty(given.shape)
        y.ravel()[:] = [_number(item) for item in given.ravel()]
        return y
    if kind == "c":
        return np.where(given.imag == 0.0, _as_floats(given.real), np.nan)
    if kind not in _NUMBERS:
        if given.size == 0:  # an empty list has no type of its own
            return np.empty(given.shape)
        raise _refused(f"an array of dtype {given.dtype}")
    with np.errstate(over="ignore"):
        y = np.array(given, dtype=np.float64)
    # a longer float has more room
    y[np.isinf(y) & np.isfinite(given)] = np.nan
    return y


def _number(item: Any) -> float:
    """Return one object among others as a float."""
    if item is None or type(item).__name__ == "NAType":
        return math.nan
    if isinstance(item, np.ndarray | np.generic | list | tuple):
        y = numbers_in(item)
        if y.size == 1:
            return float(y.item())
        raise _refused(f"an object of shape {y.shape} among others")
    if isinstance(item, complex):
        return item.real if item.imag == 0.0 else math.nan
    known = isinstance(item, Real | Decimal) and not isinstance(item, bool)
    if not known and (isinstance(item, bool) or not hasattr(type(item), "__float__")):
        raise _refused(f"a {type(item).__name__}")
    try:
        number = float(item)
    except (OverflowError, ValueError):  # too large, or a NaN that signals
        return math.nan
    except Exception as error:
        raise _refused(f"a {type(item).__name__} ({raised(error)})") from error
    exact = not isinstance(item, float)
    return math.nan if exact and math.isinf(number) and not _is_infinite(item) else number


def _is_infinite(item: Any) -> bool:
    return bool(item in {math.inf, -math.inf}) if isinstance(item, Real | Decimal) else True


def _listed(returned: Any) -> Any:
    """Return lists with what NumPy would lose in them: masks, and that a bool is not a number."""
    if isinstance(returned, np.ma.MaskedArray) or not isinstance(returned, list | tuple):
        return returned
    kinds = {type(one) for one in returned}
    if kinds & {bool, np.bool_}:
        raise _refused("a bool among others")
    if not any(issubclass(kind, np.ma.MaskedArray | list | tuple) for kind in kinds):
        return returned
    return [
        numbers_in(one) if isinstance(one, np.ma.MaskedArray) else _listed(one) for one in returned
    ]


def _refused(what: str) -> ResponseError:
    return ResponseError(
        f"it returned {what}, which is not a number: return real numbers, NaN for a failed run and "
        "infinity for one that fails every criterion"
    )
