"""Methods that each break one promise on purpose; the contract suite must reject them.

All start from a correct answer, mostly of Monte Carlo type, so that only the planted fault can be
what is found.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from uqfold.evaluation import EvaluationSession, FailedRunError, InProcess
from uqfold.methods import (
    Estimate,
    Kriging,
    MonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
    ReliabilityResult,
    Solution,
    Task,
)
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.kriging import KernelChoice, Trend
from uqfold.methods.steps import Steps
from uqfold.problems.criterion import Criterion
from uqfold.problems.structure import Series
from uqfold.typing import FloatArray

HONEST = MonteCarlo(systems=3000)


def answered(task: Task, model: Callable[[FloatArray], FloatArray]) -> Task:
    """Let another model answer before anybody counts or checks its responses."""
    task.session.pipeline.runner = InProcess().open(model, None)
    return task


def meddled(task: Task, change: Callable[[FloatArray], FloatArray]) -> Task:
    """Change the responses of the model before anybody counts or checks them."""
    model = task.problem.model
    return answered(task, lambda x: change(np.asarray(model(x))))


class _FromMonteCarlo(ReliabilityMethod):
    """Solve as `MonteCarlo` does, then spoil the answer."""

    name: ClassVar[str] = "planted"
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True

    @property
    def stochastic(self) -> bool:
        return True

    def _solve(self, task: Task) -> Solution:
        honest = HONEST._solve(self._task(task))
        return Solution([self._spoil(e) for e in honest.estimates], honest.details)

    def _task(self, task: Task) -> Task:
        return task

    def _spoil(self, estimate: Estimate) -> Estimate:
        return estimate


@dataclass(frozen=True)
class Honest(_FromMonteCarlo):
    """No fault: the control, which every check must pass."""


@dataclass(frozen=True)
class OverConfident(_FromMonteCarlo):
    """States half of its standard error."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(estimate, std_error=0.5 * estimate.std_error)


@dataclass(frozen=True)
class UnderConfident(_FromMonteCarlo):
    """Hides behind twice its standard error."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(estimate, std_error=2.0 * estimate.std_error)


@dataclass(frozen=True)
class Biased(_FromMonteCarlo):
    """Gives half of pf, with a matching error."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        if not np.isfinite(estimate.std_error):
            return estimate
        pf = 0.5 * estimate.pf
        return replace(
            estimate, pf=pf, pf_low=pf, pf_high=pf, reliability=1.0 - pf,
            std_error=0.7 * estimate.std_error, ci_low=0.5 * estimate.ci_low,
        )  # fmt: skip


@dataclass(frozen=True)
class AlwaysZero(_FromMonteCarlo):
    """Lets nothing ever fail."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(
            estimate, pf=0.0, pf_low=0.0, pf_high=0.0, reliability=1.0, std_error=0.0,
            ci_low=0.0, ci_high=0.0,
        )  # fmt: skip


@dataclass(frozen=True)
class ForgetsMissions(_FromMonteCarlo):
    """Answers every mission profile as if it were one mission."""

    def _task(self, task: Task) -> Task:
        return replace(task, criteria=tuple(replace(c, missions=1) for c in task.criteria))


@dataclass(frozen=True)
class ForgetsTau(_FromMonteCarlo):
    """Ignores the synchronization threshold."""

    def _task(self, task: Task) -> Task:
        return replace(task, criteria=tuple(replace(c, tau=None) for c in task.criteria))


@dataclass(frozen=True)
class ForgetsStructure(_FromMonteCarlo):
    """Answers as if every unit had to work."""

    def _task(self, task: Task) -> Task:
        problem = copy(task.problem)
        object.__setattr__(problem, "structure", Series())
        return replace(task, problem=problem)


@dataclass(frozen=True)
class StrictBoundary(_FromMonteCarlo):
    """Lets t = T fail."""

    def _task(self, task: Task) -> Task:
        below = [float(np.nextafter(c.threshold, -np.inf)) for c in task.criteria]
        criteria = [replace(c, threshold=t) for c, t in zip(task.criteria, below, strict=True)]
        return replace(task, criteria=tuple(criteria))


@dataclass(frozen=True)
class FixedSeed(_FromMonteCarlo):
    """Ignores the seed."""

    def _task(self, task: Task) -> Task:
        return replace(task, seed=0)


@dataclass(frozen=True)
class SurfaceOfOneSeed(PolynomialChaos):
    """A surface, exact on a linear system, that ignores the seed."""

    name: ClassVar[str] = "planted"
    runs: int = 40
    max_degree: int = 3

    def _steps(self, task: Task) -> Steps:
        return super()._steps(replace(task, seed=0))


@dataclass(frozen=True)
class SurfaceOfHiddenSeed(PolynomialChaos):
    """A surface, exact on a linear system, that depends on a seed without saying so."""

    name: ClassVar[str] = "planted"
    runs: int = 40
    max_degree: int = 3

    @property
    def stochastic(self) -> bool:
        return False


@dataclass(frozen=True)
class NeverAnswers(ReliabilityMethod):
    """Gives no number, so that all of its seeds agree."""

    name: ClassVar[str] = "planted"

    def _solve(self, task: Task) -> Solution:
        return Solution([Estimate.without_answer("failed", "planted")] * len(task.criteria))


@dataclass(frozen=True)
class HiddenSeedOfTheError(FFNIPearson):
    """The same pf with every seed, with an error that depends on it, without saying so."""

    name: ClassVar[str] = "planted"

    def _solve(self, task: Task) -> Solution:
        honest = super()._solve(task)
        error = 1e-3 + 1e-6 * task.seed
        return Solution(
            [replace(e, std_error=error, error_kind="sampling") for e in honest.estimates]
        )


@dataclass(frozen=True)
class ExactOnALinearSystem(PolynomialChaos):
    """No fault: a surface whose answers are shown without their last, accidental digits."""

    name: ClassVar[str] = "planted"
    runs: int = 40
    max_degree: int = 3

    def _steps(self, task: Task) -> Steps:
        honest = yield from super()._steps(task)
        rounded = [replace(e, pf=round(e.pf, 10), reliability=None) for e in honest.estimates]
        return Solution(rounded, honest.details)


@dataclass(frozen=True)
class GlobalRandomness(_FromMonteCarlo):
    """Takes its seed from NumPy's global generator."""

    def _task(self, task: Task) -> Task:
        return replace(task, seed=int(np.random.randint(2**31)))  # noqa: NPY002


_MEMORY: dict[str, int] = {}


@dataclass(frozen=True)
class RemembersRuns(_FromMonteCarlo):
    """Keeps state between runs."""

    def _task(self, task: Task) -> Task:
        _MEMORY["runs"] = _MEMORY.get("runs", 0) + 1
        return replace(task, seed=task.seed + _MEMORY["runs"])


@dataclass(frozen=True)
class BypassesTheCounter(_FromMonteCarlo):
    """Calls the model behind the counter's back."""

    def _task(self, task: Task) -> Task:
        task.problem.model(np.zeros((5, task.problem.inputs.dimension)))
        return task


@dataclass(frozen=True)
class CountsBatches(_FromMonteCarlo):
    """Reports one evaluation for each call of the model, however many rows it has."""

    def estimate(self, *given: Any, **options: Any) -> ReliabilityResult:
        found = super().estimate(*given, **options)
        return replace(found, rows=tuple(replace(row, n_evals=1) for row in found))


_LAST: list[ReliabilityResult] = []


@dataclass(frozen=True)
class ReusesTheLastAnswer(_FromMonteCarlo):
    """Gives what it has once found to every question of as many criteria."""

    def estimate(self, *given: Any, **options: Any) -> ReliabilityResult:
        if not _LAST or len(_LAST[0]) != len(given[1]):
            _LAST[:] = [super().estimate(*given, **options)]
        return _LAST[0]


@dataclass(frozen=True)
class IntervalTenTimesTooNarrow(_FromMonteCarlo):
    """States the right standard error, and a tenth of its interval."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(
            estimate,
            ci_low=estimate.pf - 0.1 * (estimate.pf - estimate.ci_low),
            ci_high=estimate.pf + 0.1 * (estimate.ci_high - estimate.pf),
        )


@dataclass(frozen=True)
class TakesInputsForStandard(_FromMonteCarlo):
    """Draws every input with mean 0 and deviation 1, whatever its law is."""

    def _task(self, task: Task) -> Task:
        inputs = task.problem.inputs

        def standard(x: FloatArray) -> FloatArray:
            return np.asarray(task.problem.model(inputs.to_standard_normal(x)))

        return answered(task, standard)


@dataclass(frozen=True)
class TurnsTauRound(_FromMonteCarlo):
    """Lets a wide tau fail more often than a narrow one."""

    def _task(self, task: Task) -> Task:
        taus = [None if c.tau is None else 3.0 / c.tau for c in task.criteria]
        criteria = [replace(c, tau=tau) for c, tau in zip(task.criteria, taus, strict=True)]
        return replace(task, criteria=tuple(criteria))


@dataclass(frozen=True)
class FirstAnswerForAll(_FromMonteCarlo):
    """Answers every criterion of a grid as the first of it."""

    def _task(self, task: Task) -> Task:
        return replace(task, criteria=task.criteria[:1] * len(task.criteria))


@dataclass(frozen=True)
class DropsFailedRuns(_FromMonteCarlo):
    """Counts failed runs as safe, without a word."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        low = estimate.pf if estimate.pf_low is None else estimate.pf_low
        return replace(estimate, pf=low, pf_low=low, pf_high=low, reliability=1.0 - low)


@dataclass(frozen=True)
class NumberWithoutAnswer(_FromMonteCarlo):
    """Gives pf = 0 where it should say that it failed."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        if not np.isnan(estimate.pf):
            return estimate
        return replace(estimate, pf=0.0, status="converged", std_error=0.0)


@dataclass(frozen=True)
class InfinityIsSafe(_FromMonteCarlo):
    """Drops infinite responses."""

    def _task(self, task: Task) -> Task:
        return meddled(task, lambda y: np.nan_to_num(y, posinf=0.0))


@dataclass(frozen=True)
class NaNIsZero(_FromMonteCarlo):
    """Replaces failed runs by zero before they are counted."""

    def _task(self, task: Task) -> Task:
        return meddled(task, lambda y: np.nan_to_num(y, posinf=np.inf))


@dataclass(frozen=True)
class NeverCertain(_FromMonteCarlo):
    """Adds a floor to pf."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(estimate, pf=0.999 * estimate.pf + 5e-4, reliability=None, std_error=np.nan)


@dataclass(frozen=True)
class ReliabilityOfAnother(_FromMonteCarlo):
    """Gives a reliability that does not belong to pf."""

    def _spoil(self, estimate: Estimate) -> Estimate:
        return replace(estimate, reliability=0.5)


@dataclass(frozen=True)
class ConvergedWithoutAnError(_FromMonteCarlo):
    """Calls an answer converged whose error nobody estimated, past the check of the base."""

    def _checked(self, estimate: Estimate, session: EvaluationSession) -> Estimate:
        checked, nan = super()._checked(estimate, session), float("nan")
        if np.isnan(checked.pf):
            return checked
        return replace(checked, status="converged", std_error=nan, ci_low=nan, ci_high=nan)


@dataclass(frozen=True)
class ConvergedWithAWideError(_FromMonteCarlo):
    """Calls an answer converged whose error is half of it, past the check of the base."""

    def _checked(self, estimate: Estimate, session: EvaluationSession) -> Estimate:
        checked = super()._checked(estimate, session)
        if np.isnan(checked.pf):
            return checked
        return replace(checked, status="converged", std_error=0.5 * checked.pf)


@dataclass(frozen=True)
class SwallowsFailedRuns(_FromMonteCarlo):
    """Catches the error of a failed run and answers all the same."""

    def _solve(self, task: Task) -> Solution:
        try:
            return super()._solve(task)
        except FailedRunError:
            return Solution([Estimate(pf=0.5, pf_low=0.0, pf_high=1.0)] * len(task.criteria))


@dataclass(frozen=True, eq=False)
class OnlyEqualToItself(_FromMonteCarlo):
    """Two of them with the same settings differ."""

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        return self is other


@dataclass(frozen=True)
class IndependentUnits(ReliabilityMethod):
    """Draws the shared inputs anew for every unit and mission: no common cause."""

    name: ClassVar[str] = "planted"

    @property
    def stochastic(self) -> bool:
        return True

    def supports(self, problem: object, criterion: Criterion) -> str | None:
        return "planted" if criterion.tau is not None else None

    def _solve(self, task: Task) -> Solution:
        rng, units = task.generator(), task.problem.n_units
        estimates = []
        for criterion in task.criteria:
            if not isinstance(criterion.missions, int):
                estimates.append(Estimate.without_answer("unsupported", "planted"))
                continue
            parts = units * criterion.missions
            n = task.session.remaining // parts // len(task.criteria)
            y = task.session.evaluate(task.problem.inputs.sample(rng, n * parts)).reshape(n, parts)
            pf = float((y.max(axis=1) > criterion.threshold).mean())
            error = float(np.sqrt(pf * (1 - pf) / n))
            estimates.append(
                Estimate(pf, std_error=error, ci_low=pf - 3 * error, ci_high=pf + 3 * error,
                         ci_kind="normal", error_kind="sampling")
            )  # fmt: skip
        return Solution(estimates)


@dataclass(frozen=True)
class MutableSettings(ReliabilityMethod):
    """Changes its own settings while it runs."""

    name: ClassVar[str] = "planted"
    runs: int = 0

    def _solve(self, task: Task) -> Solution:
        object.__setattr__(self, "runs", self.runs + 1)
        base = FFNIPearson(nodes_individual=5 + self.runs)
        return base._solve(task)


@dataclass(frozen=True)
class OverConfidentSurface(Kriging):
    """Believes in a single fit, and states a third of what that fit says of its own error."""

    trend: Trend = "quadratic"
    kernel: KernelChoice = "gaussian"
    share: float = 1.0 / 3.0

    def _steps(self, task: Task) -> Steps:
        honest = yield from super()._steps(task)
        return Solution([self._surer(e) for e in honest.estimates], honest.details)

    def _surer(self, estimate: Estimate) -> Estimate:
        return replace(
            estimate, std_error=self.share * estimate.std_error,
            ci_low=estimate.pf - self.share * (estimate.pf - estimate.ci_low),
            ci_high=estimate.pf + self.share * (estimate.ci_high - estimate.pf),
        )  # fmt: skip


@dataclass(frozen=True)
class SureSurface(OverConfidentSurface):
    """States a tenth of it, with a tenth of the interval."""

    share: float = 0.1


PLANTED: list[tuple[type[ReliabilityMethod], str]] = [
    (OnlyEqualToItself, "is_a_frozen_record_of_settings"),
    (ReliabilityOfAnother, "rows_are_well_formed"),
    (ConvergedWithoutAnError, "rows_are_well_formed"),
    (ConvergedWithAWideError, "rows_are_well_formed"),
    (BypassesTheCounter, "evaluations_are_counted_per_sample"),
    (CountsBatches, "evaluations_are_counted_per_sample"),
    (NumberWithoutAnswer, "budget_is_kept"),
    (GlobalRandomness, "same_seed_same_answer"),
    (RemembersRuns, "same_seed_same_answer"),
    (MutableSettings, "same_seed_same_answer"),
    (FixedSeed, "other_seed_other_answer"),
    (ReusesTheLastAnswer, "other_seed_other_answer"),
    (SurfaceOfOneSeed, "other_seed_other_answer"),
    (SurfaceOfHiddenSeed, "other_seed_other_answer"),
    (HiddenSeedOfTheError, "other_seed_other_answer"),
    (NeverAnswers, "other_seed_other_answer"),
    (GlobalRandomness, "same_answer_in_a_fresh_process"),
    (GlobalRandomness, "problem_is_left_alone"),
    (NeverCertain, "certain_outcomes"),
    (StrictBoundary, "boundary_works"),
    (InfinityIsSafe, "infinite_response_fails"),
    (DropsFailedRuns, "failed_runs_are_bounded"),
    (NaNIsZero, "broken_model_is_a_status"),
    (SwallowsFailedRuns, "policies_for_failed_runs"),
    (Biased, "hard_criterion_spoils_no_other"),
    (AlwaysZero, "one_unit_is_exact"),
    (Biased, "one_unit_is_exact"),
    (ForgetsMissions, "shared_inputs_correlate_units"),
    (IndependentUnits, "shared_inputs_correlate_units"),
    (ForgetsTau, "synchronization"),
    (ForgetsStructure, "structures"),
    (Biased, "plain_limit_state"),
    (Biased, "discrete_inputs"),
    (Biased, "scale_and_shift"),
    (Biased, "order_of_inputs_does_not_matter"),
    (TakesInputsForStandard, "units_of_inputs_do_not_matter"),
    (TurnsTauRound, "answers_are_monotone"),
    (ForgetsMissions, "answers_are_monotone"),
    (FirstAnswerForAll, "grid_agrees_with_single_criteria"),
    (IntervalTenTimesTooNarrow, "stated_errors_are_honest"),
    (OverConfident, "stated_errors_are_honest"),
    (UnderConfident, "stated_errors_are_honest"),
    (OverConfidentSurface, "stated_errors_are_honest"),
    (SureSurface, "stated_errors_are_honest"),
]
"""Planted method, and a check that must reject it; every check stands here at least once."""
FINE = {OverConfidentSurface}
"""Faults that the four seeds of level `quick` do not see, and the thirty of level `full` do."""
