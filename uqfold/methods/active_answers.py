"""What active learning answers: estimates from its surfaces, and whether to believe them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.active_check import Check, error_factor
from uqfold.methods.active_stopping import Stability
from uqfold.methods.active_view import View
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import STREAMS
from uqfold.methods.response_surface import ErrorParts, surface_estimates
from uqfold.methods.result import NO_ANSWER, Estimate
from uqfold.methods.task import Solution, Task
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.surrogates.kernels import Kernel
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.system.surface_rule import MAX_POINTS
from uqfold.typing import FloatArray, IntArray

# Evaluations of the correlation function that an integration over the surface may cost.
_MOST_CORRELATIONS = 40_000_000
# Length scales shorter than this many standard deviations of an input mean a jump or a wiggle.
_ROUGH = 0.3
# A threshold is near to the runs when it lies beyond them by less than this share of their range.
_NEAR = 0.1
# A run further from the surface than this many standard deviations of its noise was not followed.
_FAR = 4.0
# A miss by less than this share of the runs' median distance to the threshold is little.
_LITTLE = 0.1
# Share of an answer from which units whose limit no run has come near make it an extrapolation.
_AT_STAKE = 0.01


@dataclass(frozen=True, eq=False)
class ActiveKrigingDetails:
    """How active learning went.

    Attributes
    ----------
    surface
        The trained Gaussian process, with training points, hyperparameters, `mean` and `std`.
    history_runs
        Training runs (S,) at each step of learning, of all kinds of units together.
    history_beta, history_std
        Reliability indices (S, C), cut at +-8, and their stated standard deviations: of all
        criteria, or of 200 spread among more.
    checks
        The checks by runs kept out of the training set. The runs of a check that failed have
        joined it afterwards.
    errors
        Where the stated errors come from.
    of_other_kinds
        The same for the surfaces of other kinds of units, in the order in which they occur.
    """

    surface: GaussianProcess
    history_runs: IntArray
    history_beta: FloatArray
    history_std: FloatArray
    checks: tuple[Check, ...]
    errors: ErrorParts
    of_other_kinds: tuple[ActiveKrigingDetails, ...] = ()

    @classmethod
    def of(
        cls, stability: Stability, checks: Sequence[Sequence[Check]], errors: ErrorParts
    ) -> ActiveKrigingDetails:
        """Gather what the loop has seen, of each kind."""
        views = stability.views
        first, *others = (
            cls(
                surface=kind.process,
                history_runs=np.array([view.runs for view in views], dtype=np.int64),
                history_beta=np.array([view.beta for view in views]),
                history_std=np.array([view.beta_std for view in views]),
                checks=tuple(own),
                errors=errors,
            )
            for kind, own in zip(views[-1].kinds, checks, strict=True)
        )
        return replace(first, of_other_kinds=tuple(others))


def answered(
    task: Task,
    runs: Sequence[DesignRuns],
    stability: Stability,
    checks: Sequence[Sequence[Check]],
    last: Sequence[tuple[FloatArray, FloatArray]],
    hidden: FloatArray,
    why: str,
    rng: np.random.Generator,
    *,
    target_cov: float,
    noise: float | None,
) -> tuple[Solution, float]:
    """Answer from what was learned of `runs`, and tell how far the error is from its target.

    The `last` runs, of a check that has passed or not learned from in time, do not belong to
    the surfaces; those that no surface describes speak against them all the same. Learning
    stops where the posterior looks certain, which is also where it is by chance: so the stated
    error contains how far the answers have moved over the last steps.
    """
    view, kinds = stability.views[-1], task.problem.kinds
    trust, fitted = [1.0], []
    for place, (kind, made, own, (u, y)) in enumerate(
        zip(view.kinds, runs, checks, last, strict=True)
    ):
        surface, beyond = kind.process, np.flatnonzero(~np.isfinite(y))
        trust += [surface.leave_one_out().ratio, *(one.overconfidence for one in own[-1:])]
        behind = made.with_more(u[beyond], y[beyond])
        rivals = _rivals(task, place, surface, own)
        fitted.append(FittedKind(surface, behind, surface.noise_std, rivals))
    error = np.sqrt((max(trust) * view.beta_std) ** 2 + stability.moved**2 + hidden**2)
    largest = max(one.runs.y.size for one in fitted)
    found = surface_estimates(
        task, fitted, rng,
        target_cov=target_cov,
        max_points=min(MAX_POINTS, _MOST_CORRELATIONS // largest),
        beta_std=view.question.for_all(error),
        stated_noise=noise,
    )  # fmt: skip
    estimates = []
    for row, (criterion, estimate) in enumerate(zip(task.criteria, found.estimates, strict=True)):
        near = view.question.neighbours[:, row]
        doubts = [
            kinds.said(place, task.problem.unit_names) + doubt
            for place, (kind, own) in enumerate(zip(view.kinds, checks, strict=True))
            for doubt in _doubts(
                criterion,
                view.question.levels(criterion.threshold, place),
                kind.answers.stakes[near].max(axis=0),
                kind.process,
                own,
            )
        ]
        estimates.append(_qualified(estimate, why, doubts))
    return Solution(
        estimates, ActiveKrigingDetails.of(stability, checks, found.errors)
    ), found.shortfall


def hidden_errors(
    view: View, checks: Sequence[Sequence[Check]], rng: np.random.Generator
) -> FloatArray:
    """Errors (C,) of the indices by failures that the surfaces may hide.

    Runs all around that were not learned show how many times its stated error a surface errs.
    """
    found = [
        kind.hidden(error_factor(kind.process, own), rng)
        for kind, own in zip(view.kinds, checks, strict=True)
        if own
    ]
    return np.asarray(np.sum(found, axis=0)) if found else np.zeros(view.beta.size)


def _rivals(
    task: Task, place: int, surface: GaussianProcess, checks: Sequence[Check]
) -> list[Rival]:
    """Fit other surfaces to the same runs: with the trend of a sparse expansion, another kernel.

    What the runs leave open shows where these disagree, also where the process trusts itself.
    A rival counts the less, the worse it foretells the runs of the last check.
    """
    u, y, noise = surface.u, surface.y, surface.noise_std
    stream = 2 + place * STREAMS
    kernel: Kernel = "matern52" if surface.kernel == "gaussian" else "gaussian"
    try:
        trend = fit_polynomial_chaos(u, y).indices
        others = [
            fit_gaussian_process(u, y, noise=noise, trend=trend, rng=task.generator(stream)),
            fit_gaussian_process(
                u, y, noise=noise, trend=surface.trend, kernel=kernel, rng=task.generator(stream)
            ),
        ]
    except TimeLimitError:
        return []
    rivals = [Rival.by_prediction(surface, other) for other in others]
    if not checks:
        return rivals
    last = checks[-1]
    seen = np.isfinite(last.residuals)
    answers = surface.mean(last.u[seen]) + last.residuals[seen]
    own = float(np.abs(last.residuals[seen]).mean())
    missed = [float(np.abs(answers - one.mean(last.u[seen])).mean()) for one in rivals]
    return [
        replace(one, share=min(one.share, own / much if much > own else 1.0))
        for one, much in zip(rivals, missed, strict=True)
    ]


def _doubts(
    criterion: Criterion,
    levels: FloatArray,
    stakes: FloatArray,
    surface: GaussianProcess,
    checks: Sequence[Check],
) -> list[str]:
    """Why an answer should not be believed although a surface has passed its check.

    Parameters
    ----------
    criterion
        What was asked.
    levels, stakes
        Where units of each sort (S,) of this kind fail, and the share of the answer that goes with
        them.
    surface, checks
        The surface of this kind, and its checks.
    """
    doubts = []
    finite = levels[np.isfinite(levels)]
    against = sum(int(check.outlying.against(levels).sum()) for check in checks)
    if against:
        doubts.append(
            f"{against} of {sum(check.outlying.y.size for check in checks)} runs further out lie "
            "on the other side of the threshold, or nearer to it, than the surface was sure of: "
            "where that begins no run tells"
        )
    wrong = max((_on_the_wrong_side(level, surface) for level in finite.tolist()), default=0)
    if wrong:
        doubts.append(
            f"{wrong} of {surface.y.size} runs lie on the other side of the threshold than the "
            "surface fitted to them, which responses of very different size make too coarse there"
        )
    shortest = float(surface.hyperparameters.length_scales.min())
    if shortest < _ROUGH:
        doubts.append(
            f"the response changes within {shortest:.2g} standard deviations of an input, as if "
            "it jumped, which no smooth surface can follow"
        )
    if criterion.tau is None and finite.size:
        near = _NEAR * float(np.ptp(surface.y))
        beyond = (levels < surface.y.min() - near) | (levels > surface.y.max() + near)
        if (beyond & (stakes > _AT_STAKE)).any():
            doubts.append("no run has come near the threshold: pf is an extrapolation")
    return doubts


def _on_the_wrong_side(threshold: float, surface: GaussianProcess) -> int:
    """How many training runs the surface puts on the wrong side of a threshold.

    Those that it misses by its noise do not count, nor by little as distances to the threshold go.
    """
    if not math.isfinite(threshold):
        return 0
    fitted = surface.mean(surface.u)
    # halves, so that the sum of two of them is a number, too
    little = 2.0 * _LITTLE * float(np.median(0.5 * np.abs(surface.y - threshold)))
    missed = np.abs(surface.y - fitted) > max(_FAR * surface.noise_std, little)
    return int(np.count_nonzero(missed & ((fitted > threshold) != (surface.y > threshold))))


def _qualified(estimate: Estimate, unfinished: str, doubts: list[str]) -> Estimate:
    """Take ``converged`` away from an estimate where there is a reason, and say it."""
    reasons = [*doubts, unfinished] if unfinished else doubts
    if estimate.status in NO_ANSWER or not reasons:
        return estimate
    doubtful = doubts or estimate.status == "doubtful"
    if doubts:
        # what the surface says of its own error is not believed either
        unknown = math.nan
        estimate = replace(
            estimate, std_error=unknown, ci_low=unknown, ci_high=unknown, ci_kind="",
            error_kind="none",
        )  # fmt: skip
    return replace(
        estimate,
        status="doubtful" if doubtful else "budget_exhausted",
        message="; ".join([estimate.message, *reasons] if estimate.message else reasons),
    )
