"""One input by itself: from and to standard-normal values, and its density.

The standard-normal value u of x has the lower probability Phi(u) and the upper one Phi(-u) of x,
so that both tails keep their digits.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from uqfold.inputs.engine import openturns
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.inputs.moments import finite_moments, with_moments
from uqfold.typing import FloatArray


class WithoutCaches:
    """Pickles the fields of a record and not what was computed from them."""

    def __getstate__(self) -> dict[str, Any]:
        return {one.name: getattr(self, one.name) for one in fields(self)}  # type: ignore[arg-type]


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
        """Map standard-normal values (n,) to the input's (n,), in its unit."""

    @abstractmethod
    def to_normal(self, x: FloatArray) -> FloatArray:
        """Map the input's values (n,) to standard-normal ones (n,), infinite beyond its bounds."""

    @abstractmethod
    def log_pdf(self, x: FloatArray) -> FloatArray:
        """Return the logarithm of the density (n,) at x (n,)."""

    def cdf(self, x: FloatArray) -> FloatArray:
        """Return lower probabilities (n,) at x (n,)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(self.to_normal(x)))

    def sf(self, x: FloatArray) -> FloatArray:
        """Return upper probabilities (n,) at x (n,)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(-self.to_normal(x)))

    def pdf(self, x: FloatArray) -> FloatArray:
        """Return the density (n,) at x (n,)."""
        return np.asarray(np.exp(self.log_pdf(x)))

    @property
    @abstractmethod
    def bounds(self) -> tuple[float, float]:
        """Lower and upper bound; infinite where there is none."""

    @cached_property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation.

        Raises
        ------
        ValueError
            If they are not finite.
        """
        return finite_moments(self.distribution)

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """Values (k,) of positive probability and these probabilities; empty if continuous."""
        return np.empty(0), np.empty(0)

    @property
    def steps(self) -> bool:
        """Whether the input jumps from one value to another, with none between, as normals rise."""
        return False

    @property
    def kinks(self) -> FloatArray:
        """Places (k,) where the density is known to be not smooth."""
        return np.empty(0)

    def with_moments(self, mean: float, std: float) -> Any:
        """Return the same kind of distribution with other moments, in OpenTURNS form."""
        return with_moments(self.distribution, mean, std)

    def __str__(self) -> str:
        return str(self.distribution)


class OpenTURNSMarginal(Marginal):
    """A distribution that OpenTURNS computes itself, or by calling a user's Python code."""

    @cached_property
    def _from_normal(self) -> Any:
        ot = openturns()
        return ot.Function(ot.MarginalTransformationEvaluation([ot.Normal()], [self.distribution]))

    @cached_property
    def _to_normal(self) -> Any:
        ot = openturns()
        return ot.Function(ot.MarginalTransformationEvaluation([self.distribution], [ot.Normal()]))

    def _column(self, function: Callable[..., Any], x: FloatArray) -> FloatArray:
        return called(function, x[:, None]).ravel()

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self._from_normal, u)

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return beyond(self.bounds, x, self._column(self._to_normal, x))

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computeCDF, x)

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return self._column(self.distribution.computeComplementaryCDF, x)

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
    def kinks(self) -> FloatArray:
        """See `Marginal`."""
        return np.array(self.distribution.getSingularities(), dtype=np.float64)


def beyond(bounds: tuple[float, float], x: FloatArray, u: FloatArray) -> FloatArray:
    """Return u with infinities where x lies beyond the bounds."""
    low, high = bounds
    return np.where(x < low, -np.inf, np.where(x > high, np.inf, u))


def called(function: Callable[..., Any], rows: FloatArray) -> FloatArray:
    """Return what an OpenTURNS function makes of rows (n, k); Ctrl-C waits until it has.

    Raises
    ------
    KeyboardInterrupt
        Also where OpenTURNS cannot be kept from making an error of its own of Ctrl-C.
    """
    if len(rows) == 0:
        return np.empty((0, rows.shape[1]))
    try:
        with DeferredInterrupt():
            return np.array(function(openturns().Sample(rows)), dtype=np.float64)
    except RuntimeError as error:
        if "Interruption in" in str(error):
            raise KeyboardInterrupt from error
        raise
