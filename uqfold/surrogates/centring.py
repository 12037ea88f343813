"""The value that fits subtract first, so that a response of 1e6 +- 1 keeps its digits."""

from __future__ import annotations

import numpy as np

from uqfold.typing import FloatArray

SMALLEST_SCATTER, LARGEST_SCATTER = 1e-120, 1e120
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


def check_scatter(y: FloatArray, smallest: float = 0.0) -> None:
    """Refuse responses, of which some are finite, that fits and moments cannot square.

    Raises
    ------
    ValueError
        If finite ones scatter by less than the smallest scatter, or by too much.
    """
    finite = y[np.isfinite(y)]
    least, most = float(finite.min(initial=np.inf)), float(finite.max(initial=-np.inf))
    if least < most and not smallest <= most - least <= LARGEST_SCATTER:
        raise ValueError(
            f"responses from {least:g} to {most:g} cannot be fitted, since a fit squares their "
            f"scatter ({smallest:g} to {LARGEST_SCATTER:g}): state them in another unit"
        )
