"""Distributions of SciPy and chaospy that OpenTURNS only wraps, asked directly.

All rows are computed at once. The upper half goes through the survival function, so that a tail
keeps its digits. Where SciPy has no quantile function and would solve for every row, the quantiles
come from a table.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from uqfold.inputs.behind import python_object
from uqfold.inputs.engine import openturns
from uqfold.inputs.marginal import Marginal, beyond
from uqfold.inputs.moments import checked_moments, with_moments
from uqfold.inputs.quantile_table import REACH, quantile_table
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

_LAST = 2.0**-53
"""Where a library forms 1 - p, its upper tail ends here."""


class Law(Protocol):
    """What a frozen SciPy distribution offers, and what stands in for one."""

    def ppf(self, q: FloatArray) -> Any:
        """Return quantiles of lower probabilities q."""

    def isf(self, q: FloatArray) -> Any:
        """Return quantiles of upper probabilities q."""

    def cdf(self, x: FloatArray) -> Any:
        """Return lower probabilities."""

    def sf(self, x: FloatArray) -> Any:
        """Return upper probabilities."""

    def logpdf(self, x: FloatArray) -> Any:
        """Return the logarithm of the density."""

    def support(self) -> tuple[float, float]:
        """Return the bounds."""

    def mean(self) -> Any:
        """Return the mean, as the wrapped distribution states it."""

    def std(self) -> Any:
        """Return the standard deviation."""


@dataclass(frozen=True, eq=False)
class WrappedMarginal(Marginal):
    """A distribution of another library.

    Attributes
    ----------
    law
        The distribution itself.
    name
        What reports call it.
    moved
        (mean, std) -> the same kind with these moments, in OpenTURNS form.
    solved
        Whether the library solves for quantiles one by one, which takes about a millisecond each.
    """

    law: Law
    name: str
    moved: Callable[[float, float], Any]
    solved: bool = False

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        if self._table is None:
            return self._exact(u)
        far = np.abs(u) > REACH
        x = np.asarray(np.clip(self._table(u), *self.bounds))
        x[far] = self._exact(u[far])
        return x

    @cached_property
    def _table(self) -> CubicHermiteSpline | None:
        return quantile_table(self, self._exact) if self.solved else None

    def _exact(self, u: FloatArray) -> FloatArray:
        """Quantiles (n,) at standard-normal values u, as the library computes them."""
        from scipy.special import ndtr

        x = np.empty(u.shape)
        below = u <= 0.0
        x[below] = _quantiles(self.law.ppf, ndtr(u[below]))
        x[~below] = _quantiles(self.law.isf, ndtr(-u[~below]))
        return np.clip(x, *self.bounds)  # rounding may lead past a bound

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        from scipy.special import ndtri

        below, above = self.cdf(x), self.sf(x)
        u = np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))
        return beyond(self.bounds, x, u)

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return _values(self.law.cdf, x)

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return _values(self.law.sf, x)

    def log_pdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return _values(self.law.logpdf, x)

    @cached_property
    def bounds(self) -> tuple[float, float]:
        """See `Marginal`."""
        low, high = self.law.support()
        return float(low), float(high)

    @cached_property
    def moments(self) -> tuple[float, float]:
        """See `Marginal`."""
        with np.errstate(all="ignore"):
            mean, std = float(self.law.mean()), float(self.law.std())
        if not (math.isfinite(mean) and math.isfinite(std)):
            raise ValueError(f"{self} has no finite mean and standard deviation")
        return mean, std

    def with_moments(self, mean: float, std: float) -> Any:
        """See `Marginal`."""
        checked_moments(mean, std)
        return self.moved(mean, std)

    def __str__(self) -> str:
        return self.name


def wrapped(distribution: Any) -> WrappedMarginal | None:
    """Return the direct form of a SciPy or chaospy distribution that OpenTURNS wraps, or None."""
    ot = openturns()
    behind = python_object(distribution)
    if isinstance(behind, ot.SciPyDistribution):
        frozen = behind._dist
        return WrappedMarginal(
            distribution,
            _on_a_line(frozen),
            scipy_name(frozen),
            partial(_moved_scipy, frozen),
            solved=_without_quantiles(frozen),
        )
    if isinstance(behind, ot.ChaospyDistribution):
        original = behind._dist
        return WrappedMarginal(
            distribution, ChaospyLaw(original), str(original), partial(with_moments, distribution)
        )
    return None


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
        return np.ravel(self.own.inv(1.0 - np.maximum(q, _LAST)))

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(self.own.cdf(x))

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return 1.0 - self.cdf(x)

    def logpdf(self, x: FloatArray) -> FloatArray:
        """See `Law`."""
        return np.ravel(np.log(self.own.pdf(x)))

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


def scipy_name(frozen: Any) -> str:
    """Return a frozen SciPy distribution as one would write it."""
    given = [f"{value:.12g}" for value in frozen.args]
    given += [f"{name}={value:.12g}" for name, value in frozen.kwds.items()]
    if frozen.dist.name.endswith(")"):  # it is no family, and has its numbers in its name
        return " + ".join([frozen.dist.name, *given])
    return f"scipy.stats.{frozen.dist.name}({', '.join(given)})"


def _on_a_line(frozen: Any) -> Any:
    """Return a frozen SciPy distribution, a circular one between its ends.

    SciPy's own counts the turns: its distribution function goes beyond zero and one.
    """
    from scipy.stats import vonmises_line

    if frozen.dist.name == "vonmises":
        return vonmises_line(*frozen.args, **frozen.kwds)
    return frozen


def _without_quantiles(frozen: Any) -> bool:
    """Return whether a frozen SciPy distribution has no quantile function of its own."""
    from scipy.stats import rv_continuous

    own = type(frozen.dist)._ppf is not rv_continuous._ppf
    return not own or getattr(frozen.dist, "solved", False)


def _moved_scipy(frozen: Any, mean: float, std: float) -> Any:
    """Return a SciPy distribution shifted and stretched, in OpenTURNS form."""
    ot = openturns()
    shapes, loc, scale = frozen.dist._parse_args(*frozen.args, **frozen.kwds)
    ratio = std / float(frozen.std())
    moved = frozen.dist(
        *shapes, loc=(loc - float(frozen.mean())) * ratio + mean, scale=scale * ratio
    )
    return ot.Distribution(ot.SciPyDistribution(moved))


def _quantiles(function: Callable[[FloatArray], Any], p: FloatArray) -> FloatArray:
    x = _values(function, p)
    lost = np.isinf(x) & (p > 0.0)
    if lost.any():
        x[lost] = _values(function, np.maximum(p[lost], _LAST))
    return x


def _values(function: Callable[[FloatArray], Any], x: FloatArray) -> FloatArray:
    with np.errstate(all="ignore"):
        return np.array(function(x), dtype=np.float64).reshape(x.shape)
