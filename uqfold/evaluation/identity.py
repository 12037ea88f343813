"""What tells one model from another in a store: name, version, input names and parameters."""

from __future__ import annotations

import hashlib
import json
import types

from uqfold.evaluation.description import captured, described, uncompiled
from uqfold.problems.base import Problem

SCHEME = "uqfold-model/3"
"""Changes with what is described and how, so that no entry of another way is ever found."""


def model_identity(problem: Problem) -> bytes | None:
    """Return the digest that identifies a problem's model to a store.

    It covers the problem's name and version, the names of the inputs in column order, and what the
    model holds. Which function it is, name and version of the problem say; what a function reads
    from elsewhere (global variables, files) nobody sees: that is what the version is for. Seen are
    its defaults and attributes, the variables that it captured, and the code of a lambda, of a
    function defined inside another or of one compiled from text; the fields of a frozen dataclass
    and what else it holds, what `functools.partial` or a bound method binds, and what a class made
    while the program runs has of its own.

    Returns
    -------
    bytes or None
        32 bytes, or None if the problem states no version.

    Raises
    ------
    UndescribedError
        If the model holds something whose content cannot be told.
    """
    if problem.version is None:
        return None
    model = problem.kinds.model
    function = uncompiled(model)
    content = [
        SCHEME,
        problem.name,
        problem.version,
        list(problem.inputs.names),
        ["function", *captured(function)]
        if isinstance(function, types.FunctionType)
        else described(model),
    ]
    return hashlib.blake2b(json.dumps(content).encode(), digest_size=32).digest()
