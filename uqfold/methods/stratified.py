"""Points that lie evenly along every input: few of them meet what is narrow along one alone."""

from __future__ import annotations

import numpy as np

from uqfold.typing import FloatArray

WIDER = 2.0
"""So many times denser than points, at the median, is the normal law that they stand for."""


def stratified_points(
    number: int, dimension: int, seed: int, wider: float = WIDER
) -> tuple[FloatArray, FloatArray]:
    """Return a Latin hypercube of normal points, by default wider than the standard-normal law.

    Along each input every one of `number` shares of a wider normal law holds one point, so that a
    ridge, slab or step of one input is met wherever it matters. Same seed, same points.

    McKay M.D., Beckman R.J., Conover W.J. A comparison of three methods for selecting values of
    input variables in the analysis of output from a computer code. Technometrics 21 (1979) 239-245.

    Returns
    -------
    points, weights : arrays (n, d), (n,)
        Means of weights times values are expectations under the standard-normal law.
    """
    from scipy.special import ndtri

    if dimension == 0:
        return np.empty((number, 0)), np.ones(number)
    rng = np.random.default_rng(seed)
    shares = np.stack([rng.permutation(number) for _ in range(dimension)], axis=1)
    spread = wider ** (1.0 / dimension)
    points = spread * ndtri((shares + rng.uniform(0.01, 0.99, shares.shape)) / number)
    weights = wider * np.exp(-0.5 * (1.0 - spread**-2) * (points**2).sum(axis=1))
    return np.asarray(points), np.asarray(weights)
