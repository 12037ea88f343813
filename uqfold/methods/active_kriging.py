"""Active-learning Kriging: a Gaussian process that asks for the runs that its answers hang on.

Units of one kind, and missions, share one response surface over the inputs of one unit, so one
process for each kind is learned and all criteria are read off them. The loop is made of separate
parts: a first design (`surrogates.designs`), candidates that gather where the surfaces decide the
answers (`surrogates.importance_cloud`, `system.influence`), a learning function that picks a batch
of them (`surrogates.learning`), a stopping rule (`active_stopping`) with an independent check
(`active_check`), and the integration over the surfaces (`active_answers`, `response_surface`),
which reaches rare events without sampling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, get_args

import numpy as np

from uqfold.checks import choice, keep, or_none, real, refused, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.active_answers import answered, hidden_errors
from uqfold.methods.active_check import (
    Check,
    check_points,
    error_factor,
    learnable,
    unvisited,
)
from uqfold.methods.active_question import Question
from uqfold.methods.active_stopping import Stability
from uqfold.methods.active_view import View
from uqfold.methods.arguments import certain_under_tau
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.design_runs import (
    DesignRuns,
    affordable_runs,
    design_runs,
    runs_of_kinds,
    sorted_out,
)
from uqfold.methods.growing_design import Growth, divided, first_runs
from uqfold.methods.result import TARGET_COV
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_surfaces import ACTIVE_KRIGING
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import (
    checked_noise,
)
from uqfold.surrogates.kernel_choice import KernelFits
from uqfold.surrogates.kernels import Kernel, KernelChoice
from uqfold.surrogates.learning import LearningFunction
from uqfold.surrogates.selection import MANY_INPUTS
from uqfold.typing import FloatArray

MAX_RUNS = 1_000
"""Ceiling on the training size: every step of learning costs its cube."""
# Steps of learning in which grown runs, and those of many inputs, are spent at most, about.
_STEPS_TO_DOUBLE = 12
# Share of the runs with which the first check looks further out.
_OUTLYING = 0.1
# Shortfall, at least, of what has not become stable or not passed its check.
_UNSETTLED = 1.5
# Largest part of a reliability index that the surface may hide: 3 % of pf at 1e-2, 5 % at 1e-6.
_HIDDEN = 0.01
# Most runs all around in a check, of each kind.
_AROUND = 50


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
    that no run at the limit meets. Those that it does not learn show by how many times its stated
    error the surface errs: what so large an error may hide is looked for, and is a part of the
    error that is stated in the end. A region of which no run tells stays unknown.

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
        why = super().supports(problem, criterion) or certain_under_tau(problem, criterion)
        kinds = problem.kinds
        if why is None and len(kinds.models) > 1 and min(i.n_individual for i in kinds.inputs) == 0:
            return (
                f"{self.name} learns of several kinds of units from what is their own, and some "
                "share all of their inputs: let one model return what the structure makes of them"
                if kinds.n_individual == 0
                else f"{self.name} learns of several kinds of units from what is their own, and "
                "some share all of their inputs, others do not: ask 'kriging'"
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
        hidden = np.zeros(1)
        batch, grown, aside = self.batch * count, False, 0
        if max(dimensions) >= MANY_INPUTS:
            batch = max(batch, total // _STEPS_TO_DOUBLE)

        def answer(why: str) -> tuple[Solution, float]:
            return answered(
                task, runs, stability, checks, last, hidden, why, rng,
                target_cov=self.target_cov, noise=self.noise,
            )  # fmt: skip

        while True:
            for kind, own in enumerate(known):
                if not own.fittable:
                    return own.without_surface(task, kinds.said(kind, task.problem.unit_names))
            try:
                view = self._view(task, known, fits, checks, rng)
            except TimeLimitError as error:
                stopped = str(error)
                # what was learned before is an answer
                if stability.views:
                    return answer(stopped)[0]
                view = self._view(task, known, fits, checks, rng)
            runs, last = known, nothing
            stability.views.append(view)
            if stopped:
                return answer(stopped)[0]
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
                            check_points(one, self.controls, n, some, rng)
                            for one, n, some in zip(view.kinds, outliers, around, strict=True)
                        ]
                    else:
                        new = self._next(view, runs, min(batch, left), rng)
                    met = yield from runs_of_kinds(task, new)
                except TimeLimitError as error:
                    met = sorted_out(new, error.responses)
                    last = list(zip(new, met, strict=True))
                    return answer(str(error))[0]
                last = list(zip(new, met, strict=True))
            if check_now:
                stability.looked()
                last = [
                    learnable(kind, own, *pair, some, self.controls, self.tolerance)
                    for kind, own, pair, some in zip(view.kinds, checks, last, around, strict=True)
                ]
                aside += sum(len(u) for u in new) - sum(len(u) for u, _ in last)
            passed = check_now and all(own[-1].passed for own in checks)
            if left == 0 or passed:
                hidden = hidden_errors(view, checks, rng)
                # what the surface may hide is looked for where there are runs for it
                passed = passed and (hidden.max() <= _HIDDEN or total - made - aside < batch)
            if left == 0 or passed:
                found, shortfall = answer(stability.unfinished(checks) if left == 0 else "")
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

    @staticmethod
    def _view(
        task: Task,
        runs: Sequence[DesignRuns],
        fits: Sequence[KernelFits],
        checks: Sequence[Sequence[Check]],
        rng: np.random.Generator,
    ) -> View:
        """Fit a process to the runs of each kind and look at them."""
        processes = [
            fit.fit(own.u[own.finite], own.y[own.finite])
            for fit, own in zip(fits, runs, strict=True)
        ]
        factors = [error_factor(one, own) for one, own in zip(processes, checks, strict=True)]
        return View.of(processes, Question.of(task, runs), rng, factors)

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
