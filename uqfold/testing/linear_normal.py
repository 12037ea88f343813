"""A system whose failure probability is known: linear responses of normal inputs.

Unit i answers t_i = mean + shared_std * V + individual_std * (0.6 U_i + 0.8 W_i) with standard
normal V (shared), U_i and W_i (individual). Given V, the responses are normal and independent, so
the failure probability is one smooth integral over V (and with tau one more over the smallest
response), which is computed here without any part of the algebra under test: what a structure
makes of failures is added up over all states of the units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from uqfold.checks import instance, keep, real, whole
from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.expression import Term, read
from uqfold.problems.structure import (
    CutSets,
    KOutOfN,
    Parallel,
    PathSets,
    Series,
    SystemStructure,
    checked_structure,
)
from uqfold.typing import FloatArray

_PANELS, _ORDER, _REACH = 24, 12, 9.0
_ALMOST_SURE = 1.0 - 2.0**-53


@dataclass(frozen=True)
class LinearNormalSystem:
    """Linear responses of normal inputs; exact failure probabilities.

    Attributes
    ----------
    units
        Number of exchangeable units.
    mean
        Mean response.
    shared_std, individual_std
        Standard deviation that comes from the shared and from the individual inputs.
    structure
        How the units make up the system: an expression calls them u0, u1, ...; for few units, if
        it is not a series.
    """

    units: int = 3
    mean: float = 10.0
    shared_std: float = 0.3
    individual_std: float = 1.0
    structure: SystemStructure = field(default_factory=Series)

    def __post_init__(self) -> None:
        keep(self, "units", whole, at_least=1)
        keep(self, "mean", real)
        keep(self, "shared_std", real, at_least=0.0)
        keep(self, "individual_std", real, above=0.0)
        checked_structure(self.structure, tuple(f"u{i}" for i in range(self.units)))

    def problem(self) -> Problem:
        """Return the system as a problem with one shared and two individual inputs."""
        return Problem(
            self.response,
            shared={"V": normal(0.0, 1.0)},
            individual={"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)},
            units=self.units,
            structure=self.structure,
            low_fidelity=self.partner,
            name="linear-normal",
        )

    def response(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, 3) with columns V, U, W."""
        individual = 0.6 * x[:, 1] + 0.8 * x[:, 2]
        return self.mean + self.shared_std * x[:, 0] + self.individual_std * individual

    def partner(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of a cheaper partner: it errs by a wave, and by a tenth of a deviation."""
        return self.response(x) + 0.1 * self.individual_std * (1.0 + np.sin(3.0 * x[:, 1]))

    def pf(self, criterion: Criterion) -> float:
        """Exact failure probability, to about 1e-12 relative."""
        instance("criterion", criterion, Criterion, "give a Criterion")
        v, weights = normal_rule(self._transition(criterion))
        one = self._mission_failure(criterion, v)
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

    def _mission_failure(self, criterion: Criterion, v: FloatArray) -> FloatArray:
        """Failure probability of one mission given each of the values V (n,)."""
        from scipy.special import ndtr

        upper = (criterion.threshold - self.mean - self.shared_std * v) / self.individual_std
        one_late = np.minimum(ndtr(-upper), _ALMOST_SURE)
        if not isinstance(self.structure, Series):
            return self._structure_failure(one_late, np.maximum(ndtr(upper), 1.0 - _ALMOST_SURE))
        late = -np.expm1(self.units * np.log1p(-one_late))
        if criterion.tau is None:
            return np.asarray(np.minimum(late, _ALMOST_SURE))
        width = criterion.tau / self.individual_std
        upper = upper[:, None]
        # smallest response z: in time, but the others do not all lie within the width
        z, weights = normal_rule(np.concatenate([upper - width, upper], axis=1))
        in_time = np.maximum(ndtr(upper) - ndtr(z), 0.0)
        near = np.maximum(ndtr(np.minimum(z + width, upper)) - ndtr(z), 0.0)
        others = self.units - 1
        integrand = np.where(z < upper, in_time**others - near**others, 0.0)
        apart = self.units * np.sum(weights * integrand, axis=1)
        return np.asarray(np.minimum(late + apart, _ALMOST_SURE))

    def _structure_failure(self, late: FloatArray, in_time: FloatArray) -> FloatArray:
        """Failure of a mission from all states of the units, given how each fails and works."""
        failure = np.zeros(late.shape)
        for works in product((False, True), repeat=self.units):
            if not works_as(self.structure, works):
                count = sum(works)
                failure += in_time**count * late ** (self.units - count)
        return np.minimum(failure, _ALMOST_SURE)


def works_as(structure: SystemStructure, works: Sequence[bool]) -> bool:
    """Whether a system works whose units do or do not."""
    if isinstance(structure, Parallel):
        return any(works)
    if isinstance(structure, KOutOfN):
        return sum(works) >= structure.k
    if isinstance(structure, CutSets):
        return all(any(works[i] for i in cut) for cut in structure.sets)
    if isinstance(structure, PathSets):
        return any(all(works[i] for i in path) for path in structure.sets)
    if isinstance(structure, Series):
        return all(works)
    expression = read(structure.expression)
    known: list[bool] = []

    def is_true(part: Term) -> bool:
        return works[int(part.removeprefix("u"))] if isinstance(part, str) else known[part]

    for gate in expression.gates:
        known.append(sum(map(is_true, gate.parts)) >= gate.k)
    return is_true(expression.system)


def normal_rule(kinks: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Composite Gauss-Legendre rules for the standard normal density on [-9, 9].

    One rule for each row of kinks (..., k) of its integrand; its panels end there, so that each
    panel sees a smooth function. Kinks elsewhere leave panels without width.
    """
    x, w = np.polynomial.legendre.leggauss(_ORDER)
    inside = np.where(np.abs(kinks) < _REACH, kinks, _REACH)
    panels = np.linspace(-_REACH, _REACH, _PANELS + 1)
    rows = inside.shape[:-1]
    panels = np.broadcast_to(panels, (*rows, len(panels)))
    edges = np.sort(np.concatenate([panels, inside], axis=-1), axis=-1)
    half = 0.5 * np.diff(edges)[..., None]
    nodes = (0.5 * (edges[..., :-1] + edges[..., 1:])[..., None] + half * x).reshape(*rows, -1)
    density = np.exp(-0.5 * nodes**2) / math.sqrt(2.0 * math.pi)
    return nodes, (half * w).reshape(*rows, -1) * density
