"""Checking a document against one of the schemas that ship with the package."""

from __future__ import annotations

import difflib
import json
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any


def check_document(document: Any, schema: str) -> None:
    """Check parsed JSON or TOML against a schema.

    Parameters
    ----------
    document
        What was parsed.
    schema
        Stem of a file in ``uqfold/evidence/schemas``.

    Raises
    ------
    ValueError
        If it does not follow the schema; the message names the place and what is wrong there.
    """
    from jsonschema.exceptions import best_match

    error = best_match(_validator(schema).iter_errors(document))
    if error is not None:
        where = "".join(
            f"[{step}]" if isinstance(step, int) else f".{step}" for step in error.absolute_path
        ).lstrip(".")
        raise ValueError(f"{where}: {_said(error)}" if where else _said(error))


@cache
def _validator(schema: str) -> Any:
    from jsonschema import Draft202012Validator

    path = resources.files("uqfold.evidence") / "schemas" / f"{schema}.schema.json"
    return Draft202012Validator(json.loads(path.read_text(encoding="utf-8")))


def _said(error: Any) -> str:
    """Say what is wrong in words; jsonschema's own message where there are none better."""
    rule, value, found = error.validator, error.validator_value, error.instance
    if rule == "additionalProperties" and isinstance(found, Mapping):
        known = list(error.schema["properties"])
        word = next(name for name in found if name not in known)
        near = difflib.get_close_matches(str(word), known, n=1)
        return f"{word!r} is no field here" + (f": do you mean {near[0]!r}?" if near else "")
    if rule == "required":
        missing = [name for name in value if name not in found]
        return f"the field {missing[0]!r} is missing"
    if rule == "enum":
        near = difflib.get_close_matches(str(found), [str(word) for word in value], n=1)
        choices = ", ".join(map(str, value))
        return f"{found!r} is none of: {choices}" + (f"; do you mean {near[0]!r}?" if near else "")
    if rule == "minLength":
        return "it is empty"
    return str(error.message)
