"""Moments and cumulants of a response from the nodes of a quadrature rule (Eqs. 33 and 41)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.generating import QuadraticForm
from uqfold.typing import BoolArray, FloatArray


@dataclass(frozen=True)
class Moments:
    """First six moments of K responses, one entry per row.

    Attributes
    ----------
    mean, std
        Mean and standard deviation, in the unit of the response; arrays (K,).
    skewness, kurtosis
        Third and fourth standardised central moments (kurtosis is 3 for a normal, not 0);
        arrays (K,). A row that does not scatter (std = 0) has skewness 0 and kurtosis 3.
    fifth, sixth
        The next two, 0 and 15 for a normal; arrays (K,).
    """

    mean: FloatArray
    std: FloatArray
    skewness: FloatArray
    kurtosis: FloatArray
    fifth: FloatArray
    sixth: FloatArray

    @classmethod
    def of_rows(cls, rows: Sequence[ResponseMoments]) -> Moments:
        """Join the moments of K responses."""
        return cls(*np.array([[*one.four, one.fifth, one.sixth] for one in rows]).T)

    def row(self, k: int) -> tuple[float, float, float, float]:
        """Mean, std, skewness and kurtosis of row k as plain floats."""
        return (
            float(self.mean[k]),
            float(self.std[k]),
            float(self.skewness[k]),
            float(self.kurtosis[k]),
        )

    def of(self, k: int) -> ResponseMoments:
        """All moments of row k."""
        return ResponseMoments(*self.row(k), float(self.fifth[k]), float(self.sixth[k]))

    def __len__(self) -> int:
        return len(self.mean)


@dataclass(frozen=True)
class ResponseMoments:
    """What a conditional distribution may be built from.

    Attributes
    ----------
    mean, std
        In the unit of the response; std = 0 where it does not scatter.
    skewness, kurtosis, fifth, sixth
        Standardised central moments: 0, 3, 0 and 15 for a normal.
    quadratic
        The cumulant-generating function of the response as far as it is of degree two in
        standard normal inputs; None where that is not known, or says too little.
    """

    mean: float
    std: float
    skewness: float
    kurtosis: float
    fifth: float
    sixth: float
    quadratic: QuadraticForm | None = None

    @property
    def four(self) -> tuple[float, float, float, float]:
        """Mean, std, skewness and kurtosis."""
        return self.mean, self.std, self.skewness, self.kurtosis

    @property
    def higher_cumulants(self) -> tuple[float, float, float, float]:
        """Standardised cumulants of order three to six."""
        third, fourth = self.skewness, self.kurtosis
        return (
            third,
            fourth - 3.0,
            self.fifth - 10.0 * third,
            self.sixth - 15.0 * fourth - 10.0 * third**2 + 30.0,
        )


def moments_from_rule(y: ArrayLike, weights: ArrayLike, where: BoolArray | None = None) -> Moments:
    """Moments of each row of y under one quadrature rule (Eq. 41).

    Sums are centred, so a response of 1e6 with a scatter of 1e-3 loses no digits to cancellation.

    Parameters
    ----------
    y : array (K, q)
        Responses at the q nodes of the rule, one row per combination of shared nodes.
    weights : array (q,)
        Weights of the rule, of any positive sum: they are renormalised over the nodes used.
    where : bool array (K, q), optional
        Nodes to use (for instance those whose response is finite). A row without any gives NaN.

    Raises
    ------
    ValueError
        If shapes do not fit, or a response that is to be used is not finite.
    """
    values = np.asarray(y, dtype=float)
    rule = np.asarray(weights, dtype=float)
    if values.ndim != 2 or rule.shape != values.shape[1:]:
        raise ValueError(
            f"y has shape {values.shape} and weights {rule.shape}; give y (K, q) and weights (q,)"
        )
    used = np.ones(values.shape, dtype=bool) if where is None else np.asarray(where, dtype=bool)
    if not np.isfinite(values[used]).all():
        raise ValueError(
            "y holds NaN or inf among the nodes used; leave them out through `where` and carry "
            "their probability separately"
        )
    w = np.where(used, rule, 0.0)
    total = w.sum(axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        w = w / total
        # Shifting by one of the row's own values makes a constant row scatter by exactly 0.
        origin = np.take_along_axis(values, used.argmax(axis=1)[:, None], axis=1)
        origin = np.where(used.any(axis=1, keepdims=True), origin, np.nan)
        shifted = np.where(used, values - origin, 0.0)
        shift = (w * shifted).sum(axis=1, keepdims=True)
        deviation = np.where(used, shifted - shift, 0.0)
        # by powers of two, which leave all digits alone, so that no square leaves the floats
        power = np.frexp(np.abs(deviation).max(axis=1, keepdims=True))[1]
        unit = np.ldexp(deviation, -power)
        std = np.sqrt((w * unit**2).sum(axis=1))
        scaled = unit / np.where(std > 0, std, 1.0)[:, None]
        skewness, kurtosis, fifth, sixth = (
            np.where(std > 0, (w * scaled**order).sum(axis=1), of_normal + 0.0 * std)
            for order, of_normal in ((3, 0.0), (4, 3.0), (5, 0.0), (6, 15.0))
        )
    mean, std = (origin + shift)[:, 0], np.ldexp(std, power[:, 0])
    return Moments(mean, std, skewness, kurtosis, fifth, sixth)


def cumulants(moments: Moments) -> FloatArray:
    """First four cumulants (4, K) from central moments: Eq. (33) without its cancellation."""
    variance = moments.std**2
    return np.stack(
        [
            moments.mean,
            variance,
            moments.skewness * variance * moments.std,
            (moments.kurtosis - 3.0) * variance**2,
        ]
    )
