"""A system with a curved response whose failure probability is known.

Unit i answers t_i = mean + log(1 + exp(U_i)) + shared_std * V * (1 + U_i / 2)
+ W_i * exp(U_i / 5 + V / 10) / 2 with standard normal V (shared), U_i and W_i (individual): curved,
with interactions, so that a surface fitted to a few dozen runs has an error worth stating. Given V
and U_i the response is normal, so that the failure probability is a smooth integral over both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.testing.linear_normal import normal_rule
from uqfold.typing import FloatArray


@dataclass(frozen=True)
class CurvedSystem:
    """Curved responses of normal inputs; exact failure probability for one mission without tau.

    Attributes
    ----------
    units
        Number of exchangeable units in series.
    mean
        Constant part of the response.
    shared_std
        How much the shared input moves the response where U = 0.
    """

    units: int = 2
    mean: float = 10.0
    shared_std: float = 0.4

    def problem(self) -> Problem:
        """Return the system as a problem with one shared and two individual inputs."""
        return Problem(
            self.response,
            shared={"V": normal(0.0, 1.0)},
            individual={"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)},
            units=self.units,
            low_fidelity=self.partner,
            name="curved",
        )

    def response(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, 3) with columns V, U, W."""
        mean, std = self._given(x[:, 0], x[:, 1])
        return mean + std * x[:, 2]

    def partner(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of a cheaper partner, which knows nothing of how the inputs interact."""
        return self._given(0.0 * x[:, 0], x[:, 1])[0] + self.shared_std * x[:, 0] + 0.5 * x[:, 2]

    def pf(self, threshold: float) -> float:
        """Exact probability that a unit exceeds the threshold, to about 1e-12 relative."""
        from scipy.special import ndtr

        nodes, weights = normal_rule(np.empty(0))
        mean, std = self._given(nodes[:, None], nodes)
        late = ndtr((mean - threshold) / std) @ weights
        return float(weights @ -np.expm1(self.units * np.log1p(-late)))

    def _given(self, v: FloatArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean and standard deviation of the response given V and U."""
        curve = self.mean + np.logaddexp(0.0, u)
        return curve + self.shared_std * v * (1.0 + 0.5 * u), 0.5 * np.exp(0.2 * u + 0.1 * v)
