"""Bring a distribution of any supported origin into OpenTURNS form.

OpenTURNS distributions pass unchanged. Those of scipy.stats of the common families, and chaospy's
normal, uniform and lognormal ones, become the OpenTURNS family with the same parameters, checked
against the original at a few points. Any other one-dimensional distribution is wrapped for
OpenTURNS' own use; `uqfold.inputs.laws` asks the original instead, all values at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from uqfold.checks import names as checked_names
from uqfold.checks import real, shown
from uqfold.inputs.counts import of_chaospy, of_scipy
from uqfold.inputs.engine import openturns
from uqfold.inputs.laws import closed_form
from uqfold.inputs.marginal import OpenTURNSMarginal
from uqfold.inputs.wrapped import scipy_name

_CHECK_LEVELS = (1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1.0 - 1e-6)
_CHECK_TOLERANCE = 1e-9


def as_openturns(distribution: Any) -> Any:
    """Convert `distribution` to an OpenTURNS distribution.

    Parameters
    ----------
    distribution
        An OpenTURNS distribution; a frozen scipy.stats distribution (univariate, or
        ``multivariate_normal``), or a random variable such as ``scipy.stats.Normal()``; a chaospy
        distribution with independent components; a mapping from names to univariate distributions,
        or a sequence of them (then independent).

    Returns
    -------
    openturns.Distribution

    Raises
    ------
    TypeError
        If the object is none of these.
    ValueError
        If its parameters make no distribution, a name occurs twice, or it is a
        chaospy distribution with dependent components.
    """
    ot = openturns()
    if isinstance(distribution, Mapping):
        given = checked_names("names of inputs", list(distribution))
        joint = _listed(list(distribution.values()), [f"input {name!r}" for name in given])
        joint.setDescription(given)
        return joint
    if isinstance(distribution, Sequence) and not isinstance(distribution, str | bytes):
        return _listed(
            distribution, [f"input {i + 1} of the list" for i in range(len(distribution))]
        )
    if isinstance(distribution, ot.PythonDistribution):
        return ot.Distribution(distribution)
    origin = type(distribution).__module__.split(".")[0]
    if origin == "openturns":
        return ot.Distribution(distribution)
    make = {"scipy": _from_scipy, "chaospy": _from_chaospy}.get(origin)
    if make is not None and not isinstance(distribution, type):
        with np.errstate(all="ignore"):  # what overflows is found below, and refused
            return make(distribution)
    raise TypeError(
        f"{shown(distribution)} is not a distribution: give an OpenTURNS, a frozen scipy.stats "
        "or a chaospy distribution, or a mapping from names to such"
    )


def _listed(distributions: Sequence[Any], names: Sequence[str]) -> Any:
    """Join univariate distributions; `names` is what messages call them."""
    ot = openturns()
    if not distributions:
        raise ValueError("an empty list of distributions: give at least one, or None")
    parts = []
    for given, name in zip(distributions, names, strict=True):
        try:
            part = as_openturns(given)
        except (TypeError, ValueError) as error:
            kind = TypeError if isinstance(error, TypeError) else ValueError
            raise kind(f"{name}: {error}") from None
        if part.getDimension() != 1:
            raise ValueError(
                f"{name}: a list must hold univariate distributions, but {part} has dimension "
                f"{part.getDimension()}: pass a joint distribution by itself"
            )
        parts.append(part)
    return ot.JointDistribution(parts)


def _from_scipy(frozen: Any) -> Any:
    ot = openturns()
    if type(frozen).__name__ == "multivariate_normal_frozen":
        covariance = ot.CovarianceMatrix(np.atleast_2d(frozen.cov).tolist())
        return ot.Normal(np.atleast_1d(frozen.mean).tolist(), covariance)
    from uqfold.inputs.scipy_variable import frozen_variable, is_discrete, is_variable

    if is_variable(frozen):
        wrapped = frozen_variable(frozen)
        if is_discrete(frozen):
            return of_scipy(frozen, f"scipy.stats.{frozen}")
        return _variable_family(ot, frozen) or _wrapped_scipy(ot, wrapped)
    if any(kind.__name__ == "multi_rv_frozen" for kind in type(frozen).__mro__):
        raise TypeError(
            f"{type(frozen).__name__} has several components: of SciPy's joint distributions only "
            "multivariate_normal is taken; state any other by an OpenTURNS copula"
        )
    if not hasattr(frozen, "dist") or not hasattr(frozen, "ppf"):
        kind = type(frozen).__name__.removesuffix("_gen")
        if hasattr(frozen, "xk"):  # rv_discrete(values=...), which has no parameters
            return of_scipy(frozen, "scipy.stats.rv_discrete")
        remedy = _SCIPY_REMEDIES.get(
            kind, "call it with its parameters, as in scipy.stats.norm(0, 1)"
        )
        raise TypeError(f"scipy.stats.{kind} is not a frozen distribution: {remedy}")
    shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
    if any(np.ndim(parameter) > 0 for parameter in (*shapes, loc, scale)):
        raise ValueError(
            f"scipy.stats.{frozen.dist.name} with arrays of parameters: give one distribution each"
        )
    called = f"scipy.stats.{frozen.dist.name}"
    for what, value in zip(
        ("loc", "scale", *_shape_names(frozen)), (loc, scale, *shapes), strict=True
    ):
        bounds: dict[str, Any] = {"above": 0.0} if what == "scale" else {}
        # a bound of a truncated distribution may be infinite
        real(f"{called}: {what}", value, finite=what in ("loc", "scale"), **bounds)
    if not np.all(frozen.dist._argcheck(*shapes)):
        raise ValueError(f"{scipy_name(frozen)}: the parameters make no distribution")
    if not hasattr(frozen.dist, "pdf"):
        return of_scipy(frozen, scipy_name(frozen))
    family = _SCIPY_FAMILIES.get(frozen.dist.name)
    if family is not None:
        try:
            candidate = family(ot, [float(s) for s in shapes], float(loc), float(scale))
        except (TypeError, OverflowError, ZeroDivisionError):  # beyond what OpenTURNS takes
            candidate = None
        if candidate is not None and _agrees(candidate, frozen.ppf, frozen.cdf):
            return candidate
    return _wrapped_scipy(ot, frozen)


def _variable_family(ot: Any, variable: Any) -> Any | None:
    """Return the OpenTURNS family of a random variable of SciPy's newer kind, or None."""
    kinds = [kind.__name__ for kind in type(variable).__mro__]
    make = next((_VARIABLE_FAMILIES[kind] for kind in kinds if kind in _VARIABLE_FAMILIES), None)
    if make is None:
        return None
    candidate = make(ot, variable)
    if closed_form(candidate) is None:
        return None
    return candidate if _agrees(candidate, variable.icdf, variable.cdf) else None


def _wrapped_scipy(ot: Any, frozen: Any) -> Any:
    try:
        return ot.Distribution(ot.SciPyDistribution(frozen))
    except (TypeError, ValueError, RuntimeError, ArithmeticError) as error:
        raise ValueError(
            f"{scipy_name(frozen)} cannot be used: SciPy or OpenTURNS fails on it ({error}); give "
            "another family, or openturns.KernelSmoothing().build(sample) of a large sample of it"
        ) from error


_SCIPY_REMEDIES = {
    "gaussian_kde": "give openturns.KernelSmoothing().build(sample)",
    "rv_histogram": "call it, as in scipy.stats.rv_histogram(histogram)()",
}
"""Class of what SciPy does not freeze with parameters -> what to do instead."""


def _shape_names(frozen: Any) -> list[str]:
    named = frozen.dist.shapes
    return [name.strip() for name in named.split(",")] if named else []


def _from_chaospy(distribution: Any) -> Any:
    ot = openturns()
    if len(distribution) > 1:
        if distribution.stochastic_dependent:
            raise ValueError(
                f"{distribution} has dependent components: state the dependence with an "
                "OpenTURNS copula instead"
            )
        return ot.JointDistribution([_from_chaospy(part) for part in distribution])
    if distribution.interpret_as_integer:
        return of_chaospy(distribution)
    try:
        quartiles = np.ravel(distribution.inv([0.25, 0.5, 0.75]))
    except AssertionError:  # how chaospy refuses parameters, once it is asked
        quartiles = np.full(3, np.nan)
    if not (np.isfinite(quartiles).all() and quartiles[0] < quartiles[1] < quartiles[2]):
        raise ValueError(f"chaospy's {distribution}: its parameters make no distribution")
    family = _CHAOSPY_FAMILIES.get(type(distribution).__name__)
    if family is not None:
        lower, median = (float(np.ravel(distribution.inv(q))[0]) for q in (0.25, 0.5))
        candidate = family(ot, lower, median)
        if candidate is not None and _agrees(candidate, distribution.inv, distribution.cdf):
            return candidate
    return ot.Distribution(ot.ChaospyDistribution(distribution))


def _agrees(candidate: Any, ppf: Callable[[float], Any], cdf: Callable[[float], Any]) -> bool:
    """Return whether the OpenTURNS candidate has the original's distribution function."""
    x = np.ravel([ppf(level) for level in _CHECK_LEVELS]).astype(np.float64)
    expected = np.ravel([cdf(at) for at in x])
    marginal = closed_form(candidate) or OpenTURNSMarginal(candidate)
    return bool((np.abs(marginal.cdf(x) - expected) <= _CHECK_TOLERANCE).all())


_QUARTILE = 0.6744897501960817  # of the standard normal distribution

# name -> (openturns module, lower quartile, median) -> distribution
_CHAOSPY_FAMILIES: dict[str, Callable[[Any, float, float], Any]] = {
    "Normal": lambda ot, lower, median: ot.Normal(median, (median - lower) / _QUARTILE),
    "Uniform": lambda ot, lower, median: ot.Uniform(2 * lower - median, 3 * median - 2 * lower),
    "LogNormal": lambda ot, lower, median: (
        ot.LogNormal(math.log(median), math.log(median / lower) / _QUARTILE) if lower > 0 else None
    ),
}

# name -> (openturns module, variable of SciPy's newer kind) -> distribution
_VARIABLE_FAMILIES: dict[str, Callable[[Any, Any], Any]] = {
    "Normal": lambda ot, own: ot.Normal(float(own.mu), float(own.sigma)),
    "Uniform": lambda ot, own: ot.Uniform(float(own.a), float(own.b)),
    # SciPy's own quantiles are not exact near the bounds
    "TruncatedDistribution": lambda ot, own: ot.TruncatedDistribution(
        as_openturns(own._dist), float(own.lb), float(own.ub)
    ),
    "ShiftedScaledDistribution": lambda ot, own: (
        float(own.scale) * ot.Distribution(as_openturns(own._dist)) + float(own.loc)
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
