"""The value that fits subtract first, so that a response of 1e6 +- 1 keeps its digits."""

from __future__ import annotations

from uqfold.checks import check_scatter
from uqfold.typing import FloatArray

SMALLEST_SCATTER = 1e-120
"""What fits can square, and its rounding errors too."""


def centre_of(y: FloatArray) -> float:
    """Mean of the responses; exactly their value if they are all the same.

    Raises
    ------
    ValueError
        If the responses scatter by so little or so much that squares are not finite any more.
    """
    least, most = float(y.min()), float(y.max())
    if least == most:
        return least
    check_scatter(y, SMALLEST_SCATTER)
    return float(y.mean())
