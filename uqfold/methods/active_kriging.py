"""Active-learning Kriging: a Gaussian process that asks for the runs that its answers hang on.

Units and missions share one response surface over the inputs of one unit, so one process is
learned and all criteria are read off it. The loop is made of separate parts: a first design
(`surrogates.designs`), candidates that gather where the surface decides the answers
(`surrogates.importance_cloud`, `system.influence`), a learning function that picks a batch of
them (`surrogates.learning`), a stopping rule with an independent check (`active_stopping`), and
the integration over the surface (`response_surface`), which reaches rare events without sampling.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, get_args

import numpy as np

from uqfold.checks import choice, keep, or_none, real, refused, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.active_question import Question
from uqfold.methods.active_stopping import (
    Check,
    Outlying,
    Stability,
    control_points,
    outlying_points,
    unvisited,
)
from uqfold.methods.active_view import View
from uqfold.methods.ask_tell import SequentialMethod, Steps
from uqfold.methods.base import Solution, Task
from uqfold.methods.design_runs import DesignRuns, affordable_runs, design_runs
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import Growth, first_runs
from uqfold.methods.response_surface import ErrorParts, surface_estimates
from uqfold.methods.result import NO_ANSWER, TARGET_COV, Estimate
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_surfaces import ACTIVE_KRIGING
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import (
    GaussianProcess,
    checked_noise,
    fit_gaussian_process,
)
from uqfold.surrogates.kernel_choice import KernelFits
from uqfold.surrogates.kernels import Kernel, KernelChoice
from uqfold.surrogates.learning import LearningFunction
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.system.surface_rule import MAX_POINTS
from uqfold.typing import FloatArray, IntArray

MAX_RUNS = 1_000
"""Ceiling on the training size: every step of learning costs its cube."""
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
# Steps of learning in which grown runs are spent at most, about.
_STEPS_TO_DOUBLE = 12
# Share of the runs with which the first check looks further out.
_OUTLYING = 0.1


@dataclass(frozen=True, eq=False)
class ActiveKrigingDetails:
    """How active learning went.

    Attributes
    ----------
    surface
        The trained Gaussian process, with training points, hyperparameters, `mean` and `std`.
    history_runs
        Training runs (S,) at each step of learning.
    history_beta, history_std
        Reliability indices (S, C), cut at +-8, and their stated standard deviations: of all
        criteria, or of 200 spread among more.
    checks
        The checks by runs kept out of the training set. The runs of a check that failed have
        joined it afterwards.
    errors
        Where the stated errors come from.
    """

    surface: GaussianProcess
    history_runs: IntArray
    history_beta: FloatArray
    history_std: FloatArray
    checks: tuple[Check, ...]
    errors: ErrorParts

    @classmethod
    def of(
        cls,
        surface: GaussianProcess,
        stability: Stability,
        checks: Sequence[Check],
        errors: ErrorParts,
    ) -> ActiveKrigingDetails:
        """Gather what the loop has seen."""
        views = stability.views
        return cls(
            surface=surface,
            history_runs=np.array([view.process.y.size for view in views], dtype=np.int64),
            history_beta=np.array([view.beta for view in views]),
            history_std=np.array([view.beta_std for view in views]),
            checks=tuple(checks),
            errors=errors,
        )


@dataclass(frozen=True)
class ActiveKriging(SequentialMethod):
    """Kriging that chooses its own runs, for all criteria at once, and has itself checked.

    It is ``converged`` only if no reliability index has moved by more than `tolerance` over two
    steps, none is stated to be less certain than that, and `controls` runs kept out of the
    training set agree with the surface. Otherwise it learns on, until `runs` are spent. The first
    check also looks further out, with at most a tenth of the runs: beyond the most important point
    and on both sides along each input. A threshold that is crossed there where the surface was sure
    of the other side, or much nearer than it says, makes its rows ``doubtful``; where it was not
    sure it learns. A region that no run enters stays unknown.

    Attributes
    ----------
    runs
        Most evaluations, control runs included; fewer if the budget allows fewer. More than
        1,000 are `unsupported`. None: 100, or five for each input if that is more; where a budget
        is given that allows more, they are doubled as long as the stated error is above its
        target and this may help.
    initial
        Runs of the first design; None: three for each input, at least 12. Never fewer than a
        fit needs, which is two for each input and two more.
    batch
        Runs of each step, which may be made in parallel.
    explore
        How many of them go where no run has been yet, whatever the surface says: they find
        failure regions that it knows nothing of. None: one, and none where a batch is one run.
    learning
        ``variance``: the runs that reduce the posterior variance of the answers most. ``u`` and
        ``eff``: the classical functions U and EFF; they know levels only, so that rows with a
        synchronization threshold count through T alone.
    kernel
        ``gaussian`` for smooth models, ``matern52`` for rougher ones; ``best`` fits both and
        keeps the one that predicts left-out runs better without being too sure of itself.
    noise
        Standard deviation of what the model does at the smallest scale, in the unit of the
        response; None learns it. It counts as a part of the response.
    tolerance
        Change of a reliability index -Phi^-1(pf) that does not matter: 0.005 is 1.3 % of pf at
        1e-2 and 2.5 % at 1e-6.
    controls
        Runs of each check near the answers.
    target_cov
        Stated error, relative to pf or to the reliability, whichever is smaller, that is aimed for:
        a row that states more is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    name: ClassVar[str] = "active-kriging"
    title: ClassVar[str] = "active Kriging"
    theory: ClassVar[Theory] = ACTIVE_KRIGING
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    adaptive: ClassVar[bool] = True

    runs: int | None = None
    initial: int | None = None
    batch: int = 6
    explore: int | None = None
    learning: LearningFunction = "variance"
    kernel: KernelChoice = "best"
    noise: float | None = None
    tolerance: float = 0.005
    controls: int = 6
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        for name, least in {"batch": 1, "controls": 2}.items():
            keep(self, name, whole, at_least=least)
        keep(self, "runs", or_none, whole, at_least=1)
        keep(self, "initial", or_none, whole, at_least=2)
        explore = min(1, self.batch - 1)
        if self.explore is not None:
            explore = whole("explore", self.explore, at_least=0)
        if explore >= self.batch:
            raise refused("explore", explore, f"give less than batch = {self.batch}")
        object.__setattr__(self, "explore", explore)
        keep(self, "learning", choice, get_args(LearningFunction))
        keep(self, "kernel", choice, get_args(KernelChoice))
        keep(self, "noise", or_none, checked_noise)
        keep(self, "tolerance", real, above=0.0, below=1.0)
        keep(self, "target_cov", real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: design, candidates and control runs are drawn."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Refuse more training runs than the steps of learning can bear."""
        if self.runs is not None and self.runs > MAX_RUNS:
            return f"runs = {self.runs}: {self.name} takes at most {MAX_RUNS} training runs"
        return super().supports(problem, criterion)

    def _steps(self, task: Task) -> Steps:
        inputs, rng = task.problem.inputs, task.generator()
        least = 2 * inputs.dimension + 2
        asked = first_runs(self.runs, inputs.dimension, MAX_RUNS)
        total = affordable_runs(task, asked, least)
        growth = Growth.of(task, self.runs, total, MAX_RUNS)
        first = max(12, 3 * inputs.dimension) if self.initial is None else max(self.initial, least)
        u = space_filling_design(min(first, total), inputs.dimension, rng)
        [design] = yield from design_runs(task, [u], [asked], [least])
        runs, u, y = design, design.u, design.y
        kernels: tuple[Kernel, ...]
        kernels = ("gaussian", "matern52") if self.kernel == "best" else (self.kernel,)
        fits = KernelFits(kernels, self.noise)
        stability, checks, stopped = Stability(self.tolerance), list[Check](), ""
        new, met = np.empty((0, inputs.dimension)), np.empty(0)
        batch, unchecked, aside = self.batch, 0, 0
        while True:
            known = DesignRuns(u, y, y.size)
            if not known.fittable:
                return known.without_surface(task)
            try:
                view = self._view(task, known, fits, rng)
            except TimeLimitError as error:
                stopped = str(error)
                # what was learned before is an answer
                if stability.views:
                    return self._answered(task, runs, stability, checks, (new, met), stopped, rng)[
                        0
                    ]
                view = self._view(task, known, fits, rng)
            runs = known
            stability.views.append(view)
            new, met = np.empty((0, inputs.dimension)), np.empty(0)
            if stopped:
                return self._answered(task, runs, stability, checks, (new, met), stopped, rng)[0]
            if task.session.watched:
                task.session.report(view.running())
            left = total - y.size - aside
            outliers = 0 if checks else min(2 * inputs.dimension + 1, int(_OUTLYING * total))
            affordable = left >= self.controls + outliers
            check_now = stability.reached and affordable and y.size >= unchecked
            if left > 0:
                try:
                    if check_now:
                        near = control_points(view, self.controls, rng)
                        new = np.concatenate([near, outlying_points(view, outliers)])
                    else:
                        new = self._next(view, runs, min(batch, left), rng)
                    met = yield inputs.from_standard_normal(new)
                except TimeLimitError as error:
                    last = new, error.responses
                    return self._answered(task, runs, stability, checks, last, str(error), rng)[0]
            if check_now:
                k = self.controls
                further = Outlying.of(view, new[k:], met[k:])
                checks.append(Check.of(view, new[:k], met[:k], self.tolerance, further))
                # those further out that agree would teach nothing of what is near
                agree = k + np.flatnonzero(~further.missed(view.question.levels))
                aside += agree.size
                new, met = np.delete(new, agree, axis=0), np.delete(met, agree)
            if left == 0 or (check_now and checks[-1].passed):
                why = stability.unfinished(checks) if left == 0 else ""
                found, shortfall = self._answered(
                    task, runs, stability, checks, (new, met), why, rng
                )
                more = growth.next_size(y.size + met.size + aside, shortfall)
                if more is None:
                    return found
                more = max(more, total)
                task.session.expect(more)
                total, unchecked = more, more - self.controls
                batch = max(batch, more // _STEPS_TO_DOUBLE)
                if left == 0:
                    # the same runs will be looked at once more
                    stability.views.pop()
            u, y = np.concatenate([u, new]), np.concatenate([y, met])

    def _answered(
        self,
        task: Task,
        runs: DesignRuns,
        stability: Stability,
        checks: Sequence[Check],
        last: tuple[FloatArray, FloatArray],
        why: str,
        rng: np.random.Generator,
    ) -> tuple[Solution, float]:
        """Answer from what was learned of `runs`, and tell how far the error is from its target.

        The `last` runs, of a check that has passed or not learned from in time, do not belong to
        the surface; those that no surface describes speak against it all the same. Learning stops
        where the posterior looks certain, which is also where it is by chance: so the stated error
        contains how far the answers have moved in the last steps.
        """
        new, met = last
        view = stability.views[-1]
        surface = view.process
        beyond = np.flatnonzero(~np.isfinite(met))
        runs = DesignRuns(
            np.concatenate([runs.u, new[beyond]]),
            np.concatenate([runs.y, met[beyond]]),
            runs.asked + beyond.size,
        )
        trust = [surface.leave_one_out().ratio, *(check.overconfidence for check in checks[-1:])]
        found = surface_estimates(
            task,
            [FittedKind(surface, runs, surface.noise_std, _rivals(task, surface, checks))],
            rng,
            target_cov=self.target_cov,
            max_points=min(MAX_POINTS, _MOST_CORRELATIONS // runs.y.size),
            beta_std=view.question.for_all(
                np.hypot(max(1.0, *trust) * view.beta_std, stability.moved)
            ),
            stated_noise=self.noise,
        )  # fmt: skip
        estimates = [
            _qualified(estimate, why, _doubts(criterion, surface, checks))
            for criterion, estimate in zip(task.criteria, found.estimates, strict=True)
        ]
        details = ActiveKrigingDetails.of(surface, stability, checks, found.errors)
        return Solution(estimates, details), found.shortfall

    @staticmethod
    def _view(task: Task, runs: DesignRuns, fits: KernelFits, rng: np.random.Generator) -> View:
        """Fit a process to the runs and look at it."""
        fit = fits.fit(runs.u[runs.finite], runs.y[runs.finite])
        return View.of(fit, Question.of(task, runs), rng)

    def _next(
        self, view: View, runs: DesignRuns, size: int, rng: np.random.Generator
    ) -> FloatArray:
        """Choose the runs (size, d) of the next step."""
        explored = min(self.explore or 0, size - 1)
        u, candidates = view.candidates(rng)
        chosen = u[candidates.batch(self.learning, size - explored)]
        # fewer candidates than wanted leave room for exploration
        known = np.concatenate([runs.u, chosen])
        return np.concatenate([chosen, unvisited(view, known, size - chosen.shape[0], rng)])


def _rivals(task: Task, surface: GaussianProcess, checks: Sequence[Check]) -> list[Rival]:
    """Fit other surfaces to the same runs: with the trend of a sparse expansion, another kernel.

    What the runs leave open shows where these disagree, also where the process trusts itself.
    A rival counts the less, the worse it foretells the runs of the last check.
    """
    u, y, noise = surface.u, surface.y, surface.noise_std
    kernel: Kernel = "matern52" if surface.kernel == "gaussian" else "gaussian"
    try:
        trend = fit_polynomial_chaos(u, y).indices
        others = [
            fit_gaussian_process(u, y, noise=noise, trend=trend, rng=task.generator(2)),
            fit_gaussian_process(
                u, y, noise=noise, trend=surface.trend, kernel=kernel, rng=task.generator(2)
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


def _doubts(criterion: Criterion, surface: GaussianProcess, checks: Sequence[Check]) -> list[str]:
    """Why an answer should not be believed although the surface has passed its check."""
    doubts = []
    level = np.array([criterion.threshold])
    against = sum(int(check.outlying.against(level).sum()) for check in checks)
    if against:
        doubts.append(
            f"{against} of {sum(check.outlying.y.size for check in checks)} runs further out lie "
            "on the other side of the threshold, or nearer to it, than the surface was sure of: "
            "where that begins no run tells"
        )
    wrong = _on_the_wrong_side(criterion.threshold, surface)
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
    if criterion.tau is None and math.isfinite(criterion.threshold):
        near = _NEAR * float(np.ptp(surface.y))
        if not surface.y.min() - near <= criterion.threshold <= surface.y.max() + near:
            doubts.append("no run has come near the threshold: pf is an extrapolation")
    return doubts


def _on_the_wrong_side(threshold: float, surface: GaussianProcess) -> int:
    """How many training runs the surface puts on the wrong side of a threshold.

    Those that it misses by its noise do not count, nor by little as distances to the threshold go.
    """
    if not math.isfinite(threshold):
        return 0
    fitted = surface.mean(surface.u)
    little = _LITTLE * float(np.median(np.abs(surface.y - threshold)))
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
