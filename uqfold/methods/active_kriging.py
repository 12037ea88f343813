"""Active-learning Kriging: a Gaussian process that asks for the runs that its answers hang on.

Units of one kind, and missions, share one response surface over the inputs of one unit, so one
process for each kind is learned and all criteria are read off them. The loop is made of separate
parts: a first design (`surrogates.designs`), candidates that gather where the surfaces decide the
answers (`surrogates.importance_cloud`, `system.influence`), a learning function that picks a batch
of them (`surrogates.learning`), a stopping rule with an independent check (`active_stopping`), and
the integration over the surfaces (`response_surface`), which reaches rare events without sampling.
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
    points_around,
    unvisited,
)
from uqfold.methods.active_view import KindView, View
from uqfold.methods.arguments import without_own_inputs
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.design_runs import (
    DesignRuns,
    affordable_runs,
    design_runs,
    runs_of_kinds,
    sorted_out,
)
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import STREAMS, Growth, divided, first_runs
from uqfold.methods.response_surface import ErrorParts, surface_estimates
from uqfold.methods.result import NO_ANSWER, TARGET_COV, Estimate
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.task import Solution, Task
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
from uqfold.surrogates.selection import MANY_INPUTS
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
# Share of an answer from which units whose limit no run has come near make it an extrapolation.
_AT_STAKE = 0.01
# Steps of learning in which grown runs, and those of many inputs, are spent at most, about.
_STEPS_TO_DOUBLE = 12
# Share of the runs with which the first check looks further out.
_OUTLYING = 0.1
# Shortfall, at least, of what has not become stable or not passed its check.
_UNSETTLED = 1.5
# Most runs all around in a check, of each kind.
_AROUND = 50


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


@dataclass(frozen=True)
class ActiveKriging(SequentialMethod):
    """Kriging that chooses its own runs, for all criteria at once, and has itself checked.

    Units of several kinds, which have models or inputs of their own, have a surface each; the next
    runs are those that tell most about the system, of whichever kind.
    It is ``converged`` only if no reliability index has moved by more than `tolerance` over two
    steps, none is stated to be less certain than that, and `controls` runs kept out of the
    training set agree with the surface. Otherwise it learns on, until `runs` are spent. The first
    check also looks further out, with at most a tenth of the runs: beyond the most important point
    and on both sides along each input. A threshold that is crossed there where the surface was sure
    of the other side, or much nearer than it says, makes its rows ``doubtful``; where it was not
    sure it learns. Up to 50 runs all around, evenly along each input, look for ridges and regions
    that no run at the limit meets. A region that no run enters stays unknown.

    Attributes
    ----------
    runs
        Most evaluations of all kinds of units together, control runs included; fewer if the budget
        allows fewer. More than 1,000 are `unsupported`. None: for each kind 100, or five for each
        input if that is more; where a budget is given that allows more, they are doubled as long
        as the stated error is above its target and this may help.
    initial
        Runs of the first design of each kind; None: three for each input, at least 12. Never fewer
        than a fit needs, which is two for each input and two more.
    batch
        Runs of each step, which may be made in parallel; so many times the number of kinds, more
        where runs have been doubled, and from 20 inputs on.
    explore
        How many of them, for each kind, go where no run has been yet, whatever the surface says:
        they find failure regions that it knows nothing of. None: one, and none where a batch is
        one run.
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
        Runs of each check near the answers, for each kind.
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
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
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
        """Refuse more training runs than learning can bear, and units that have no surface."""
        if self.runs is not None and self.runs > MAX_RUNS:
            return f"runs = {self.runs}: {self.name} takes at most {MAX_RUNS} training runs"
        why = super().supports(problem, criterion) or without_own_inputs(problem, criterion)
        kinds = problem.kinds
        if why is None and len(kinds.models) > 1 and kinds.n_individual == 0:
            return (
                f"{self.name} learns of several kinds of units from what is their own, and these "
                "share all of their inputs: let one model return what the structure makes of them"
            )
        return why

    def _steps(self, task: Task) -> Steps:
        kinds, rng = task.problem.kinds, task.generator()
        count, dimensions = len(kinds.inputs), [inputs.dimension for inputs in kinds.inputs]
        least = [2 * d + 2 for d in dimensions]
        needed = [first_runs(None, d, MAX_RUNS) for d in dimensions]
        asked = min(sum(needed), MAX_RUNS) if self.runs is None else self.runs
        total = affordable_runs(task, asked, sum(least))
        growth, first_total = Growth.of(task, self.runs, total, MAX_RUNS), total
        first = [
            max(12, 3 * d) if self.initial is None else max(self.initial, few)
            for d, few in zip(dimensions, least, strict=True)
        ]
        sizes = divided(min(sum(first), total), first, least)
        design = [space_filling_design(n, d, rng) for n, d in zip(sizes, dimensions, strict=True)]
        known = yield from design_runs(task, design, sizes, least)
        kernels: tuple[Kernel, ...]
        kernels = ("gaussian", "matern52") if self.kernel == "best" else (self.kernel,)
        fits = [KernelFits(kernels, self.noise) for _ in dimensions]
        stability, stopped = Stability(self.tolerance), ""
        checks: list[list[Check]] = [[] for _ in dimensions]
        nothing = [(np.empty((0, d)), np.empty(0)) for d in dimensions]
        runs, last = known, nothing
        batch, grown, aside = self.batch * count, False, 0
        if max(dimensions) >= MANY_INPUTS:
            batch = max(batch, total // _STEPS_TO_DOUBLE)

        def answered(why: str) -> tuple[Solution, float]:
            return self._answered(task, runs, stability, checks, last, why, rng)

        while True:
            for kind, own in enumerate(known):
                if not own.fittable:
                    return own.without_surface(task, kinds.said(kind, task.problem.unit_names))
            try:
                view = self._view(task, known, fits, rng)
            except TimeLimitError as error:
                stopped = str(error)
                # what was learned before is an answer
                if stability.views:
                    return answered(stopped)[0]
                view = self._view(task, known, fits, rng)
            runs, last = known, nothing
            stability.views.append(view)
            if stopped:
                return answered(stopped)[0]
            if task.session.watched:
                task.session.report(view.running())
            made = sum(own.y.size for own in runs)
            outliers = [
                0 if own else min(2 * d + 1, int(_OUTLYING * total / count))
                for own, d in zip(checks, dimensions, strict=True)
            ]
            least_check = count * self.controls + sum(outliers)
            # a check may go beyond what is learned from, where the budget does
            rest = max(total, growth.most) - made - aside - least_check
            # runs that were asked for because of the error are spent before another check
            spent_soon = total - made - aside - least_check < batch
            check_now = stability.reached and rest >= 0 and (spent_soon or not grown)
            # half of the rest, so that there may be another check after one that has failed
            share = min(_AROUND, max(rest, 0) // (2 * count))
            around = [share if stability.looks_around(own) else 0 for own in checks]
            if check_now and (size := made + aside + least_check + sum(around)) > total:
                total = size
                task.session.expect(total)
            left = total - made - aside
            if left > 0:
                new = [u for u, _ in nothing]
                try:
                    if check_now:
                        new = [
                            np.concatenate(
                                [
                                    control_points(one, self.controls, rng),
                                    outlying_points(one, n),
                                    points_around(one, some, rng),
                                ]
                            )
                            for one, n, some in zip(view.kinds, outliers, around, strict=True)
                        ]
                    else:
                        new = self._next(view, runs, min(batch, left), rng)
                    met = yield from runs_of_kinds(task, new)
                except TimeLimitError as error:
                    met = sorted_out(new, error.responses)
                    last = list(zip(new, met, strict=True))
                    return answered(str(error))[0]
                last = list(zip(new, met, strict=True))
            if check_now:
                stability.looked()
                last = [
                    self._learnable(kind, own, *pair, some)
                    for kind, own, pair, some in zip(view.kinds, checks, last, around, strict=True)
                ]
                aside += sum(len(u) for u in new) - sum(len(u) for u, _ in last)
            passed = check_now and all(own[-1].passed for own in checks)
            if left == 0 or passed:
                found, shortfall = answered(stability.unfinished(checks) if left == 0 else "")
                spent = made + sum(met.size for _, met in last) + aside
                unsettled = any(one.status == "budget_exhausted" for one in found.estimates)
                if unsettled and made <= first_total:
                    # as many runs again may settle it
                    shortfall = max(shortfall, _UNSETTLED)
                more = growth.next_size(spent, shortfall)
                if more is None:
                    return found
                more = max(more, total)
                task.session.expect(more)
                total, grown = more, True
                batch = max(batch, more // _STEPS_TO_DOUBLE)
                if left == 0:
                    # the same runs will be looked at once more
                    stability.views.pop()
            known = [own.with_more(*pair) for own, pair in zip(runs, last, strict=True)]

    def _learnable(
        self, kind: KindView, checks: list[Check], u: FloatArray, y: FloatArray, around: int
    ) -> tuple[FloatArray, FloatArray]:
        """Add the check of one kind by runs (m, d), (m,); and return those that may be learned.

        Those further out, and the last ones, all `around`, that agree would teach nothing.
        """
        k, end = self.controls, y.size - around
        further = Outlying.of(kind, u[k:end], y[k:end])
        beside = Outlying.of(kind, u[end:], y[end:])
        check = Check.of(kind, u[:k], y[:k], self.tolerance, further, beside)
        checks.append(check)
        telling = [np.ones(k, dtype=bool), further.missed(kind.answers.levels), check.misled]
        kept = np.concatenate(telling)
        return u[kept], y[kept]

    def _answered(
        self,
        task: Task,
        runs: Sequence[DesignRuns],
        stability: Stability,
        checks: Sequence[Sequence[Check]],
        last: Sequence[tuple[FloatArray, FloatArray]],
        why: str,
        rng: np.random.Generator,
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
        largest = max(one.runs.y.size for one in fitted)
        found = surface_estimates(
            task, fitted, rng,
            target_cov=self.target_cov,
            max_points=min(MAX_POINTS, _MOST_CORRELATIONS // largest),
            beta_std=view.question.for_all(np.hypot(max(trust) * view.beta_std, stability.moved)),
            stated_noise=self.noise,
        )  # fmt: skip
        estimates = []
        for row, (criterion, estimate) in enumerate(
            zip(task.criteria, found.estimates, strict=True)
        ):
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

    @staticmethod
    def _view(
        task: Task, runs: Sequence[DesignRuns], fits: Sequence[KernelFits], rng: np.random.Generator
    ) -> View:
        """Fit a process to the runs of each kind and look at them."""
        processes = [
            fit.fit(own.u[own.finite], own.y[own.finite])
            for fit, own in zip(fits, runs, strict=True)
        ]
        return View.of(processes, Question.of(task, runs), rng)

    def _next(
        self, view: View, runs: Sequence[DesignRuns], size: int, rng: np.random.Generator
    ) -> list[FloatArray]:
        """Choose the runs (size, d) of the next step, of all kinds together."""
        count = len(runs)
        explored = min((self.explore or 0) * count, size - 1)
        chosen = view.next_runs(self.learning, size - explored, rng)
        # fewer candidates than wanted leave room for exploration, in which kinds take turns
        rest = size - sum(len(points) for points in chosen)
        found = []
        for place, (kind, own, points) in enumerate(zip(view.kinds, runs, chosen, strict=True)):
            share = rest // count + (place < rest % count)
            known = np.concatenate([own.u, points])
            found.append(np.concatenate([points, unvisited(kind, known, share, rng)]))
        return found


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
