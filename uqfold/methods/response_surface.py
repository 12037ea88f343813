"""What methods with a response surface share: the runs behind it, and the answers from it.

The surface lives in the standard-normal space of the Rosenblatt transformation, shared inputs
first, so that one surface answers all criteria of the grid. Its own uncertainty is carried into
an interval: surfaces drawn from its posterior move the reliability index, and their spread is the
stated error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np

from uqfold.methods.criteria_blocks import estimates_by_blocks
from uqfold.methods.few_taus import by_few_taus
from uqfold.methods.fitted_kind import DRAWS, PARTS, FittedKind, HeldOut
from uqfold.methods.result import NO_ANSWER, Estimate
from uqfold.methods.surface_errors import lean, overconfidence, step
from uqfold.methods.surface_verdict import (
    change_of_pf,
    doubts_about_surface,
    estimates_of,
    missed_share,
    poor_share,
    scatter_of_unit,
)
from uqfold.methods.task import Task
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem, conditional, reliability_indices
from uqfold.system.surface_layout import laid_out, laid_out_apart
from uqfold.system.surface_rule import MAX_POINTS, Surface
from uqfold.typing import FloatArray

# Scatter of units, in errors of the surface, from which it is not an artefact of the fit.
_CLEAR = 10.0


@dataclass(frozen=True, eq=False)
class ErrorParts:
    """Where the stated errors of pf come from: standard deviations (n_criteria,).

    Attributes
    ----------
    training
        What the runs leave open in the surface.
    integration
        What the rules of integration over the surface leave.
    sampling
        Scatter of the lines over the surface that are drawn at random; 0 where none are.
    """

    training: FloatArray
    integration: FloatArray
    sampling: FloatArray

    def shortfall(self, row: int, target: float) -> float:
        """How many times what a target leaves to it the training error is; 0 if runs cannot help.

        Parameters
        ----------
        row
            The criterion.
        target
            Standard deviation of pf that all parts together are to have.
        """
        rest = math.hypot(self.integration[row], self.sampling[row])
        # as shares of the target: squares of the smallest probabilities are zero to the computer
        share = rest / target if rest < target else 1.0
        if share**2 == 1.0:
            return 0.0
        return float(self.training[row]) / target / math.sqrt(1.0 - share**2)


@dataclass(frozen=True, eq=False)
class SurfaceAnswers:
    """Answers of a surface.

    Attributes
    ----------
    estimates
        One for each criterion.
    errors
        Where their stated errors come from.
    shortfall
        How many times its target the largest error is that more runs could reduce.
    given
        The same answers when runs held out of the surface of each kind are known.
    """

    estimates: list[Estimate]
    errors: ErrorParts
    shortfall: float
    given: Callable[[Sequence[HeldOut]], SurfaceAnswers]


def surface_estimates(
    task: Task,
    fitted: Sequence[FittedKind],
    rng: np.random.Generator,
    *,
    target_cov: float,
    max_points: int = MAX_POINTS,
    beta_std: FloatArray | None = None,
    stated_noise: float | None = None,
    stepped: bool = True,
) -> SurfaceAnswers:
    """Answer the criteria of a task from fitted surfaces.

    Parameters
    ----------
    task
        Problem and criteria.
    fitted
        A surface for each kind of units, and the runs behind it.
    rng
        Source of the draws behind the stated error.
    target_cov
        Largest stated error, relative to pf or to the reliability, of a ``converged`` row.
    max_points
        Most points at which the surfaces are evaluated for an answer.
    beta_std
        Standard deviations (n_criteria,) of the reliability indices that the stated ones may not
        fall below, from a caller who judges the surface himself; None: the surfaces are judged by
        cross-validation.
    stated_noise
        The noise that the settings state; None where it is learned.
    stepped
        Whether equal responses of different runs mean steps; those at nodes of a grid do not.
    """

    def work(stopped: str) -> SurfaceAnswers:
        made = list(fitted)
        if stopped:
            made = [replace(one, runs=replace(one.runs, stopped=stopped)) for one in fitted]
        return _answered(task, made, rng, target_cov, max_points, beta_std, stated_noise, stepped)

    return task.summed_up(work)


def _answered(
    task: Task,
    fitted: Sequence[FittedKind],
    rng: np.random.Generator,
    target_cov: float,
    max_points: int,
    beta_std: FloatArray | None,
    stated_noise: float | None,
    stepped: bool,
) -> SurfaceAnswers:
    """Answer the criteria, apart from the others those for which no rule is fine enough."""
    problem, units = task.problem, SystemUnits.of(task.problem)
    complete = all(one.runs.complete for one in fitted)
    means = [one.surface.mean for one in fitted]
    dimensions = [inputs.dimension for inputs in problem.kinds.inputs]
    doubts = []
    for kind, one in enumerate(fitted):
        own = doubts_about_surface(one.runs, one.validated if beta_std is None else None)
        if one.validated.contradicts(stated_noise):
            own.append(
                f"noise = {stated_noise:g} contradicts the fit: runs left out are predicted to "
                f"{one.validated.rms:.2g}, {one.validated.ratio:.2g} times what the surface states"
            )
        doubts += [problem.kinds.said(kind, problem.unit_names) + doubt for doubt in own]

    def lay(rows: Sequence[int]) -> SurfaceSystem:
        asked = [task.criteria[row] for row in rows]
        return laid_out(
            means, dimensions, problem.kinds.n_shared, units, asked, max_points,
            complete=complete, trusted=not doubts,
        )  # fmt: skip

    def indices(system: SurfaceSystem) -> FloatArray:
        return replace(system, rules=system.coarse).indices(means, task.criteria)

    count = len(task.criteria)
    everything = list(range(count))
    parts = [(everything, lay(everything))] if doubts else laid_out_apart(lay, indices, count)
    fitted = [one.with_common_powers() for one in fitted]
    others = _others(fitted, rng)
    answers = []
    for rows, system in parts:
        part = replace(task, criteria=tuple(task.criteria[row] for row in rows))
        floor = None if beta_std is None else beta_std[rows]
        given = _answers_of(part, fitted, others, system, doubts, target_cov, floor, stepped)
        answers.append((rows, given))

    def answered(held: Sequence[HeldOut] = ()) -> SurfaceAnswers:
        errors = ErrorParts(*(np.zeros(count) for _ in range(3)))
        found: dict[int, Estimate] = {}
        for rows, given in answers:
            some, parts_of_error = given(held)
            found.update(zip(rows, some, strict=True))
            for name in ("training", "integration", "sampling"):
                getattr(errors, name)[rows] = getattr(parts_of_error, name)
        estimates = [found[row] for row in everything]
        missed = [
            missed_share(one.validated, one.runs) / poor_share(one.runs)
            for one in fitted
            if beta_std is None
        ]
        targets = [_smaller(one) * target_cov for one in estimates]
        short = [errors.shortfall(row, target) for row, target in enumerate(targets)]
        return SurfaceAnswers(estimates, errors, max(*missed, 0.0, *short), answered)

    return answered()


def _answers_of(
    task: Task,
    fitted: Sequence[FittedKind],
    others: Sequence[Surface],
    system: SurfaceSystem,
    doubts: list[str],
    target_cov: float,
    beta_std: FloatArray | None,
    stepped: bool,
) -> Callable[[Sequence[HeldOut]], tuple[list[Estimate], ErrorParts]]:
    """Answer criteria that are laid out together: answers and errors, given runs held out."""
    units = SystemUnits.of(task.problem)
    if not doubts and not system.resolved:
        doubts = ["the surface changes too abruptly to be integrated accurately"]
    complete = all(one.runs.complete for one in fitted)
    means = [one.surface.mean for one in fitted]
    outcomes = None if complete else [one.runs.outcomes for one in fitted]
    noise = [one.noise for one in fitted]

    responses = system.responses(means, outcomes, noise)
    # units differ by what the surface makes of their own inputs: is that more than its error?
    blur = 0.0
    apart = [] if system.together else zip(fitted, conditional(responses.whole), strict=False)
    for one, whole in apart:
        rms = one.validated.rms
        if scatter_of_unit(whole, system.weights) <= _CLEAR * rms:
            blur = max(blur, rms)
    unresolved = f"tau lies below what the surface can tell of one unit, about {blur:.2g}"
    drawn = system.coarse_responses(means, others, outcomes, noise)

    @lru_cache
    def integrated(criteria: tuple[Criterion, ...]) -> tuple[list[SystemProbability], FloatArray]:
        changes = by_few_taus(criteria, partial(system.changes_given, drawn))
        return system.failures_given(responses, criteria), changes

    def spread_of(
        changes: FloatArray, criteria: Sequence[Criterion], held: Sequence[HeldOut]
    ) -> FloatArray:
        thresholds = [one.threshold for one in criteria]
        seen_of_kinds: Sequence[HeldOut | None] = held or [None] * len(fitted)
        # a surface that misses its own runs by more than it says is believed nowhere
        factors = [
            [
                max(
                    overconfidence(one.validated, one.known, threshold, seen)
                    for threshold in column
                )
                for column in units.thresholds(thresholds, kind).T.tolist()
            ]
            for kind, (one, seen) in enumerate(zip(fitted, seen_of_kinds, strict=True))
        ]
        spread = np.max(factors, axis=0) * changes[:DRAWS].std(axis=0, ddof=1)
        row = DRAWS
        for one in fitted:
            if one.rivals:
                own = changes[row : row + len(one.rivals)]
                distance = np.array([[rival.share] for rival in one.rivals]) * own
                spread = np.hypot(spread, np.sqrt(np.mean(distance**2, axis=0)))
                row += len(one.rivals)
        # the jackknife: what hangs on few runs is not known, whatever the surface says
        for _ in fitted:
            own = changes[row : row + PARTS]
            spread = np.maximum(spread, np.sqrt((PARTS - 1) * np.mean(own**2, axis=0)))
            row += PARTS
        return np.asarray(spread)

    def given(held: Sequence[HeldOut]) -> tuple[list[Estimate], ErrorParts]:
        count = len(task.criteria)
        errors = ErrorParts(*(np.zeros(count) for _ in range(3)))

        def answers(rows: Sequence[int]) -> list[Estimate]:
            criteria = tuple(task.criteria[row] for row in rows)
            found, changes = integrated(criteria)
            spread = spread_of(changes, criteria, held)
            if beta_std is not None:
                spread = np.maximum(spread, beta_std[list(rows)])
            own = [
                [*doubts, unresolved]
                if criterion.tau is not None and criterion.tau < blur
                else doubts
                for criterion in criteria
            ]
            sides = [step(fitted, criterion, units) for criterion in criteria if stepped]
            if any(leant := [lean(fitted, criterion, units, held) for criterion in criteria]):
                moved = [
                    replace(one, threshold=one.threshold - by)
                    for one, by in zip(criteria, leant, strict=True)
                ]
                there = reliability_indices(system.failures_given(responses, moved))
                spread = np.hypot(spread, there - reliability_indices(found))
            for side in zip(*sides, strict=True):
                if side == criteria:
                    continue
                beyond = reliability_indices(system.failures_given(responses, side))
                # the border lies somewhere in the step: two standard deviations reach its end
                spread = np.maximum(spread, 0.5 * np.abs(beyond - reliability_indices(found)))
            [rest] = by_few_taus(
                criteria, lambda some: system.integration_errors(responses, some)[None]
            )
            name = "sampling" if responses.parts else "integration"
            density = change_of_pf(reliability_indices(found))
            errors.training[list(rows)] = density * spread
            getattr(errors, name)[list(rows)] = density * rest
            runs = [one.runs for one in fitted]
            return estimates_of(found, spread, rest, name, criteria, own, runs, target_cov)

        return estimates_by_blocks(count, answers), errors

    return given


def _others(fitted: Sequence[FittedKind], rng: np.random.Generator) -> list[Surface]:
    """Return for each kind the surfaces that tell the error: draws of all kinds, then rivals.

    The draws of all kinds are made together; a rival of one kind meets the means of the others.
    """

    def others(kind: int, paths: Surface) -> Surface:
        parts = fitted[kind].parts_left_out()

        def surfaces(u: FloatArray) -> FloatArray:
            own = fitted[kind].surface.mean(u) if len(fitted) > 1 else None
            rows = [
                rival.mean(u) if of_kind == kind else own
                for of_kind, one in enumerate(fitted)
                for rival in one.rivals
            ]
            for of_kind in range(len(fitted)):
                rows += [*parts(u)] if of_kind == kind else [own] * PARTS
            return np.vstack([paths(u), *(row for row in rows if row is not None)])

        return surfaces

    return [others(kind, one.surface.sample_paths(rng, DRAWS)) for kind, one in enumerate(fitted)]


def _smaller(estimate: Estimate) -> float:
    """The smaller one of pf and reliability; 0 where there is no answer."""
    if estimate.status in NO_ANSWER:
        return 0.0
    rest = 1.0 - estimate.pf if estimate.reliability is None else estimate.reliability
    return min(estimate.pf, rest)
