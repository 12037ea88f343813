"""The value that fits subtract first, so that a response of 1e6 +- 1 keeps its digits."""

from __future__ import annotations

from uqfold.typing import FloatArray


def centre_of(y: FloatArray) -> float:
    """Mean of the responses; exactly their value if they are all the same."""
    return float(y[0]) if float(y.min()) == float(y.max()) else float(y.mean())
