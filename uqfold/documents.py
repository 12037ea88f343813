"""JSON documents that somebody hands in: read strictly, and refused by the place that is wrong."""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterable
from typing import Any, NoReturn

from pydantic import ValidationError

from uqfold.checks import shown

LARGEST = 2**256
"""Of whole numbers; a seed may have more than 64 bits."""


def parsed_json(text: str) -> Any:
    """Return what a text of strict JSON holds.

    Raises
    ------
    ValueError
        If it is not JSON (the words NaN and Infinity are none of it), is nested too deeply, or
        holds a number that is too large.
    """
    try:
        return json.loads(
            text, parse_constant=_refuse_constant, parse_float=_finite, parse_int=_whole
        )
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def said(error: ValueError, fields: Iterable[str] = ()) -> str:
    """Return what is wrong with a document, in one line: the first place that a form refuses.

    Parameters
    ----------
    error
        An error of pydantic, or any other, whose text is returned.
    fields
        Names among which a misspelt one is looked for.
    """
    if not isinstance(error, ValidationError):
        return str(error)
    # a misspelt field before the one that is missing instead
    unknown = ("extra_forbidden", "unexpected_keyword_argument")
    first, *_ = sorted(error.errors(), key=lambda one: one["type"] not in unknown)
    steps = first["loc"]
    where = "".join(f"[{one}]" if isinstance(one, int) else f".{one}" for one in steps).lstrip(".")
    if first["type"] in unknown:
        near = difflib.get_close_matches(str(steps[-1]), fields, n=1)
        hint = f": do you mean {near[0]!r}?" if near else ""
        return f"{where} is not a field here{hint}"
    if first["type"].startswith("missing"):
        return f"the field {where} is missing"
    return f"{where}: {first['msg']}, not {shown(first['input'])}"


def _finite(number: str) -> float:
    value = float(number)
    if math.isinf(value):
        raise ValueError(f"the number {number} is too large")
    return value


def _whole(number: str) -> int:
    value = int(number)
    if abs(value) > LARGEST:
        raise ValueError(f"the number {shown(value)} is too large")
    return value


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")
