"""Bring a distribution of any supported origin into OpenTURNS form.

OpenTURNS distributions pass unchanged. Frozen scipy.stats distributions of the common families, and
chaospy's normal, uniform and lognormal ones, become the OpenTURNS family with the same parameters,
checked against the original at a few points. Any other one-dimensional distribution is wrapped,
which is slow because each value is a Python call, and resolves the upper tail only down to
probabilities of 1e-16.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

_CHECK_LEVELS = (1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1.0 - 1e-6)
_CHECK_TOLERANCE = 1e-9


def as_openturns(distribution: Any) -> Any:
    """Convert `distribution` to an OpenTURNS distribution.

    Parameters
    ----------
    distribution
        An OpenTURNS distribution; a frozen scipy.stats distribution (univariate continuous, or
        ``multivariate_normal``); a chaospy distribution with independent components; a mapping
        from names to univariate distributions, or a sequence of them (then independent).

    Returns
    -------
    openturns.Distribution

    Raises
    ------
    TypeError
        If the object is none of these.
    ValueError
        If it is discrete, or a chaospy distribution with dependent components.
    """
    import openturns as ot

    if isinstance(distribution, Mapping):
        joint = as_openturns(list(distribution.values()))
        joint.setDescription([str(name) for name in distribution])
        return joint
    if isinstance(distribution, Sequence) and not isinstance(distribution, str):
        if not distribution:
            raise ValueError("an empty list of distributions: give at least one, or None")
        parts = [as_openturns(part) for part in distribution]
        wide = [part for part in parts if part.getDimension() != 1]
        if wide:
            raise ValueError(
                f"a list must hold univariate distributions, but {wide[0]} has dimension "
                f"{wide[0].getDimension()}: pass a joint distribution by itself"
            )
        return ot.JointDistribution(parts)
    origin = type(distribution).__module__.split(".")[0]
    if origin == "openturns":
        return _continuous(ot.Distribution(distribution))
    if origin == "scipy":
        return _continuous(_from_scipy(distribution))
    if origin == "chaospy":
        return _continuous(_from_chaospy(distribution))
    raise TypeError(
        f"{distribution!r} is not a distribution: give an OpenTURNS, a frozen scipy.stats or a "
        "chaospy distribution, or a mapping from names to such"
    )


def _continuous(distribution: Any) -> Any:
    if not distribution.isContinuous():
        raise ValueError(f"{distribution} is not continuous: discrete inputs are not supported")
    return distribution


def _from_scipy(frozen: Any) -> Any:
    import openturns as ot

    if type(frozen).__name__ == "multivariate_normal_frozen":
        covariance = ot.CovarianceMatrix(np.atleast_2d(frozen.cov).tolist())
        return ot.Normal(np.atleast_1d(frozen.mean).tolist(), covariance)
    if not hasattr(frozen, "dist") or not hasattr(frozen, "ppf"):
        raise TypeError(
            f"{frozen!r} is not a frozen scipy.stats distribution: call it with its parameters, "
            "as in scipy.stats.norm(0, 1)"
        )
    if not hasattr(frozen.dist, "pdf"):
        raise ValueError(f"scipy.stats.{frozen.dist.name} is discrete: not supported")
    shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
    if any(np.ndim(parameter) > 0 for parameter in (*shapes, loc, scale)):
        raise ValueError(
            f"scipy.stats.{frozen.dist.name} with arrays of parameters: give one distribution each"
        )
    family = _SCIPY_FAMILIES.get(frozen.dist.name)
    if family is not None:
        candidate = family(ot, [float(s) for s in shapes], float(loc), float(scale))
        if _agrees(candidate, frozen.ppf, frozen.cdf):
            return candidate
    return ot.Distribution(ot.SciPyDistribution(frozen))


def _from_chaospy(distribution: Any) -> Any:
    import openturns as ot

    if len(distribution) > 1:
        if distribution.stochastic_dependent:
            raise ValueError(
                f"{distribution} has dependent components: state the dependence with an "
                "OpenTURNS copula instead"
            )
        return ot.JointDistribution([_from_chaospy(part) for part in distribution])
    if distribution.interpret_as_integer:
        raise ValueError(f"{distribution} is discrete: not supported")
    family = _CHAOSPY_FAMILIES.get(type(distribution).__name__)
    if family is not None:
        lower, median = (float(np.ravel(distribution.inv(q))[0]) for q in (0.25, 0.5))
        candidate = family(ot, lower, median)
        if candidate is not None and _agrees(candidate, distribution.inv, distribution.cdf):
            return candidate
    return ot.Distribution(ot.ChaospyDistribution(distribution))


def _agrees(candidate: Any, ppf: Callable[[float], Any], cdf: Callable[[float], Any]) -> bool:
    """Whether the OpenTURNS candidate has the original's distribution function."""
    for level in _CHECK_LEVELS:
        x = float(np.ravel(ppf(level))[0])
        expected = float(np.ravel(cdf(x))[0])
        if not math.isclose(candidate.computeCDF(x), expected, abs_tol=_CHECK_TOLERANCE):
            return False
    return True


_QUARTILE = 0.6744897501960817  # of the standard normal distribution

# name -> (openturns module, lower quartile, median) -> distribution
_CHAOSPY_FAMILIES: dict[str, Callable[[Any, float, float], Any]] = {
    "Normal": lambda ot, lower, median: ot.Normal(median, (median - lower) / _QUARTILE),
    "Uniform": lambda ot, lower, median: ot.Uniform(2 * lower - median, 3 * median - 2 * lower),
    "LogNormal": lambda ot, lower, median: (
        ot.LogNormal(math.log(median), math.log(median / lower) / _QUARTILE) if lower > 0 else None
    ),
}

# name -> (openturns module, shape parameters, loc, scale) -> distribution
_SCIPY_FAMILIES: dict[str, Callable[[Any, list[float], float, float], Any]] = {
    "norm": lambda ot, _, loc, scale: ot.Normal(loc, scale),
    "uniform": lambda ot, _, loc, scale: ot.Uniform(loc, loc + scale),
    "expon": lambda ot, _, loc, scale: ot.Exponential(1.0 / scale, loc),
    "gamma": lambda ot, s, loc, scale: ot.Gamma(s[0], 1.0 / scale, loc),
    "beta": lambda ot, s, loc, scale: ot.Beta(s[0], s[1], loc, loc + scale),
    "lognorm": lambda ot, s, loc, scale: ot.LogNormal(math.log(scale), s[0], loc),
    "weibull_min": lambda ot, s, loc, scale: ot.WeibullMin(scale, s[0], loc),
    "gumbel_r": lambda ot, _, loc, scale: ot.Gumbel(scale, loc),
    "logistic": lambda ot, _, loc, scale: ot.Logistic(loc, scale),
    "t": lambda ot, s, loc, scale: ot.Student(s[0], loc, scale),
    "truncnorm": lambda ot, s, loc, scale: ot.TruncatedNormal(
        loc, scale, loc + s[0] * scale, loc + s[1] * scale
    ),
    "triang": lambda ot, s, loc, scale: ot.Triangular(loc, loc + s[0] * scale, loc + scale),
}
