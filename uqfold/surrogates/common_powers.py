"""What many inputs have in common, and a fit to each of them by itself leaves out.

Each of many inputs may be curved by so little that left-out runs do not show it, and all of them
together by much: the mean of a sum of a hundred squares moves by a hundred small amounts. A few
sums over all inputs, and powers along the steepest direction, are enough to see that.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from uqfold.surrogates.hermite import one_dimensional
from uqfold.typing import FloatArray

_HIGHEST = 5


def with_common_powers(
    mean: Callable[[FloatArray], FloatArray], u: FloatArray, y: FloatArray, residuals: FloatArray
) -> Callable[[FloatArray], FloatArray]:
    """Return a surface that also holds what all inputs have in common.

    Parameters
    ----------
    mean
        The surface: takes points (m, d), gives values (m,).
    u, y
        Points (n, d) and responses (n,) that it was fitted to.
    residuals
        Its residuals (n,) at runs left out.
    """
    spread = float(np.sqrt(np.mean(u**2))) or 1.0
    steepest = u.T @ (y - y.mean())
    length = float(np.linalg.norm(steepest))
    axis = steepest / length if length > 0.0 else steepest

    def powers(points: FloatArray) -> FloatArray:
        scaled = points / spread
        of_all = sum(one_dimensional(column, _HIGHEST) for column in scaled.T)
        along = one_dimensional(scaled @ axis, 3)[:, 2:]
        return np.hstack([np.asarray(of_all) / math.sqrt(u.shape[1]), along])

    share = np.linalg.lstsq(powers(u), residuals, rcond=None)[0]

    def surface(points: FloatArray) -> FloatArray:
        return np.asarray(mean(points) + powers(points) @ share)

    return surface
