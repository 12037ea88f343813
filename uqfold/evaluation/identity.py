"""What tells one model from another in a store: name, version, input names and parameters."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
from typing import Any

import numpy as np

from uqfold.problems.base import Problem

SCHEME = "uqfold-model/1"


def model_identity(problem: Problem) -> bytes | None:
    """Give the digest that identifies a problem's model to a store.

    It covers the problem's name and version, the names of the inputs in column order, and the
    parameters of a model that states them: the fields of a frozen dataclass, what
    `functools.partial` binds, the object of a bound method. What a plain function reads from
    elsewhere it cannot see: that is what the version is for.

    Returns
    -------
    bytes or None
        32 bytes, or None if the problem states no version.
    """
    if problem.version is None:
        return None
    content = [
        SCHEME,
        problem.name,
        problem.version,
        list(problem.inputs.names),
        _described(problem.model),
    ]
    return hashlib.blake2b(json.dumps(content).encode(), digest_size=32).digest()


def _described(value: Any) -> Any:
    """Give the parameters in a value as JSON, exact to the last bit."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, np.ndarray):
        data = np.ascontiguousarray(value)
        if data.dtype != np.dtype(object):
            digest = hashlib.blake2b(data.tobytes(), digest_size=16).hexdigest()
            return [data.dtype.str, list(data.shape), digest]
    if isinstance(value, list | tuple):
        return [_described(one) for one in value]
    if isinstance(value, dict):
        return [[_described(key), _described(one)] for key, one in value.items()]
    if isinstance(value, functools.partial):
        return [_described(part) for part in (value.func, value.args, value.keywords)]
    if _is_frozen_record(value):
        fields = (field.name for field in dataclasses.fields(value) if field.compare)
        return [[name, _described(getattr(value, name))] for name in fields]
    if hasattr(value, "__self__"):
        return _described(value.__self__)
    # a function or an object of unknown content
    return None


def _is_frozen_record(value: Any) -> bool:
    # what is not frozen may count its own calls, and would never be recognised again
    record = dataclasses.is_dataclass(value) and not isinstance(value, type)
    return record and bool(value.__dataclass_params__.frozen)
