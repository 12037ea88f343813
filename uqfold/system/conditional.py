"""System failure probability from conditional responses: the expectation over shared inputs last.

Given the shared inputs v, units and missions are independent (Eqs. 23-30, 37-40). One mission's
failure probability comes from `synchronized`, all missions' from `missions`, and then the K
nodes of a quadrature over v are summed, complements included.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from uqfold.problems.criterion import Criterion, Missions
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.missions import over_missions
from uqfold.system.synchronized import MissionProbability, mission_probability
from uqfold.typing import FloatArray

__all__ = [
    "ConditionalResponse",
    "SystemProbability",
    "independent_failure",
    "independent_failures",
    "system_failure",
    "system_failures",
]


@dataclass(frozen=True)
class SystemProbability:
    """Failure probability of a system and its complement, each computed directly.

    Attributes
    ----------
    pf, reliability
        With failed model runs counted as failing.
    pf_low, pf_high
        Bounds on pf: units whose model run failed are ignored, or all fail. Both equal pf if no
        run failed.
    """

    pf: float
    reliability: float
    pf_low: float
    pf_high: float


def system_failure(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: int,
    threshold: float,
    tau: float | None = None,
    missions: Missions = 1,
) -> SystemProbability:
    """Failure probability of `units` exchangeable units that share inputs; see system_failures."""
    criterion = Criterion(threshold, tau, missions)
    return system_failures(responses, weights, units, [criterion])[0]


def system_failures(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    """Failure probability for each criterion, with shared inputs kept over units and missions.

    Criteria with the same tau share their integration, those with the same T and tau all of it.

    Parameters
    ----------
    responses
        One unit's response at each of K nodes of the shared inputs.
    weights : array (K,)
        Weights of the nodes; they are normalised to sum 1.
    units
        Number of units, n >= 1.
    criteria
        Threshold, tau and missions of each entry of the result.

    Raises
    ------
    ValueError
        If weights do not pair up with responses, are negative or sum to 0, or a setting is bad.
    TypeError
        If tau is given and a distribution has no density to integrate over.
    IntegrationError
        If an order-statistics integral does not converge.
    """
    shares = _normalised(responses, weights)
    nodes = [UnitResponse([response], np.ones(1)) for response in responses]
    return _expectation(nodes, shares, units, criteria)


def independent_failure(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: int,
    threshold: float,
    tau: float | None = None,
    missions: Missions = 1,
) -> SystemProbability:
    """Failure probability if nothing were shared; see independent_failures."""
    criterion = Criterion(threshold, tau, missions)
    return independent_failures(responses, weights, units, [criterion])[0]


def independent_failures(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    """Failure probability for each criterion if every response were drawn from the marginal.

    All units and all missions are independent then, each with H-bar = E_v H. Parameters and
    errors as in `system_failures`.
    """
    shares = _normalised(responses, weights)
    return _expectation([UnitResponse(responses, shares)], np.ones(1), units, criteria)


def _normalised(responses: Sequence[ConditionalResponse], weights: ArrayLike) -> FloatArray:
    shares = np.asarray(weights, dtype=float)
    if shares.shape != (len(responses),) or shares.size == 0:
        raise ValueError(f"{len(responses)} responses need as many weights, not {shares.shape}")
    if not (shares >= 0).all() or not 0 < shares.sum() < np.inf:
        raise ValueError(f"weights {shares}: they must be >= 0 and have a positive, finite sum")
    return np.asarray(shares / shares.sum())


def _expectation(
    nodes: Sequence[UnitResponse],
    shares: FloatArray,
    units: int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    mission = _mission_table(nodes, units, criteria)
    results = []
    for criterion in criteria:
        per_node = mission(criterion)
        failure, success = over_missions(per_node.failure, per_node.success, criterion.missions)
        low, _ = over_missions(per_node.failure_low, per_node.success_low, criterion.missions)
        # Weights sum to 1 up to rounding only.
        pf, reliability, pf_low = (
            min(float(shares @ values), 1.0) for values in (failure, success, low)
        )
        results.append(SystemProbability(pf, reliability, pf_low, pf))
    return results


def _mission_table(
    nodes: Sequence[UnitResponse], units: int, criteria: Sequence[Criterion]
) -> Callable[[Criterion], MissionProbability]:
    """One mission's probabilities at all nodes, for every (T, tau) that occurs: arrays (K,)."""
    thresholds: dict[float | None, list[float]] = {}
    for criterion in criteria:
        group = thresholds.setdefault(criterion.tau, [])
        if criterion.threshold not in group:
            group.append(float(criterion.threshold))
    tables = {}
    for tau, group in thresholds.items():
        rows = [mission_probability(node, units, np.array(group), tau) for node in nodes]
        tables[tau] = tuple(
            np.stack([getattr(row, field) for row in rows])
            for field in ("failure", "success", "failure_low", "success_low")
        )

    def look_up(criterion: Criterion) -> MissionProbability:
        column = thresholds[criterion.tau].index(float(criterion.threshold))
        return MissionProbability(*(table[:, column] for table in tables[criterion.tau]))

    return look_up
