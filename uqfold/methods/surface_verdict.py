"""What is told of a surface's answer: numbers and their errors, doubts about it, a status."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.result import Estimate
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.system.conditional import SystemProbability
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.surface import reliability_indices
from uqfold.typing import FloatArray

CI_KIND = "95 % surrogate"

_T95 = 2.093
"""Student's quantile for a spread estimated from 20 draws."""
_POOR_PREDICTION, _FEW_RUNS = 0.1, 100
# Last digit of the responses, in their spread, from which rounding is more than a nuisance.
_COARSE_DIGITS = 1e-3


def missed_share(validated: LeaveOneOut, runs: DesignRuns) -> float:
    """By how much runs left out are missed, as a share of the scatter of responses."""
    finite = runs.y[runs.finite]
    if np.ptp(finite) == 0.0:
        return 0.0
    scatter = float(finite.std())
    return validated.rms / scatter if scatter > 0.0 else math.inf


def poor_share(runs: DesignRuns) -> float:
    """Share of the scatter from which runs left out are predicted badly.

    The more runs, the less: what a smooth surface misses falls much faster than this, what it
    misses of a step more slowly, so that runs added until it looks right do not make it so.
    """
    return _POOR_PREDICTION * min(1.0, _FEW_RUNS / runs.y.size)


def change_of_pf(beta: FloatArray) -> FloatArray:
    """Change of pf for a small one of the reliability index."""
    return np.asarray(np.exp(-0.5 * beta**2) / math.sqrt(2.0 * math.pi))


def estimates_of(
    found: Sequence[SystemProbability],
    training: FloatArray,
    rest: FloatArray,
    rest_name: str,
    criteria: Sequence[Criterion],
    doubts: list[list[str]],
    runs: Sequence[DesignRuns],
    target_cov: float,
) -> list[Estimate]:
    """Estimates of criteria, and whether to believe them.

    Parameters
    ----------
    found
        Of each criterion.
    training, rest
        Errors (C,) of the reliability indices: what runs leave open, and what else does.
    rest_name
        What the latter are called.
    criteria, doubts
        The questions, and what is doubted about each answer.
    runs
        Those behind the surface of each kind.
    target_cov
        Largest stated error, relative to pf or to the reliability, of a ``converged`` row.
    """
    from scipy.special import ndtr

    beta, spread = reliability_indices(found), np.hypot(training, rest)
    std_error = change_of_pf(beta) * spread
    mostly = np.where(training >= rest, "training", rest_name).tolist()
    low, high = (ndtr(-beta + sign * _T95 * spread) for sign in (-1.0, 1.0))
    numbers = zip(std_error.tolist(), low.tolist(), high.tolist(), strict=True)
    return [
        _estimate(one, *errors, criterion, own, part, runs, target_cov)
        for one, errors, criterion, own, part in zip(
            found, numbers, criteria, doubts, mostly, strict=True
        )
    ]


def _estimate(
    found: SystemProbability,
    std_error: float,
    low: float,
    high: float,
    criterion: Criterion,
    doubts: list[str],
    mostly: str,
    runs: Sequence[DesignRuns],
    target_cov: float,
) -> Estimate:
    certain = found.pf in (0.0, 1.0)
    # what the surface says about its own error says nothing about what it does not describe
    if certain:
        doubts = [*doubts, f"pf = {found.pf:g} is the surface's: no run says what lies beyond it"]
    unknown = bool(doubts) or not all(one.complete for one in runs)
    if not (certain or unknown) and std_error > target_cov * min(found.pf, found.reliability):
        doubts = [
            *doubts,
            f"the stated error, mostly of {mostly}, is above {100.0 * target_cov:.3g}% of pf or of "
            "the reliability",
        ]
    if unknown:
        std_error = low = high = math.nan
        certain = False
    made, asked = sum(one.y.size for one in runs), sum(one.asked for one in runs)
    stopped = runs[0].stopped
    exhausted = made < asked or bool(stopped)
    if exhausted:
        note = [f"{made} of the {asked} runs that the settings ask for"]
        note = [*note[made == asked :], *([stopped] if stopped else [])]
    failed = any(one.failed for one in runs)
    return Estimate(
        pf=found.pf,
        reliability=found.reliability,
        std_error=0.0 if certain else std_error,
        ci_low=found.pf if certain else min(low, found.pf),
        ci_high=found.pf if certain else max(high, found.pf),
        ci_kind="" if unknown else CI_KIND,
        pf_low=0.0 if failed else found.pf,
        pf_high=1.0 if failed else found.pf,
        error_kind="none" if unknown else "surrogate",
        status="doubtful" if doubts else "budget_exhausted" if exhausted else "converged",
        message="; ".join([*doubts, *(note if exhausted else [])]),
    )


def scatter_of_unit(responses: Sequence[ConditionalResponse], weights: FloatArray) -> float:
    """Typical standard deviation of one unit's response given the shared inputs."""
    scatter = []
    for response in responses:
        inside = response.distribution
        if isinstance(inside, TabulatedDistribution):
            scatter.append(float(np.ptp(inside.levels) / np.ptp(inside.scores)))
        else:
            scatter.append(inside.std if isinstance(inside, NormalDistribution) else 0.0)
    return float(weights @ np.array(scatter) / weights.sum())


def doubts_about_surface(runs: DesignRuns, validated: LeaveOneOut | None) -> list[str]:
    """Why no answer of this surface can be trusted."""
    doubts = []
    infinite = int(np.isinf(runs.y).sum())
    if infinite:
        doubts.append(
            f"{infinite} of {runs.y.size} responses are infinite; where the model gives such "
            "responses is known only from the nearest run"
        )
    if runs.failed:
        doubts.append("what the failed runs would have been may change the surface everywhere")
    scatter = float(runs.y[runs.finite].std())
    last_digit = float(np.spacing(np.abs(runs.y[runs.finite]).max()))
    if last_digit > _COARSE_DIGITS * scatter > 0.0:
        doubts.append(
            f"responses differ by {scatter:.2g}, and their last digit stands for {last_digit:.2g}: "
            "let the model give their difference from a constant"
        )
    if np.ptp(runs.y[runs.finite]) == 0.0:
        doubts.append("all runs gave the same response: where another one begins is not known")
    elif validated is not None and (share := missed_share(validated, runs)) > poor_share(runs):
        doubts.append(
            f"the surface predicts runs left out only to {share:.0%} of the responses' spread"
        )
    return doubts
