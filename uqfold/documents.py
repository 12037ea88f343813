"""JSON documents that somebody hands in: read strictly, and refused by the place that is wrong."""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError

from uqfold.checks import shown

T = TypeVar("T")
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


def read_record(
    file: Path,
    take: Callable[[Mapping[str, Any]], T],
    schemas: Sequence[str],
    refusal: type[ValueError],
    command: str,
    fields: Iterable[str] = (),
) -> T:
    """Read a record: JSON that names its schema.

    Parameters
    ----------
    file
        Where it is.
    take
        Makes of the document what is returned; what it refuses is told as `said` tells it.
    schemas
        Those that are read, the present one first.
    refusal
        What is raised for a file that is no such record.
    command
        What writes such records.
    fields
        As for `said`.
    """
    present, *_ = schemas
    try:
        document = parsed_json(file.read_text(encoding="utf-8"))
        if not isinstance(document, dict):
            raise TypeError("it holds no JSON object")
        schema = document.get("schema")
        if schema not in schemas:
            remedy = ""
            if str(schema).startswith(present.rpartition("/")[0] + "/"):
                remedy = f", and it cannot be converted: run it again with `{command}`"
            raise ValueError(f"its schema is {schema!r}, not {present!r}{remedy}")
        return take(document)
    except (ValueError, TypeError) as error:
        what = said(error, fields) if isinstance(error, ValueError) else str(error)
        raise refusal(
            f"{file.name} is not a readable record: {what}. Such records are written by `{command}`"
        ) from error


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
    if first["type"] == "value_error":  # one of ours, which shows the value itself
        return f"{where}: {first['ctx']['error']}".removeprefix(": ")
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
