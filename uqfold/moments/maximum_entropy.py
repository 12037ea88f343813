"""The distribution of largest entropy with given moments.

Among all densities of the standardised response z on [-12, 12] whose moments of order 1 to n are
the given ones, the entropy is largest for the exponential of a polynomial of degree n,

    f(z) = phi(z) exp(c_0 + c_1 p_1(z) + ... + c_n p_n(z)),

written here beside the normal density phi with the Hermite polynomials p_k = He_k / sqrt(k!) that
are orthonormal under it. The coefficients minimise the convex function

    log int phi exp(sum c_k p_k) dz - sum c_k m_k,      m_k = E p_k(Z) as given,

whose gradient is how far the moments are off and whose Hessian is the covariance of the p_k:
Newton's method with halved steps. All integrals are sums over one composite Gauss rule.

On the whole line there is no such density where the last coefficient is positive, kurtosis > 3
with four moments for instance: on an interval the density then rises towards an end. Such a
density is refused.

References
----------
Jaynes E.T. Information theory and statistical mechanics. Physical Review 106 (1957) 620-630.
Mead L.R., Papanicolaou N. Maximum entropy in the problem of moments. Journal of Mathematical
Physics 25 (1984) 2404-2417.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.cumulants import ResponseMoments
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.typing import FloatArray

_REACH, _PANELS, _NODES = 12.0, 96, 8
_MOST_STEPS, _MOST_HALVINGS = 60, 30
_SOLVED = 1e-9
_OUTSIDE = 4.0
"""From here on outwards the density has to fall."""
_DEEPEST = 1e-60
"""Smallest tail of the table; a straight line continues the normal scores."""


def maximum_entropy(moments: ResponseMoments) -> TabulatedDistribution | AtomicDistribution | None:
    """Return the distribution of largest entropy with six moments, or else with four, or None."""
    if moments.std == 0.0:
        return AtomicDistribution((moments.mean,))
    raw = (0.0, 1.0, moments.skewness, moments.kurtosis, moments.fifth, moments.sixth)
    for order in (6, 4):
        log_density = _log_density(raw[:order])
        if log_density is not None:
            return _table(moments.mean, moments.std, log_density)
    return None


@cache
def _rule() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (n,), their weights and the orthonormal Hermite polynomials (7, n) there."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = _REACH / _PANELS
    middles = np.linspace(-_REACH + half, _REACH - half, _PANELS)
    z = (middles[:, None] + half * nodes).ravel()
    hermite = np.ones((7, z.size))
    hermite[1] = z
    for k in range(1, 6):
        hermite[k + 1] = (z * hermite[k] - math.sqrt(k) * hermite[k - 1]) / math.sqrt(k + 1.0)
    return z, np.tile(half * weights, _PANELS), hermite


# a step that is much too long leads to no number, and is halved
@np.errstate(over="ignore", invalid="ignore")
def _log_density(raw: tuple[float, ...]) -> FloatArray | None:
    """Return the logarithm of the density at the points, or None where there is none that falls."""
    z, weights, hermite = _rule()
    one, two, three, four, *more = raw
    wanted = [one, (two - 1.0) / math.sqrt(2.0), (three - 3.0 * one) / math.sqrt(6.0)]
    wanted.append((four - 6.0 * two + 3.0) / math.sqrt(24.0))
    if more:
        wanted.append((more[0] - 10.0 * three + 15.0 * one) / math.sqrt(120.0))
        wanted.append((more[1] - 15.0 * four + 45.0 * two - 15.0) / math.sqrt(720.0))
    target, basis = np.array(wanted), hermite[1 : 1 + len(wanted)]
    found = np.zeros(target.size)
    value, density = _dual(found, basis, target)
    for _ in range(_MOST_STEPS):
        share = weights * density
        means = basis @ share
        error = means - target
        if np.abs(error).max() < _SOLVED:
            outside = np.abs(z) > _OUTSIDE
            outwards = np.diff(np.log(np.maximum(density, 1e-300))) * np.sign(z[1:])
            falls = outwards[outside[1:] & outside[:-1]].max() <= 0.0
            return np.asarray(density) if falls else None
        centred = basis - means[:, None]
        try:
            step = np.linalg.solve((centred * share) @ centred.T, error)
        except np.linalg.LinAlgError:
            return None
        for halving in range(_MOST_HALVINGS):
            tried = found - 0.5**halving * step
            new, tried_density = _dual(tried, basis, target)
            if new <= value - 1e-4 * 0.5**halving * float(error @ step):
                break
        else:
            return None
        found, value, density = tried, new, tried_density
    return None


def _dual(found: FloatArray, basis: FloatArray, target: FloatArray) -> tuple[float, FloatArray]:
    """Return the function to be minimised, and the density at the points."""
    z, weights, _ = _rule()
    exponent = found @ basis - 0.5 * z**2
    highest = float(exponent.max())
    density = np.exp(exponent - highest)
    mass = float(weights @ density)
    return highest + math.log(mass) - float(found @ target), density / mass


def _table(mean: float, std: float, density: FloatArray) -> TabulatedDistribution | None:
    """Return the distribution from its density at the points."""
    from scipy.special import ndtri

    masses = (_rule()[1] * density).reshape(_PANELS, _NODES).sum(axis=1)
    below, above = np.cumsum(masses), np.cumsum(masses[::-1])[::-1]
    cdf, sf = below[:-1], above[1:]
    scores = np.where(cdf < sf, ndtri(cdf), -ndtri(sf))
    used = np.minimum(cdf, sf) > _DEEPEST
    levels = mean + std * np.linspace(-_REACH, _REACH, _PANELS + 1)[1:-1][used]
    scores = scores[used]
    if scores.size < 2 or not (np.diff(scores) > 0.0).all():
        return None
    return TabulatedDistribution(levels, scores)
