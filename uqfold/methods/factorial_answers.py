"""Answers of full-factorial numerical integration (FFNI) from its conditional responses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from uqfold.inputs import JointInputs
from uqfold.methods.criteria_blocks import estimates_by_blocks
from uqfold.methods.factorial_design import FFNIDetails, Nodes, counts_per_input
from uqfold.methods.result import Estimate
from uqfold.methods.task import Task
from uqfold.moments.conditional import ConditionalDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability, system_failures_of_kinds
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray, IntArray

DoubtsAbout: TypeAlias = Callable[[Sequence[Criterion], Sequence[SystemProbability]], list[str]]
"""Why each answer is ``doubtful``; an empty text where it is not."""

_MATTERS = 1e-3
"""Share of pf from which a fallback at one node makes the whole answer doubtful."""
_BEYOND_END = 0.05
"""Quadrature weight of nodes with T beyond their last value from which pf is doubtful."""


def system_estimates(
    task: Task,
    details: Sequence[FFNIDetails],
    doubts: list[str],
    doubts_about: DoubtsAbout,
) -> list[Estimate]:
    """Turn the conditional responses into one estimate per criterion of the task.

    Parameters
    ----------
    task
        Criteria, units and their structure.
    details
        From `conditional_responses`, of each kind of units, at the same shared nodes.
    doubts
        Why every answer is ``doubtful``, besides infinite responses.
    doubts_about
        Why single ones are.
    """
    units = SystemUnits.of(task.problem)
    weights = details[0].weights
    doubts = [*doubts, *(doubt for one in details for doubt in doubts_about_responses(one))]
    responses = [one.responses for one in details]
    # a failed run may have had any response, and then any distribution belongs to its node
    known = [
        [
            response if complete else ConditionalResponse(None, p_missing=1.0)
            for response, complete in zip(own, one.complete, strict=True)
        ]
        for own, one in zip(responses, details, strict=True)
    ]

    def answers(rows: Sequence[int]) -> list[Estimate]:
        criteria = [task.criteria[row] for row in rows]
        found = system_failures_of_kinds(responses, weights, units, criteria)
        bounds = found
        if not all(one.complete.all() for one in details):
            bounds = system_failures_of_kinds(known, weights, units, criteria)
        own = doubts_about(criteria, found)
        return [_estimate(*row, doubts=doubts) for row in zip(found, bounds, own, strict=True)]

    return task.summed_up(lambda _: estimates_by_blocks(len(task.criteria), answers))


def fallbacks_that_matter(
    weights: FloatArray,
    distributions: Sequence[ConditionalDistribution | None],
    units: SystemUnits,
    criteria: Sequence[Criterion],
    found: Sequence[SystemProbability],
    replaced: Sequence[bool] = (),
    kind: int = 0,
) -> IntArray:
    """Count the nodes (C,) at which another distribution answers that contribute to pf.

    That is a saddlepoint's fallback, or any distribution at a node (K,) that is `replaced`; all are
    those of one kind of units.
    """
    thresholds = units.thresholds([criterion.threshold for criterion in criteria], kind)
    missions = np.array([float(criterion.max_missions) for criterion in criteria])
    pf = np.array([one.pf for one in found])
    fallbacks = np.zeros(len(criteria), dtype=int)
    for k, (weight, distribution) in enumerate(zip(weights, distributions, strict=True)):
        elsewhere: BoolArray
        if isinstance(distribution, SaddlepointDistribution):
            value = distribution.evaluate(thresholds)
            cdf, sf, elsewhere = value.cdf, value.sf, value.fallback
        elif distribution is not None and k < len(replaced) and replaced[k]:
            cdf, sf = distribution.cdf(thresholds), distribution.sf(thresholds)
            elsewhere = np.ones(thresholds.shape, dtype=bool)
        else:
            continue
        share = weight * units.count * missions * np.minimum(cdf, sf)
        fallbacks += (elsewhere & (share > _MATTERS * pf)).any(axis=0)
    return fallbacks


def doubts_about_ends(
    units: SystemUnits,
    criteria: Sequence[Criterion],
    found: Sequence[SystemProbability],
    details: FFNIDetails,
    kind: int = 0,
) -> list[str]:
    """Return where the threshold lies beyond the end of a bounded Pearson distribution."""
    # the unit that fails last is the first to lie beyond
    thresholds = units.thresholds([one.threshold for one in criteria], kind).max(axis=0)
    beyond = np.zeros(thresholds.size)
    for weight, distribution in zip(details.weights, details.distributions, strict=True):
        if isinstance(distribution, PearsonDistribution):
            beyond += float(weight) * (thresholds >= distribution.support[1])
    beyond[thresholds == np.inf] = 0.0
    return [_doubt_about_end(*row) for row in zip(criteria, found, beyond.tolist(), strict=True)]


def _doubt_about_end(criterion: Criterion, found: SystemProbability, beyond: float) -> str:
    if criterion.tau is None and beyond > _BEYOND_END:
        return (
            f"the threshold lies beyond the last value of the fitted distribution at shared nodes "
            f"of weight {beyond:.2g}: their pf of 0 is a property of the family"
        )
    if found.pf == 0.0 and beyond > 0.0:
        return "pf = 0 is a property of the fitted distribution, which is bounded"
    return ""


def doubts_about_responses(details: FFNIDetails) -> list[str]:
    """Return where no moments tell what the responses do."""
    if details.infinite > 0.0:
        return [f"infinite responses at nodes of weight {details.infinite:.2g}"]
    return []


def doubts_about_nodes(inputs: JointInputs, shared: Nodes, individual: Nodes) -> list[str]:
    """Return which individual inputs have too few nodes for four moments.

    n nodes integrate powers up to 2 n - 1: two of them give a response that is linear in its
    input a wrong fourth moment.
    """
    counts = counts_per_input(inputs, shared, individual)[inputs.n_shared :]
    few = [name for name, n in zip(inputs.individual_names, counts, strict=True) if n < 3]
    if not few:
        return []
    return [f"two nodes cannot tell the fourth moment that {', '.join(few)} gives the response"]


def _estimate(
    found: SystemProbability, bounds: SystemProbability, own: str, doubts: list[str]
) -> Estimate:
    reasons = [own, *doubts] if own else doubts
    return Estimate(
        pf=found.pf,
        reliability=found.reliability,
        pf_low=min(bounds.pf_low, found.pf),
        pf_high=max(bounds.pf_high, found.pf),
        error_kind="none",
        status="doubtful" if reasons else "unchecked",
        message="; ".join(reasons),
    )
