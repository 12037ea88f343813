"""A marginal distribution with another mean and standard deviation.

A family whose shape follows from mean and standard deviation (normal, lognormal, gamma, Weibull,
beta) is kept, with its bounds. Any other marginal is shifted and stretched, bounds included.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from uqfold.inputs.behind import family_of
from uqfold.inputs.engine import openturns

_ROUNDING = 1e-9


def with_moments(marginal: Any, mean: float, std: float) -> Any:
    """Return a marginal of the same kind with another mean and standard deviation.

    Parameters
    ----------
    marginal
        Continuous univariate OpenTURNS distribution with a finite mean and standard deviation.
    mean, std
        Those of the result, in the unit of the input.

    Returns
    -------
    openturns.Distribution

    Raises
    ------
    ValueError
        If the values are not finite, `std` is not positive, the marginal has no finite moments,
        or its family cannot have these.
    """
    checked_moments(mean, std)
    own_mean, own_std = finite_moments(marginal)
    own, family = family_of(marginal)
    make = _FAMILIES.get(family)
    if make is not None:
        try:
            made = make(own, mean, std)
        except TypeError as error:  # what OpenTURNS raises for parameters out of range
            raise ValueError(
                f"{marginal} cannot have mean {mean:g} and standard deviation {std:g}"
            ) from error
        if np.allclose(finite_moments(made), (mean, std), rtol=_ROUNDING, atol=_ROUNDING * std):
            return made
    return (marginal - own_mean) * (std / own_std) + mean


def checked_moments(mean: float, std: float) -> None:
    """Check a mean and a standard deviation.

    Raises
    ------
    ValueError
        If they are not finite, or the latter is not positive.
    """
    if not (math.isfinite(mean) and math.isfinite(std) and std > 0.0):
        raise ValueError(f"mean {mean}, standard deviation {std}: must be finite, the latter > 0")


def finite_moments(marginal: Any) -> tuple[float, float]:
    """Return mean and standard deviation of a marginal.

    Raises
    ------
    ValueError
        If they do not exist, or are not finite.
    """
    try:
        mean, std = float(marginal.getMean()[0]), float(marginal.getStandardDeviation()[0])
    except RuntimeError:  # OpenTURNS: moments are not defined
        mean = std = math.nan
    if not (math.isfinite(mean) and math.isfinite(std)):
        raise ValueError(f"{marginal} has no finite mean and standard deviation")
    return mean, std


def _normal(_: Any, mean: float, std: float) -> Any:
    ot = openturns()
    return ot.Normal(mean, std)


def _lognormal(own: Any, mean: float, std: float) -> Any:
    ot = openturns()
    return ot.LogNormalMuSigma(mean, std, own.getGamma()).getDistribution()


def _gamma(own: Any, mean: float, std: float) -> Any:
    ot = openturns()
    return ot.GammaMuSigma(mean, std, own.getGamma()).getDistribution()


def _weibull(own: Any, mean: float, std: float) -> Any:
    ot = openturns()
    return ot.WeibullMinMuSigma(mean, std, own.getGamma()).getDistribution()


def _beta(own: Any, mean: float, std: float) -> Any:
    ot = openturns()
    return ot.BetaMuSigma(mean, std, own.getA(), own.getB()).getDistribution()


_FAMILIES: dict[str, Callable[[Any, float, float], Any]] = {
    "Normal": _normal,
    "LogNormal": _lognormal,
    "Gamma": _gamma,
    "WeibullMin": _weibull,
    "Beta": _beta,
}
