"""The smallest or largest mean (or standard deviation) of an input that meets a target.

With a response surface one set of evaluations serves the whole range: it is fitted with the input
spread so widely that it covers every value in the range, and asked for the distribution at each of
them. Any other method is run at each value, with the same seed.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import get_args

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.analysis.design import MOST_POINTS, Design, Scan, Seek, checked_target, located
from uqfold.analysis.fitted_surface import fit_surface
from uqfold.checks import choice, instance, or_none, refused, whole
from uqfold.evaluation import Evaluator
from uqfold.inputs.score import Moment
from uqfold.methods.arguments import checked_budget, checked_problem
from uqfold.methods.base import ReliabilityMethod, checked_method
from uqfold.methods.kriging import Kriging
from uqfold.methods.polynomial_chaos import PolynomialChaos
from uqfold.methods.result import CriterionResult
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.designs import DEFAULT_SPREAD
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import reliability_index
from uqfold.system.surface_layout import laid_out
from uqfold.typing import FloatArray

_SURFACE_POINTS, _METHOD_POINTS = 17, 9
_COVERED = 2.0 * DEFAULT_SPREAD
"""So many standard deviations to either side a design of the default spread fills well."""
_DRAWS = 20
_T95 = 2.093
"""Student's quantile for a spread estimated from 20 draws."""
_STREAM = 13


@dataclass(frozen=True)
class _DesignTask:
    """What is designed: one moment of one input, between two values."""

    problem: Problem
    criterion: Criterion
    input: str
    moment: Moment
    between: tuple[float, float]

    def place(self, value: float) -> tuple[Problem, Criterion]:
        """The problem with the moment at a value, and the criterion."""
        moved = {self.input: value}
        if self.moment == "mean":
            return self.problem.with_moments(means=moved), self.criterion
        return self.problem.with_moments(standard_deviations=moved), self.criterion

    def wide(self) -> Problem:
        """The problem with the input spread over the whole range."""
        if self.moment == "standard deviation":
            return self.place(self.between[1])[0]
        column = self.problem.inputs.names.index(self.input)
        std = float(self.problem.inputs.standard_deviations[column])
        low, high = self.between
        return self.problem.with_moments(
            means={self.input: 0.5 * (low + high)},
            standard_deviations={self.input: std + 0.5 * (high - low) / _COVERED},
        )


@one_blas_thread()
def design_input(
    problem: Problem,
    criterion: Criterion,
    target_pf: float,
    input: str,
    between: tuple[float, float],
    *,
    moment: Moment = "mean",
    seek: Seek = "smallest",
    method: ReliabilityMethod | None = None,
    points: int | None = None,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> Design:
    """Find the smallest or largest mean or standard deviation of an input that meets a target.

    Parameters
    ----------
    problem
        Model, inputs and units.
    criterion
        What "works" means.
    target_pf
        Failure probability to be met: pf <= target.
    input
        Name of the input.
    between
        Range of its mean or standard deviation to look at, in the input's unit.
    moment
        ``mean`` (the standard deviation stays) or ``standard deviation`` (the mean stays).
    seek
        ``smallest``: the value from which on the target is met; ``largest``: up to which.
    method
        `Kriging` (None: with its default settings) and `PolynomialChaos` make their runs once,
        spread over the range; any other method makes its own at every value looked at.
    points
        Values in the range, from 5 to 10,000; None: 17 on a surface, 9 with any other method.
    max_evals
        Most evaluations, of all values together.
    rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Returns
    -------
    Design
        Its ``safe`` value is the end of the interval that errs on the cautious side.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, before any run is spent.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    started = time.perf_counter()
    checked_problem(problem)
    instance("criterion", criterion, Criterion, "give a Criterion")
    target_pf, ends = checked_target(target_pf, between)
    input = choice("input", input, problem.inputs.names)
    moment = choice("moment", moment, get_args(Moment))
    seek = choice("seek", seek, get_args(Seek))
    chosen = checked_method(method) or Kriging()
    on_surface = isinstance(chosen, Kriging | PolynomialChaos)
    size = or_none("points", points, whole, at_least=5, at_most=MOST_POINTS)
    if size is None:
        size = _SURFACE_POINTS if on_surface else _METHOD_POINTS
    budget = checked_budget(max_evals)
    question = _DesignTask(problem, criterion, input, moment, ends)
    for end in ends:
        question.place(end)  # refuses moments that the distribution cannot have
    values = np.linspace(*ends, size)
    seed = reduced_seed(rng)
    if isinstance(chosen, Kriging | PolynomialChaos):
        scan, row = _on_surface(question, chosen, values, max_evals, seed, evaluator)
        cost = row.n_evals, row.n_reused
    else:
        if budget is not None and budget < values.size:
            raise refused("max_evals", budget, f"give at least a run for each of {size} points")
        share = None if budget is None else budget // values.size
        rows = [
            chosen.estimate(
                question.place(float(value))[0], [criterion],
                max_evals=share, rng=seed, evaluator=evaluator,
            )[0]
            for value in values
        ]  # fmt: skip
        scan = Scan.of(values.tolist(), rows)
        cost = sum(row.n_evals for row in rows), sum(row.n_reused for row in rows)
    found, low, high = located(scan, target_pf, seek)
    return Design(
        parameter=f"{moment} of {input}",
        unit=problem.input_units[problem.inputs.names.index(input)],
        target_pf=target_pf,
        seek=seek,
        between=ends,
        status=found.status,
        message=found.message,
        value=found.value,
        low=low,
        high=high,
        scan=scan,
        criterion=criterion,
        method=chosen.name,
        n_evals=cost[0],
        n_reused=cost[1],
        seconds=time.perf_counter() - started,
        seed=seed,
        place=question.place,
    )


def _on_surface(
    question: _DesignTask,
    method: Kriging | PolynomialChaos,
    values: FloatArray,
    max_evals: int | None,
    seed: int,
    evaluator: Evaluator | None,
) -> tuple[Scan, CriterionResult]:
    from scipy.special import ndtr

    problem, criteria = question.problem, [question.criterion]
    fitted = fit_surface(
        question.wide(), criteria, method, max_evals=max_evals, rng=seed, evaluator=evaluator
    )
    inputs = problem.inputs
    paths = fitted.surface.sample_paths(block_generator(seed, _STREAM), _DRAWS)
    pf, index, spread = np.empty((3, values.size))
    resolved = True
    for i, value in enumerate(values):
        here = question.place(float(value))[0].inputs
        mean = fitted.seen_from(fitted.surface.mean, here)
        drawn = fitted.seen_from(paths, here)
        # laid out anew, since the directions that matter change with the distribution
        units = SystemUnits.of(problem)
        system = laid_out(mean, inputs.dimension, inputs.n_shared, units, criteria)
        resolved &= system.resolved
        responses = system.responses(mean, noise=fitted.noise)
        [found] = system.failures_given(responses, criteria)
        [missed] = system.integration_errors(responses, criteria)
        changes = system.changes(mean, drawn, criteria, noise=fitted.noise)[:, 0]
        pf[i], index[i] = found.pf, reliability_index(found)
        spread[i] = math.hypot(fitted.overconfidence * float(changes.std(ddof=1)), missed)
    reach = _T95 * spread
    note = "" if resolved else "the surface is not integrated accurately"
    scan = Scan(values, pf, ndtr(-index - reach), ndtr(-index + reach), (note,) * values.size)
    return scan, fitted.result[0]
