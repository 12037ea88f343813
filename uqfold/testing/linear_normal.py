"""A system whose failure probability is known: linear responses of normal inputs.

Unit i answers t_i = mean + shared_std * V + individual_std * (0.6 U_i + 0.8 W_i) with standard
normal V (shared), U_i and W_i (individual). Given V, the responses are normal and independent, so
the failure probability is one smooth integral over V (and with tau one more over the smallest
response), which is computed here without any part of the algebra under test.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.checks import instance, keep, real, whole
from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.typing import FloatArray

_PANELS, _ORDER, _REACH = 24, 12, 9.0
_ALMOST_SURE = 1.0 - 2.0**-53


@dataclass(frozen=True)
class LinearNormalSystem:
    """Linear responses of normal inputs; exact failure probabilities.

    Attributes
    ----------
    units
        Number of exchangeable units in series.
    mean
        Mean response.
    shared_std, individual_std
        Standard deviation that comes from the shared and from the individual inputs.
    """

    units: int = 3
    mean: float = 10.0
    shared_std: float = 0.3
    individual_std: float = 1.0

    def __post_init__(self) -> None:
        keep(self, "units", whole, at_least=1)
        keep(self, "mean", real)
        keep(self, "shared_std", real, at_least=0.0)
        keep(self, "individual_std", real, above=0.0)

    def problem(self) -> Problem:
        """Give the system as a problem with one shared and two individual inputs."""
        return Problem(
            self.response,
            shared={"V": normal(0.0, 1.0)},
            individual={"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)},
            units=self.units,
            name="linear-normal",
        )

    def response(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, 3) with columns V, U, W."""
        individual = 0.6 * x[:, 1] + 0.8 * x[:, 2]
        return self.mean + self.shared_std * x[:, 0] + self.individual_std * individual

    def pf(self, criterion: Criterion) -> float:
        """Exact failure probability, to about 1e-12 relative."""
        instance("criterion", criterion, Criterion, "give a Criterion")
        v, weights = normal_rule(*self._transition(criterion))
        one = np.array([self._mission_failure(criterion, value) for value in v])
        missions = criterion.missions
        if isinstance(missions, Binomial):
            failure = -np.expm1(missions.planned * np.log1p(-missions.p * one))
        else:
            failure = -np.expm1(missions * np.log1p(-one))
        return float(weights @ failure)

    def _transition(self, criterion: Criterion) -> FloatArray:
        """Values of V between which units turn from safe to failed, however suddenly they do."""
        if self.shared_std == 0.0 or math.isinf(criterion.threshold):
            return np.empty(0)
        upper = np.linspace(-_REACH, _REACH, _PANELS + 1)
        middle = (criterion.threshold - self.mean) / self.shared_std
        return np.asarray(middle + self.individual_std / self.shared_std * upper)

    def _mission_failure(self, criterion: Criterion, v: float) -> float:
        from scipy.special import ndtr

        mean = self.mean + self.shared_std * v
        upper = (criterion.threshold - mean) / self.individual_std
        late = -math.expm1(self.units * math.log1p(-min(float(ndtr(-upper)), _ALMOST_SURE)))
        if criterion.tau is None:
            return min(late, _ALMOST_SURE)
        width = criterion.tau / self.individual_std
        # smallest response z: in time, but the others do not all lie within the width
        z, weights = normal_rule(upper - width, upper)
        in_time = np.maximum(ndtr(upper) - ndtr(z), 0.0)
        near = np.maximum(ndtr(np.minimum(z + width, upper)) - ndtr(z), 0.0)
        others = self.units - 1
        apart = self.units * float(weights @ np.where(z < upper, in_time**others - near**others, 0))
        return min(late + apart, _ALMOST_SURE)


def normal_rule(*kinks: float) -> tuple[FloatArray, FloatArray]:
    """Composite Gauss-Legendre rule for the standard normal density on [-9, 9].

    Panels end at the kinks of the integrand, so that each panel sees a smooth function.
    """
    x, w = np.polynomial.legendre.leggauss(_ORDER)
    inside = [kink for kink in kinks if abs(kink) < _REACH]
    edges = np.sort(np.concatenate([np.linspace(-_REACH, _REACH, _PANELS + 1), inside]))
    half = 0.5 * np.diff(edges)[:, None]
    nodes = (0.5 * (edges[:-1] + edges[1:])[:, None] + half * x).ravel()
    weights = (half * w).ravel() * np.exp(-0.5 * nodes**2) / math.sqrt(2.0 * math.pi)
    return nodes, weights
