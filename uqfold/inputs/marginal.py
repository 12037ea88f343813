"""One input by itself: its quantiles, distribution function and density, good in both tails.

A distribution of OpenTURNS computes with OpenTURNS. One that OpenTURNS only wraps (SciPy, chaospy)
is asked directly, all rows at once; so is the replacement of one that OpenTURNS gets wrong. The
upper half goes through the survival function, so that a tail keeps its digits.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from uqfold.inputs.moments import finite_moments, with_moments
from uqfold.inputs.python_side import (
    WithoutCaches,
    interrupt_deferred,
    written_in_python,
)
from uqfold.typing import FloatArray

_LAST = 2.0**-53
"""Where a library forms 1 - p, its upper tail ends here."""


class Law(Protocol):
    """What a frozen SciPy distribution offers, and what stands in for one."""

    def ppf(self, q: FloatArray) -> Any:
        """Quantile of the lower probability q."""

    def isf(self, q: FloatArray) -> Any:
        """Quantile of the upper probability q."""

    def cdf(self, x: FloatArray) -> Any:
        """Lower probability."""

    def sf(self, x: FloatArray) -> Any:
        """Upper probability."""

    def pdf(self, x: FloatArray) -> Any:
        """Density."""

    def logpdf(self, x: FloatArray) -> Any:
        """Logarithm of the density."""

    def support(self) -> tuple[float, float]:
        """Bounds."""

    def mean(self) -> Any:
        """Mean."""

    def std(self) -> Any:
        """Standard deviation."""


@dataclass(frozen=True, eq=False)
class Marginal(WithoutCaches, ABC):
    """Distribution of one input.

    Attributes
    ----------
    distribution
        Its OpenTURNS form.
    """

    distribution: Any

    @abstractmethod
    def from_normal(self, u: FloatArray) -> FloatArray:
        """Map standard-normal values (n,) to the input's (n,)."""

    @abstractmethod
    def to_normal(self, x: FloatArray) -> FloatArray:
        """Map the input's values (n,) to standard-normal ones (n,), infinite beyond its bounds."""

    @abstractmethod
    def cdf(self, x: FloatArray) -> FloatArray:
        """Lower probabilities (n,)."""

    @abstractmethod
    def sf(self, x: FloatArray) -> FloatArray:
        """Upper probabilities (n,)."""

    @abstractmethod
    def pdf(self, x: FloatArray) -> FloatArray:
        """Density (n,)."""

    @abstractmethod
    def log_pdf(self, x: FloatArray) -> FloatArray:
        """Logarithm of the density (n,)."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[float, float]:
        """Lower and upper bound; infinite where there is none."""

    @property
    @abstractmethod
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation.

        Raises
        ------
        ValueError
            If they are not finite.
        """

    @property
    @abstractmethod
    def kinks(self) -> FloatArray:
        """Places where the density is known to be not smooth."""

    @abstractmethod
    def with_moments(self, mean: float, std: float) -> Any:
        """Return the same kind of distribution with other moments, in OpenTURNS form."""

    def __str__(self) -> str:
        return str(self.distribution)


class OpenTURNSMarginal(Marginal):
    """A distribution that OpenTURNS computes itself, or by calling a user's Python code."""

    @cached_property
    def python(self) -> bool:
        """Whether OpenTURNS calls Python, value by value."""
        return written_in_python(self.distribution)

    def _column(self, function: Any, x: FloatArray) -> FloatArray:
        return column_of(function, x, python=self.python)

    @cached_property
    def _from_normal(self) -> Any:
        import openturns as ot

        return ot.Function(ot.MarginalTransformationEvaluation([ot.Normal()], [self.distribution]))

    @cached_property
    def _to_normal(self) -> Any:
        import openturns as ot

        return ot.Function(ot.MarginalTransformationEvaluation([self.distribution], [ot.Normal()]))

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self._from_normal, u)

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return beyond(self.bounds, x, self._column(self._to_normal, x))

    def quantile(self, p: FloatArray) -> FloatArray:
        """Quantiles (n,) of the lower probabilities p (n,)."""
        found = called(self.distribution.computeQuantile, p.tolist(), python=self.python)
        return np.array(found, dtype=np.float64).ravel()

    def upper_quantile(self, p: FloatArray) -> FloatArray:
        """Quantiles (n,) of the upper probabilities p (n,)."""
        found = called(self.distribution.computeQuantile, p.tolist(), True, python=self.python)
        return np.array(found, dtype=np.float64).ravel()

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computeCDF, x)

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computeComplementaryCDF, x)

    def pdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computePDF, x)

    def log_pdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computeLogPDF, x)

    @cached_property
    def bounds(self) -> tuple[float, float]:
        """See `Marginal`."""
        own = self.distribution.getRange()
        low = own.getLowerBound()[0] if own.getFiniteLowerBound()[0] else -math.inf
        high = own.getUpperBound()[0] if own.getFiniteUpperBound()[0] else math.inf
        return float(low), float(high)

    @cached_property
    def moments(self) -> tuple[float, float]:
        """See `Marginal`."""
        return finite_moments(self.distribution)

    @cached_property
    def kinks(self) -> FloatArray:
        """See `Marginal`."""
        return np.array(self.distribution.getSingularities(), dtype=np.float64)

    def with_moments(self, mean: float, std: float) -> Any:
        """See `Marginal`."""
        return with_moments(self.distribution, mean, std)


@dataclass(frozen=True, eq=False)
class DirectMarginal(Marginal):
    """A distribution that is asked directly, all rows at once.

    Attributes
    ----------
    law
        The distribution itself.
    name
        What reports call it.
    moved
        (mean, std) -> the same kind with these moments, in OpenTURNS form.
    """

    law: Law
    name: str
    moved: Callable[[float, float], Any]

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        from scipy.special import ndtr

        x = np.empty(u.shape)
        below = u <= 0.0
        x[below] = self._quantiles(self.law.ppf, ndtr(u[below]))
        x[~below] = self._quantiles(self.law.isf, ndtr(-u[~below]))
        return np.clip(x, *self.bounds)  # rounding may lead past a bound

    def _quantiles(self, function: Callable[[FloatArray], Any], p: FloatArray) -> FloatArray:
        x = _values(function, p)
        lost = np.isinf(x) & (p > 0.0)
        if lost.any():
            x[lost] = _values(function, np.maximum(p[lost], _LAST))
        return x

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

    def pdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return _values(self.law.pdf, x)

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

    @property
    def kinks(self) -> FloatArray:
        """See `Marginal`."""
        return np.empty(0)

    def with_moments(self, mean: float, std: float) -> Any:
        """See `Marginal`."""
        if not (math.isfinite(mean) and math.isfinite(std) and std > 0.0):
            raise ValueError(
                f"mean {mean}, standard deviation {std}: must be finite, the latter > 0"
            )
        return self.moved(mean, std)

    def __str__(self) -> str:
        return self.name


def beyond(bounds: tuple[float, float], x: FloatArray, u: FloatArray) -> FloatArray:
    """Return u with infinities where x lies beyond the bounds."""
    low, high = bounds
    return np.where(x < low, -np.inf, np.where(x > high, np.inf, u))


def column_of(function: Any, x: FloatArray, *, python: bool) -> FloatArray:
    """Values (n,) of an OpenTURNS function of one variable at x (n,); `python`: see `called`."""
    import openturns as ot

    if x.size == 0:
        return np.empty(0)
    return np.array(
        called(function, ot.Sample(x[:, None]), python=python), dtype=np.float64
    ).ravel()


def called(function: Callable[..., Any], *arguments: Any, python: bool) -> Any:
    """Call OpenTURNS; where it calls Python in turn, Ctrl-C waits.

    Raises
    ------
    KeyboardInterrupt
        Also where OpenTURNS makes an error of its own of Ctrl-C.
    """
    try:
        if not python:
            return function(*arguments)
        with interrupt_deferred():
            return function(*arguments)
    except (RuntimeError, TypeError) as error:
        if "Interruption in" in str(error) or "KeyboardInterrupt" in str(error):
            raise KeyboardInterrupt from error
        raise


def _values(function: Callable[[FloatArray], Any], x: FloatArray) -> FloatArray:
    with np.errstate(all="ignore"):
        return np.array(function(x), dtype=np.float64).reshape(x.shape)
