"""Quantiles that a library solves for one at a time, interpolated from a table instead."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from uqfold.inputs.marginal import Marginal
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

REACH = 6.0
"""Standard-normal values within which quantiles are tabulated: to probabilities of 1e-9."""
_NODES = 361
_ERROR = (1e-6, 1e-9)
"""Relative and absolute error of the probability below or above an interpolated quantile."""


def quantile_table(
    marginal: Marginal, exact: Callable[[FloatArray], FloatArray]
) -> CubicHermiteSpline | None:
    """Return quantiles as a monotone function of the standard-normal value, or None.

    Each node has the quantile and its slope, which follows from the density. Between all nodes the
    distribution function must lead back to the probability that was asked for; where it does not,
    there is no table.

    Parameters
    ----------
    marginal
        The distribution; only its density and probabilities are asked for.
    exact
        Its quantiles (n,) at standard-normal values (n,), asked for once at 361 nodes.

    References
    ----------
    Fritsch F. N., Carlson R. E. Monotone piecewise cubic interpolation. SIAM J. Numer. Anal. 17
    (1980) 238-246: slopes up to three times those of the secants keep a cubic monotone.
    """
    from scipy.interpolate import CubicHermiteSpline
    from scipy.special import ndtr

    u = np.linspace(-REACH, REACH, _NODES)
    x = exact(u)
    with np.errstate(all="ignore"):
        slope = np.exp(-0.5 * u**2 - marginal.log_pdf(x)) / np.sqrt(2.0 * np.pi)
        secant = np.diff(x) / np.diff(u)
        monotone = (slope[:-1] <= 3.0 * secant) & (slope[1:] <= 3.0 * secant) & (secant > 0.0)
    if not (monotone.all() and np.isfinite(x).all() and np.isfinite(slope).all()):
        return None
    table = CubicHermiteSpline(u, x, slope)
    between = 0.5 * (u[1:] + u[:-1])
    p, found = ndtr(-np.abs(between)), _tails(marginal, between, table(between))
    relative, absolute = _ERROR
    return table if (np.abs(found - p) <= relative * p + absolute).all() else None


def _tails(marginal: Marginal, u: FloatArray, x: FloatArray) -> FloatArray:
    """Return the probability on the smaller side of each quantile."""
    return np.where(u > 0.0, marginal.sf(x), marginal.cdf(x))
