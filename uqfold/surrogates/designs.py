"""Space-filling designs in standard-normal space that reach into the tails.

Failure at 1e-6 happens about five standard deviations from the origin. A design of ordinary
standard-normal points would leave a surface to extrapolate there, so the points are spread wider
than the inputs themselves.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.checks import real
from uqfold.typing import FloatArray

DEFAULT_SPREAD = 1.7
"""Standard deviation of the design points, in standard deviations of the inputs."""
MAX_COORDINATE = 6.0
"""No coordinate lies further out: models seldom mean anything there."""


def checked_spread(name: str, spread: float) -> float:
    """Return a spread that a design can have: it reaches at least as far as the inputs do.

    Raises
    ------
    ValueError, TypeError
        If it is out of range.
    """
    return real(name, spread, at_least=1.0, at_most=MAX_COORDINATE)


def space_filling_design(
    size: int, dimension: int, rng: np.random.Generator, spread: float = DEFAULT_SPREAD
) -> FloatArray:
    """Return a scrambled Sobol' sequence as normal points of a wider spread, the origin first.

    Parameters
    ----------
    size
        Number of points n >= 1.
    dimension
        Number of variables d.
    rng
        Source of the scrambling.
    spread
        Standard deviation of the points.

    Returns
    -------
    FloatArray
        Points (n, d) in standard-normal space.

    Raises
    ------
    ValueError
        If the size, the dimension or the spread is out of range.
    """
    if size < 1 or dimension < 1:
        raise ValueError(f"{size} points in {dimension} variables: need at least one of each")
    checked_spread("spread", spread)
    from scipy.special import ndtri
    from scipy.stats import qmc

    sobol = qmc.Sobol(dimension, rng=rng)
    # whole powers of two keep the balance of the sequence (and its author from complaining)
    cube = sobol.random_base2(max(1, math.ceil(math.log2(size))))[: size - 1]
    points = spread * ndtri(np.clip(cube, 1e-9, 1.0 - 1e-9))
    points = np.clip(points, -MAX_COORDINATE, MAX_COORDINATE)
    return np.vstack([np.zeros((1, dimension)), points])
