"""System failure probability from conditional responses: the expectation over shared inputs last.

Given the shared inputs v, units and missions are independent (Eqs. 23-30, 37-40). One mission's
failure probability comes from `synchronized` and `structure`, all missions' from `missions`, and
then the K nodes of a quadrature over v are summed, complements included.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from uqfold.problems.criterion import Criterion, Missions
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.missions import over_missions
from uqfold.system.structure import SystemUnits
from uqfold.system.synchronized import (
    MissionProbability,
    complementary,
    mission_probability,
)
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

Key = TypeVar("Key")

_BLOCK = 4096
"""Thresholds answered at once: bounds memory."""

__all__ = [
    "ConditionalResponse",
    "SystemProbability",
    "grouped",
    "independent_failure",
    "independent_failures",
    "system_failure",
    "system_failures",
    "system_failures_of_kinds",
]


@dataclass(frozen=True)
class SystemProbability:
    """Failure probability of a system and its complement, each computed directly.

    Attributes
    ----------
    pf, reliability
        With failed runs counted as failing.
    pf_low, pf_high
        Bounds on pf: units whose run failed are ignored, or all fail. Both equal pf if no
        run failed.
    """

    pf: float
    reliability: float
    pf_low: float
    pf_high: float


def system_failure(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: SystemUnits | int,
    threshold: float,
    tau: float | None = None,
    missions: Missions = 1,
) -> SystemProbability:
    """Failure probability of units of one kind that share inputs; see system_failures."""
    criterion = Criterion(threshold, tau, missions)
    return system_failures(responses, weights, units, [criterion])[0]


def system_failures(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: SystemUnits | int,
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
        The units and their structure, or the number n >= 1 of units in series.
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
    return system_failures_of_kinds([responses], weights, units, criteria)


def system_failures_of_kinds(
    responses: Sequence[Sequence[ConditionalResponse]],
    weights: ArrayLike,
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    """Failure probability for each criterion, of units of several kinds.

    Parameters
    ----------
    responses
        For each kind, the response of one unit without offset at each of K nodes of the shared
        inputs, which are the same for all kinds.
    weights, units, criteria
        As in `system_failures`, which says what is raised.
    """
    shares = _normalised(responses, weights)
    nodes = [
        [UnitResponse([one], np.ones(1)) for one in kinds] for kinds in zip(*responses, strict=True)
    ]
    return _expectation(nodes, shares, units, criteria)


def independent_failure(
    responses: Sequence[ConditionalResponse],
    weights: ArrayLike,
    units: SystemUnits | int,
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
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    """Failure probability for each criterion if every response were drawn from the marginal.

    All units and all missions are independent then, each with H-bar = E_v H. Parameters and
    errors as in `system_failures`.
    """
    shares = _normalised([responses], weights)
    return _expectation([[UnitResponse(responses, shares)]], np.ones(1), units, criteria)


def _normalised(
    responses: Sequence[Sequence[ConditionalResponse]], weights: ArrayLike
) -> FloatArray:
    shares = np.asarray(weights, dtype=float)
    for one in responses:
        if shares.shape != (len(one),) or shares.size == 0:
            raise ValueError(f"{len(one)} responses need as many weights, not {shares.shape}")
    if not (shares >= 0).all() or not 0 < shares.sum() < np.inf:
        raise ValueError(f"weights {shares}: they must be >= 0 and have a positive, finite sum")
    return np.asarray(shares / shares.sum())


def _expectation(
    nodes: Sequence[Sequence[UnitResponse]],
    shares: FloatArray,
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
) -> list[SystemProbability]:
    found = np.empty((4, len(criteria)))
    for tau, rows in grouped(criteria, lambda one: one.tau):
        asked = np.array([criteria[row].threshold for row in rows])
        thresholds, column = np.unique(asked, return_inverse=True)
        for start in range(0, thresholds.size, _BLOCK):
            block = thresholds[start : start + _BLOCK]
            mission = _at_nodes(nodes, units, block, tau)
            here = np.flatnonzero((column >= start) & (column < start + _BLOCK))
            profiles = [criteria[rows[i]] for i in here]
            for missions, some in grouped(profiles, lambda one: one.missions):
                of_block = column[here[some]] - start
                answers = _over_nodes(mission, shares, missions)[:, of_block]
                found[:, [rows[i] for i in here[some]]] = answers
    # Weights sum to 1 up to rounding only.
    pf, reliability = complementary(*found[:2])
    pf_low = complementary(*found[2:])[0]
    return [
        SystemProbability(*values)
        for values in zip(*(one.tolist() for one in (pf, reliability, pf_low, pf)), strict=True)
    ]


def grouped(
    criteria: Sequence[Criterion], key: Callable[[Criterion], Key]
) -> Iterator[tuple[Key, list[int]]]:
    """Values of a key, and which criteria have each of them."""
    groups: dict[Key, list[int]] = {}
    for row, criterion in enumerate(criteria):
        groups.setdefault(key(criterion), []).append(row)
    return iter(groups.items())


def _at_nodes(
    nodes: Sequence[Sequence[UnitResponse]],
    units: SystemUnits | int,
    thresholds: FloatArray,
    tau: float | None,
) -> MissionProbability:
    """One mission's probabilities at all nodes, arrays (K, R)."""
    rows = []
    for node in nodes:
        check_time()
        rows.append(mission_probability(node, units, thresholds, tau))
    return MissionProbability(
        *(np.stack([getattr(row, field.name) for row in rows]) for field in fields(rows[0]))
    )


def _over_nodes(mission: MissionProbability, shares: FloatArray, missions: Missions) -> FloatArray:
    """Failure and success over missions and nodes, failed runs failing, then ignored: (4, R)."""
    pairs = (
        *over_missions(mission.failure, mission.success, missions),
        *over_missions(mission.failure_low, mission.success_low, missions),
    )
    return np.stack([shares @ values for values in pairs])
