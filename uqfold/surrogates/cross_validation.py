"""How well a surface predicts responses that it was not fitted to."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray, IntArray

# Factor between stated and actual scatter that no sample of a dozen runs or more shows by chance.
_CONTRADICTION = 2.0


@dataclass(frozen=True, eq=False)
class LeaveOneOut:
    """Prediction of every training response from all others, settings of the fit kept.

    Attributes
    ----------
    residuals
        Response minus prediction (n,).
    std
        Standard deviation (n,) that the surface states for them.
    """

    residuals: FloatArray
    std: FloatArray

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, in the unit of the response."""
        return math.sqrt(float(np.mean(self.residuals**2)))

    @property
    def ratio(self) -> float:
        """Root mean square of residuals in units of their stated standard deviation."""
        stated = np.maximum(self.std, np.finfo(float).tiny)
        return math.sqrt(float(np.mean((self.residuals / stated) ** 2)))

    def among(self, some: IntArray) -> LeaveOneOut:
        """Return what is known of some of the runs (k,) alone."""
        return LeaveOneOut(self.residuals[some], self.std[some])

    def contradicts(self, noise: float | None) -> bool:
        """Whether a stated noise cannot be that of these residuals; None: none was stated.

        Every residual holds the noise of its own run: far smaller ones belong to less noise, and
        far larger ones than the surface states to more.
        """
        return noise is not None and (
            self.rms < noise / _CONTRADICTION or self.ratio > _CONTRADICTION
        )

    @property
    def log_density(self) -> float:
        """Mean logarithm of the stated normal density of the residuals: the higher, the better."""
        stated = np.maximum(self.std, np.finfo(float).tiny)
        return float(np.mean(-0.5 * (self.residuals / stated) ** 2 - np.log(stated)))
