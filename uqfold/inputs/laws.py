"""Distributions that are asked directly instead of through OpenTURNS.

Three kinds: those of SciPy and chaospy that OpenTURNS only wraps, SciPy's own form of families
that OpenTURNS has too, and truncated distributions, computed from the tail in which they lie.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from uqfold.inputs.marginal import DirectMarginal, Law, OpenTURNSMarginal
from uqfold.inputs.moments import with_moments
from uqfold.inputs.python_side import python_object
from uqfold.typing import FloatArray

_MEAN_NODES, _MEAN_REACH, _MEAN_PANELS = 24, 8.0, 64


def wrapped(distribution: Any) -> DirectMarginal | None:
    """Return the direct form of a SciPy or chaospy distribution that OpenTURNS wraps, or None."""
    import openturns as ot

    behind = python_object(distribution)
    if isinstance(behind, ot.SciPyDistribution):
        frozen = behind._dist
        return DirectMarginal(
            distribution, frozen, scipy_name(frozen), partial(_moved_scipy, frozen)
        )
    if isinstance(behind, ot.ChaospyDistribution):
        original = behind._dist
        return DirectMarginal(
            distribution, ChaospyLaw(original), str(original), partial(with_moments, distribution)
        )
    return None


def replacement(distribution: Any) -> DirectMarginal | None:
    """Return our own form of an OpenTURNS distribution that fails its checks, or None."""
    own = distribution.getImplementation()
    family = own.getClassName() if hasattr(own, "getClassName") else ""
    law: Law | None
    if family == "TruncatedDistribution":
        law = _truncated(own)
    else:
        make = _SCIPY.get(family)
        law = make(own) if make is not None else None
    if law is None:
        return None
    return DirectMarginal(distribution, law, str(distribution), partial(_moved, own, law))


def scipy_name(frozen: Any) -> str:
    """Return a frozen SciPy distribution as one would write it."""
    given = [f"{value:.12g}" for value in frozen.args]
    given += [f"{name}={value:.12g}" for name, value in frozen.kwds.items()]
    return f"scipy.stats.{frozen.dist.name}({', '.join(given)})"


@dataclass(frozen=True)
class ChaospyLaw:
    """A one-dimensional chaospy distribution, asked as one of SciPy is.

    chaospy knows no survival function, so the upper tail ends at probabilities of 1e-16.
    """

    own: Any

    def ppf(self, q: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(self.own.inv(q))

    def isf(self, q: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(self.own.inv(1.0 - np.maximum(q, 2.0**-53)))

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(self.own.cdf(x))

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return 1.0 - self.cdf(x)

    def pdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(self.own.pdf(x))

    def logpdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.asarray(np.log(self.pdf(x)))

    def support(self) -> tuple[float, float]:
        """See `Law`; an infinite bound is not known to chaospy, which cuts it."""
        return float(np.ravel(self.own.lower)[0]), float(np.ravel(self.own.upper)[0])

    def mean(self) -> float:
        """See `Law`."""
        import chaospy

        return float(np.ravel(chaospy.E(self.own))[0])

    def std(self) -> float:
        """See `Law`."""
        import chaospy

        return float(np.ravel(chaospy.Std(self.own))[0])


@dataclass(frozen=True)
class TruncatedLaw:
    """A distribution between two bounds, all in the tail of the base where they lie.

    Attributes
    ----------
    base
        The distribution that is cut.
    low, high
        The bounds, either of which may be infinite.
    """

    base: Law
    low: float
    high: float

    @cached_property
    def _upper(self) -> bool:
        """Whether to count from above: where the lower bound lies in the upper half."""
        return float(self.base.cdf(np.array([self.low]))[0]) > 0.5

    @cached_property
    def _ends(self) -> tuple[float, float, float]:
        """Lower probability below, upper probability above the bounds, and the mass between."""
        low, high = np.array([self.low]), np.array([self.high])
        below, above = float(self.base.cdf(low)[0]), float(self.base.sf(high)[0])
        if self._upper:
            return below, above, float(self.base.sf(low)[0]) - above
        if above > 0.5:
            return below, above, float(self.base.cdf(high)[0]) - below
        return below, above, 1.0 - below - above

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        below, _, mass = self._ends
        if self._upper:
            found = float(self.base.sf(np.array([self.low]))[0]) - self.base.sf(x)
        else:
            found = self.base.cdf(x) - below
        return np.where(x >= self.high, 1.0, np.clip(found / mass, 0.0, 1.0))

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        _, above, mass = self._ends
        if above > 0.5:
            found = float(self.base.cdf(np.array([self.high]))[0]) - self.base.cdf(x)
        else:
            found = self.base.sf(x) - above
        return np.where(x <= self.low, 1.0, np.clip(found / mass, 0.0, 1.0))

    def ppf(self, q: FloatArray) -> FloatArray:
        """See `Law`."""
        return self._between(q, 1.0 - q)

    def isf(self, q: FloatArray) -> FloatArray:
        """See `Law`."""
        return self._between(1.0 - q, q)

    def _between(self, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Quantiles of lower and upper probabilities that add up to one."""
        below, above, mass = self._ends
        from_below, from_above = below + lower * mass, above + upper * mass
        in_lower = from_below < from_above
        x = np.empty(lower.shape)
        x[in_lower] = self.base.ppf(from_below[in_lower])
        x[~in_lower] = self.base.isf(from_above[~in_lower])
        return np.clip(x, self.low, self.high)

    def pdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.asarray(np.exp(self.logpdf(x)))

    def logpdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        inside = (x >= self.low) & (x <= self.high)
        return np.where(inside, self.base.logpdf(x) - math.log(self._ends[2]), -np.inf)

    def support(self) -> tuple[float, float]:
        """See `Law`."""
        return self.low, self.high

    def mean(self) -> float:
        """See `Law`."""
        return _moments_by_quantiles(self)[0]

    def std(self) -> float:
        """See `Law`."""
        return _moments_by_quantiles(self)[1]


@dataclass(frozen=True)
class _OpenTURNSLaw:
    """An OpenTURNS distribution, asked as one of SciPy is."""

    own: OpenTURNSMarginal

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        renamed = {"ppf": "quantile", "isf": "upper_quantile", "logpdf": "log_pdf"}
        return getattr(self.own, renamed.get(name, name))


def _truncated(own: Any) -> Law | None:
    bounds = own.getBounds()
    low = bounds.getLowerBound()[0] if bounds.getFiniteLowerBound()[0] else -math.inf
    high = bounds.getUpperBound()[0] if bounds.getFiniteUpperBound()[0] else math.inf
    base = own.getDistribution()
    family = base.getImplementation().getClassName()
    if family == "Normal":
        return _truncated_normal(base.getMean()[0], base.getStandardDeviation()[0], low, high)
    inner = _SCIPY.get(family)
    law = (
        _OpenTURNSLaw(OpenTURNSMarginal(base)) if inner is None else inner(base.getImplementation())
    )
    return TruncatedLaw(law, float(low), float(high))


def _truncated_normal(mean: float, std: float, low: float, high: float) -> Law:
    from scipy import stats

    law: Law = stats.truncnorm((low - mean) / std, (high - mean) / std, mean, std)
    return law


def _moments_by_quantiles(law: Any) -> tuple[float, float]:
    """Mean and standard deviation, integrated over the standard-normal variable."""
    edges = np.linspace(-_MEAN_REACH, _MEAN_REACH, _MEAN_PANELS + 1)
    x, w = np.polynomial.legendre.leggauss(_MEAN_NODES)
    half = 0.5 * np.diff(edges)[:, None]
    u = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * x).ravel()
    p = (half * w).ravel() * np.exp(-0.5 * u * u)
    p /= p.sum()
    from scipy.special import ndtr

    values = np.where(u <= 0.0, law.ppf(ndtr(u)), law.isf(ndtr(-u)))
    centre = float(np.median(values))
    mean = float(p @ (values - centre))
    return centre + mean, math.sqrt(float(p @ (values - centre - mean) ** 2))


def _moved_scipy(frozen: Any, mean: float, std: float) -> Any:
    """Return a SciPy distribution shifted and stretched, in OpenTURNS form."""
    import openturns as ot

    shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
    ratio = std / float(frozen.std())
    moved = frozen.dist(
        *shapes, loc=(loc - float(frozen.mean())) * ratio + mean, scale=scale * ratio
    )
    return ot.Distribution(ot.SciPyDistribution(moved))


def _moved(own: Any, law: Law, mean: float, std: float) -> Any:
    """Return an OpenTURNS distribution that was replaced, shifted and stretched."""
    import openturns as ot

    own_mean, ratio = float(law.mean()), std / float(law.std())
    if own.getClassName() == "TruncatedNormal":
        low, high = ((bound - own_mean) * ratio + mean for bound in (own.getA(), own.getB()))
        return ot.Distribution(
            ot.TruncatedNormal(
                (own.getMu() - own_mean) * ratio + mean, own.getSigma() * ratio, low, high
            )
        )
    return (ot.Distribution(own) - own_mean) * ratio + mean


def _scipy(name: str, shapes: tuple[float, ...], loc: float, scale: float) -> Law:
    from scipy import stats

    law: Law = getattr(stats, name)(*shapes, loc=loc, scale=scale)
    return law


_SCIPY: dict[str, Callable[[Any], Law]] = {
    "Normal": lambda d: _scipy("norm", (), d.getMean()[0], d.getStandardDeviation()[0]),
    "Uniform": lambda d: _scipy("uniform", (), d.getA(), d.getB() - d.getA()),
    "Exponential": lambda d: _scipy("expon", (), d.getGamma(), 1.0 / d.getLambda()),
    "Gamma": lambda d: _scipy("gamma", (d.getK(),), d.getGamma(), 1.0 / d.getLambda()),
    "Beta": lambda d: _scipy("beta", (d.getAlpha(), d.getBeta()), d.getA(), d.getB() - d.getA()),
    "LogNormal": lambda d: _scipy(
        "lognorm", (d.getSigmaLog(),), d.getGamma(), math.exp(d.getMuLog())
    ),
    "WeibullMin": lambda d: _scipy("weibull_min", (d.getAlpha(),), d.getGamma(), d.getBeta()),
    "Gumbel": lambda d: _scipy("gumbel_r", (), d.getGamma(), d.getBeta()),
    "GeneralizedExtremeValue": lambda d: _scipy(
        "genextreme", (-d.getXi(),), d.getMu(), d.getSigma()
    ),
    "Logistic": lambda d: _scipy("logistic", (), d.getMu(), d.getBeta()),
    "Student": lambda d: _scipy("t", (d.getNu(),), d.getMean()[0], d.getSigma()[0]),
    "Pareto": lambda d: _scipy("pareto", (d.getAlpha(),), d.getGamma(), d.getBeta()),
    "Rayleigh": lambda d: _scipy("rayleigh", (), d.getGamma(), d.getBeta()),
    "TruncatedNormal": lambda d: _truncated_normal(d.getMu(), d.getSigma(), d.getA(), d.getB()),
}
"""OpenTURNS family -> the same distribution by SciPy."""
