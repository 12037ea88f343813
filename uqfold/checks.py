"""Checks of arguments: each names the argument, the bad value and the remedy.

A check takes the argument's name and its value and returns the value as plain Python has it, so
that a NumPy scalar (or an array of no dimensions) is as good as a Python number. What has the wrong
type raises TypeError, what is out of range ValueError, always as ``name = value: remedy``.

>>> import numpy as np
>>> whole("runs", np.int64(5), at_least=1)
5
>>> real("step", "0.1", above=0.0)
Traceback (most recent call last):
    ...
TypeError: step = '0.1': give a positive number
"""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from decimal import Decimal
from difflib import get_close_matches
from numbers import Integral, Real
from pathlib import Path
from reprlib import Repr
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar, overload

if TYPE_CHECKING:
    from uqfold.typing import FloatArray

T = TypeVar("T")
P = ParamSpec("P")

LARGEST_WHOLE = 2**63 - 1
"""No whole number without another bound is larger, so that it fits into an array."""

_FEW = 20
"""More options are not listed where it is clear which one is meant."""
_LONGEST = 400
"""Characters of a text that comes from elsewhere, such as the error of a model."""
# control characters, halves of surrogate pairs, and what turns the direction of writing
_UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")

_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = 80
_SHORT.maxlong = 40


def whole(
    name: str,
    value: object,
    *,
    at_least: int | None = None,
    at_most: int | None = None,
    what: str = "whole number",
) -> int:
    """Return a whole number; 1e3 is one, True and "3" are none.

    `what` says what it is, for the message, as in `real`.

    Raises
    ------
    TypeError, ValueError
        If it is not a number, not whole or outside [at_least, at_most].
    """
    remedy = f"give a {what}"
    if at_least is not None:
        remedy += f" >= {at_least}" if at_most is None else f" from {at_least} to {at_most}"
    elif at_most is not None:
        remedy += f" <= {at_most}"
    number = plain(value)
    if not _is_number(number):
        raise refused(name, value, remedy, TypeError)
    try:
        is_whole = isinstance(number, Integral) or (math.isfinite(number) and number == int(number))
    except (OverflowError, ValueError):  # too large, or a NaN that signals
        is_whole = False
    if not is_whole:
        raise refused(name, number, remedy)
    number = int(number)
    if at_most is None and abs(number) > LARGEST_WHOLE:
        raise refused(name, number, f"{remedy}, smaller than 2**63")
    if (at_least is not None and number < at_least) or (at_most is not None and number > at_most):
        raise refused(name, number, remedy)
    return number


def real(
    name: str,
    value: object,
    *,
    at_least: float | None = None,
    at_most: float | None = None,
    above: float | None = None,
    below: float | None = None,
    finite: bool = True,
    nan: bool = False,
    what: str = "number",
) -> float:
    """Return a real number between bounds, closed or open; NaN is none unless it may be.

    Parameters
    ----------
    name, value
        The argument.
    at_least, at_most
        Closed bounds.
    above, below
        Open bounds.
    finite
        Whether infinity is refused.
    nan
        Whether NaN is taken.
    what
        What the number is, for the message: "number of seconds".

    Raises
    ------
    TypeError, ValueError
        If it is not a real number, too large for a float or outside the bounds.
    """
    low = above if above is not None else at_least
    high = below if below is not None else at_most
    if low is not None and high is not None:
        first, last = "[" if above is None else "(", "]" if below is None else ")"
        remedy = f"give a {what} in {first}{low:g}, {high:g}{last}"
    elif above == 0.0:
        remedy = f"give a positive {what}"
    elif low is not None:
        remedy = f"give a {what} {'>' if above is not None else '>='} {low:g}"
    elif high is not None:
        remedy = f"give a {what} {'<' if below is not None else '<='} {high:g}"
    else:
        remedy = f"give a {'finite ' if finite else ''}{what}"
    number = plain(value)
    if not _is_number(number):
        raise refused(name, value, remedy, TypeError)
    try:
        given = float(number)
    except OverflowError:
        raise refused(name, value, f"{remedy} that fits into a float") from None
    except ValueError:  # a signalling NaN
        raise refused(name, value, remedy) from None
    if nan and math.isnan(given):
        return given
    if (
        math.isnan(given)
        or (math.isinf(given) and (finite or given != number))
        or (at_least is not None and given < at_least)
        or (at_most is not None and given > at_most)
        or (above is not None and given <= above)
        or (below is not None and given >= below)
    ):
        endless = math.isinf(given) and finite and "finite" not in remedy
        raise refused(name, number, f"{remedy} that is finite" if endless else remedy)
    return given


def flag(name: str, value: object) -> bool:
    """Return True or False; 1, "yes" and None are neither."""
    simple = plain(value)
    if not isinstance(simple, bool):
        raise refused(name, value, "give True or False", TypeError)
    return simple


def text(name: str, value: object, *, empty: bool = False, what: str = "text") -> str:
    """Return text, which is not empty unless it may be; bytes are none."""
    simple = plain(value)
    if not isinstance(simple, str):
        raise refused(name, value, f"give {what}", TypeError)
    if not simple and not empty:
        raise refused(name, value, f"give {what} that is not empty")
    return str(simple)


def _meant(word: str, names: Sequence[str]) -> str | None:
    """Return the name that a misspelt word is nearest to, or is a part of, if there is one."""
    parts = [name for name in names if word in name.split("-")]
    return parts[0] if len(parts) == 1 else next(iter(get_close_matches(word, names, n=1)), None)


def choice(name: str, value: object, options: Iterable[T]) -> T:
    """Return the option that the value equals: text, a number or a member of an Enum."""
    simple = plain(value)
    offered = list(options)
    kinds = tuple({type(option) for option in offered})
    right_kind = isinstance(simple, kinds) and (not isinstance(simple, bool) or bool in kinds)
    for option in offered:
        if right_kind and simple == option:
            return option
    remedy = f"choose from {', '.join(map(shown, offered))}"
    if isinstance(simple, str):
        names = [option for option in offered if isinstance(option, str)]
        if meant := _meant(simple.lower().replace("_", "-"), names):
            remedy = f"did you mean {meant!r}? {remedy if len(offered) <= _FEW else ''}".rstrip()
    raise refused(name, value, remedy, ValueError if right_kind else TypeError)


@overload
def instance(name: str, value: object, kind: type[T], remedy: str) -> T: ...
@overload
def instance(name: str, value: object, kind: tuple[type, ...], remedy: str) -> Any: ...
def instance(name: str, value: object, kind: type | tuple[type, ...], remedy: str) -> Any:
    """Return a value of a kind; the remedy says how to come by one: "give a Problem"."""
    if not isinstance(value, kind):
        raise refused(name, value, remedy, TypeError)
    return value


def function(name: str, value: Any, remedy: str = "give a function") -> Callable[..., Any]:
    """Return something that can be called and is not a class."""
    if not callable(value) or isinstance(value, type):
        raise refused(name, value, remedy, TypeError)
    return value  # type: ignore[no-any-return]


def path(name: str, value: object) -> Path:
    """Return the path of a file or folder, given as text or ``os.PathLike``."""
    remedy = "give a path as text or pathlib.Path"
    simple = plain(value)
    given = os.fspath(simple) if isinstance(simple, str | os.PathLike) else None
    if not isinstance(given, str):
        raise refused(name, value, remedy, TypeError)
    if not given or "\0" in given:
        raise refused(name, value, remedy)
    return Path(given)


def or_none(
    name: str,
    value: object,
    check: Callable[Concatenate[str, Any, P], T],
    *args: P.args,
    **bounds: P.kwargs,
) -> T | None:
    """Return None for None, otherwise what another check returns."""
    if value is None:
        return None
    try:
        return check(name, value, *args, **bounds)
    except (TypeError, ValueError) as error:
        if not str(error).startswith(f"{name} = "):  # it is about an item
            raise
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"{error}, or None") from None


def several(
    name: str,
    value: object,
    check: Callable[Concatenate[str, Any, P], T],
    *args: P.args,
    **bounds: P.kwargs,
) -> tuple[T, ...]:
    """Return the items of a list, each checked as ``name[i]``; it may be empty."""
    return tuple(
        check(f"{name}[{i}]", item, *args, **bounds) for i, item in enumerate(listed(name, value))
    )


def listed(name: str, value: object, *, what: str = "list", sets: bool = False) -> tuple[Any, ...]:
    """Return the items of an ordered collection; text and mappings are none, sets only if asked."""
    loose = isinstance(value, str | bytes | bytearray | Mapping | type)
    loose = loose or (not sets and isinstance(value, set | frozenset))
    if isinstance(value, Iterable) and not loose and getattr(value, "shape", None) != ():
        return tuple(value)
    raise refused(name, value, f"give a {what}", TypeError)


def mapping(
    name: str,
    value: object,
    check: Callable[Concatenate[str, Any, P], T],
    *args: P.args,
    **bounds: P.kwargs,
) -> dict[str, T]:
    """Return a dict of text -> what a check of its value returns, checked as ``name['key']``."""
    if not isinstance(value, Mapping):
        raise refused(name, value, "give a dict of names", TypeError)
    return {
        text(f"a key of {name}", key): check(f"{name}[{key!r}]", item, *args, **bounds)
        for key, item in value.items()
    }


def names(name: str, value: object) -> tuple[str, ...]:
    """Return the names of a list: printable text, none of them twice, and no blanks around."""
    given = several(name, value, text)
    for one in given:
        if not one.isprintable():
            raise refused(name, given, f"name without line breaks and control signs, not {one!r}")
        if one != one.strip():
            raise refused(name, given, f"name without blanks at the ends, not {one!r}")
    twice = next((one for i, one in enumerate(given) if one in given[:i]), None)
    if twice is not None:
        raise refused(name, given, f"name each once, not {twice!r} twice")
    return given


def array(
    name: str, value: object, shape: tuple[int | str, ...] | None = None, *, finite: bool = True
) -> FloatArray:
    """Return real numbers as a float array of a shape; a letter stands for any length.

    Parameters
    ----------
    name, value
        The argument: an array, or lists of numbers; text, booleans, dates, complex numbers and
        masked entries are not numbers.
    shape
        For example ("n", 3); None for any.
    finite
        Whether NaN and infinity are refused.

    Raises
    ------
    TypeError, ValueError
        If an entry is not such a number, or the shape differs.
    """
    import numpy as np

    remedy = f"give {'finite ' if finite else ''}real numbers"
    if shape is not None:
        remedy += f" of shape ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})"
    try:
        given = np.asanyarray(value)
    except (TypeError, ValueError, OverflowError):  # lists of different lengths
        raise refused(name, value, remedy) from None
    if given.dtype.kind == "O":
        if not given.ndim and shape:
            raise refused(name, value, remedy, TypeError)
        given = np.array(
            [real(name, item, finite=finite, nan=not finite) for item in given.ravel().tolist()],
            dtype=np.float64,
        ).reshape(given.shape)
    if given.dtype.kind not in "iuf" and given.size:
        raise refused(name, value, remedy, TypeError)
    if np.ma.is_masked(given):
        raise refused(name, value, f"{remedy}, none of them masked")
    if shape is not None and (
        given.ndim != len(shape)
        or any(isinstance(n, int) and n != m for n, m in zip(shape, given.shape, strict=True))
    ):
        raise refused(name, value, f"{remedy}, not {given.shape}")
    numbers = np.asarray(given, dtype=np.float64)
    if finite and not np.isfinite(numbers).all():
        raise refused(name, value, remedy)
    return numbers


def keep(
    record: object, name: str, check: Callable[..., object], /, *args: Any, **bounds: Any
) -> None:
    """Check a field of a frozen record and keep what the check returns."""
    object.__setattr__(record, name, check(name, getattr(record, name), *args, **bounds))


def refused(name: str, value: object, remedy: str, kind: type[Exception] = ValueError) -> Exception:
    """Return the error that says ``name = value: remedy``."""
    return kind(f"{name} = {shown(value)}: {remedy}")


def shown(value: object) -> str:
    """Return a value as text of one short line, whatever its own text does."""
    try:
        return one_line(_SHORT.repr(value))
    except Exception:  # such as an integer of more digits than Python prints
        return f"<{type(value).__name__}>"


def raised(error: BaseException) -> str:
    """Return an error's type and text as one short line, whatever its own text does."""
    kind, said = type(error).__name__, said_by(error)
    return f"{one_line(kind)}: {said}"


def said_by(error: BaseException) -> str:
    """Return an error's text as one short line; if it has none that can be told, that is said."""
    try:
        return one_line(str(error))
    except Exception:
        return "(its text cannot be told)"


def one_line(text: str) -> str:
    r"""Return text that comes from elsewhere as one short line that any terminal and file can take.

    Of a long one both ends are left; what is not seen, and might be obeyed, is replaced.

    >>> one_line("red:\x1b[31m\nnext"), len(one_line("x" * 10**6))
    ('red:�[31m next', 400)
    """
    if len(text) > _LONGEST:
        half = (_LONGEST - 5) // 2
        text = f"{text[:half]} ... {text[-half - 1 :]}"[:_LONGEST]
    return _UNSEEN.sub("\N{REPLACEMENT CHARACTER}", " ".join(text.split()))


def plain(value: object) -> Any:
    """Return a scalar or array of no dimensions of NumPy as Python's, anything else as it is."""
    np = sys.modules.get("numpy")  # what is not loaded has made no scalar
    if np is None or not isinstance(value, np.generic | np.ndarray):
        return value
    if isinstance(value, np.ma.MaskedArray) or value.dtype.kind in "mMV" or value.ndim:
        return value  # dates are not numbers, nor is a masked entry
    return value.item()


def _is_number(value: object) -> bool:
    """Whether a plain value is a real number; a duration of NumPy would count as one."""
    if isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "m":
        return False
    return isinstance(value, Real | Decimal)


LARGEST_SCATTER = 1e120
"""What moments and fits can square."""


def check_scatter(y: FloatArray, smallest: float = 0.0) -> None:
    """Refuse responses, of which some are finite, that fits and moments cannot square.

    Raises
    ------
    ValueError
        If finite ones scatter by less than the smallest scatter, or by too much.
    """
    import numpy as np

    finite = y[np.isfinite(y)]
    least, most = float(finite.min(initial=np.inf)), float(finite.max(initial=-np.inf))
    if least < most and not smallest <= most - least <= LARGEST_SCATTER:
        raise ValueError(
            f"responses from {least:g} to {most:g} cannot be fitted, since a fit squares their "
            f"scatter ({smallest:g} to {LARGEST_SCATTER:g}): state them in another unit"
        )
