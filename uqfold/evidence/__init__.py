"""The former name of `uqfold.validation`, understood for one release."""

from typing import Any

from uqfold.lazy import former


def __getattr__(name: str) -> Any:
    return former(__name__, name)
