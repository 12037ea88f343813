"""Derivatives of pf by simulation of the real model, with the score function method.

The derivative of a failure probability is the expectation of the failure indicator times the score
of the whole system: that of the shared inputs, plus those of the individual inputs of every unit
in every mission. It needs no surface and no second sample, and it is unbiased.

References
----------
Rubinstein R. Y., Shapiro A. Discrete Event Systems: Sensitivity Analysis and Stochastic
Optimization by the Score Function Method. Wiley, 1993.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from uqfold.analysis.affordable import check_affordable
from uqfold.analysis.pf_derivatives import (
    Differentiated,
    PfDerivatives,
    chosen_parameters,
    derivative_row,
)
from uqfold.checks import whole
from uqfold.evaluation import Evaluator
from uqfold.inputs.score import ScoreFunction, score_function
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
    checked_problem,
)
from uqfold.methods.result import Status
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.methods.system_sample import SystemBlock, block_systems, draw_systems, too_large
from uqfold.problems.base import Problem
from uqfold.problems.structure import Series
from uqfold.typing import FloatArray, IntArray

METHOD = "score-function"
_FEW = 30
"""Fewer failures than this do not tell the spread of their scores."""


def score_derivatives(
    problem: Problem,
    criteria: CriteriaLike = None,
    systems: int = 100_000,
    *,
    inputs: Sequence[str] | None = None,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> PfDerivatives:
    """Differentiate pf by means and standard deviations of the inputs, by simulation.

    All criteria and parameters are read off the same systems, which are those of `MonteCarlo`
    with the same seed. Failed runs count as failures.

    Parameters
    ----------
    problem
        Model, inputs and units, exchangeable and in series.
    criteria
        What "works" means; None takes the problem's own default criteria.
    systems
        Systems to simulate; one costs n units times the most missions of the grid.
    inputs
        Names of the inputs to differentiate by; None: all.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`; a budget must pay for all systems.

    Returns
    -------
    PfDerivatives
        Criteria first, then means, then standard deviations. A row with fewer than 30 failures,
        or fewer than 30 systems that work, is ``doubtful`` and states no error.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, or where an input has no score function.
    BudgetExceededError
        If the systems may cost more than `max_evals`; none is run then.
    """
    started = time.perf_counter()
    checked_problem(problem)
    if not problem.exchangeable or not isinstance(problem.structure, Series):
        raise ValueError(f"{METHOD} needs exchangeable units in series, not {problem!r}")
    systems = whole("systems", systems, at_least=2)
    asked = checked_criteria(problem, criteria)
    for criterion in asked:
        if reason := too_large(METHOD, problem, criterion):
            raise ValueError(reason)
    most_at_once = block_systems(problem, asked)
    parameters = chosen_parameters(problem, inputs)
    scores = [score_function(problem.inputs, p.input, p.moment) for p in parameters]
    seed = reduced_seed(rng)
    session = checked_evaluator(evaluator).open(problem, checked_budget(max_evals))
    most = systems * problem.n_units * max(c.max_missions for c in asked)
    session.expected = most
    check_affordable(session, most)
    drawn: deque[SystemBlock] = deque()

    def rows() -> Iterator[FloatArray]:
        for block, start in enumerate(range(0, systems, most_at_once)):
            size = min(most_at_once, systems - start)
            drawn.append(draw_systems(problem, asked, block_generator(seed, block), size))
            yield drawn[-1].x

    sums = _Sums((len(asked), len(parameters)))
    for y in session.stream(rows()):
        sums.add(drawn.popleft(), y, scores)
    found = [
        derivative_row(
            criterion, parameter, sums.pf(i), sums.differentiated(i, j), "sampling", METHOD,
            *sums.status(i),
        )
        for i, criterion in enumerate(asked)
        for j, parameter in enumerate(parameters)
    ]  # fmt: skip
    return PfDerivatives(
        rows=tuple(found),
        n_evals=session.n_evals,
        n_reused=session.n_reused,
        n_failed=session.n_failed,
        seconds=time.perf_counter() - started,
        seed=seed,
    )


@dataclass
class _Sums:
    """Sums over systems for C criteria and P parameters: I of failure, S of the score."""

    shape: tuple[int, int]
    n: int = 0
    failed: FloatArray = field(init=False)
    score: FloatArray = field(init=False)
    square: FloatArray = field(init=False)
    failed_score: FloatArray = field(init=False)
    failed_square: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.failed = np.zeros(self.shape[0])
        self.score, self.square = np.zeros(self.shape), np.zeros(self.shape)
        self.failed_score, self.failed_square = np.zeros(self.shape), np.zeros(self.shape)

    def add(self, block: SystemBlock, y: FloatArray, scores: Sequence[ScoreFunction]) -> None:
        failed = block.failed(y, missing_fails=True)
        self.n += failed.shape[1]
        self.failed += failed.sum(axis=1)
        for j, score in enumerate(scores):
            for i, s in enumerate(_of_systems(block, *score(block.x))):
                self.score[i, j] += s.sum()
                self.square[i, j] += s @ s
                self.failed_score[i, j] += s[failed[i]].sum()
                self.failed_square[i, j] += s[failed[i]] @ s[failed[i]]

    def pf(self, i: int) -> float:
        return float(self.failed[i] / self.n)

    def few(self, i: int) -> bool:
        failures = int(self.failed[i])
        return min(failures, self.n - failures) < _FEW

    def status(self, i: int) -> tuple[Status, str]:
        if not self.few(i):
            return "converged", ""
        failures = int(self.failed[i])
        return "doubtful", f"{failures} failure{'s' * (failures != 1)} among {self.n} systems"

    def differentiated(self, i: int, j: int) -> Differentiated:
        """Mean of (I - pf) S, whose S has mean zero, and its standard error."""
        p = self.pf(i)
        s, ss, fs, fss = (
            float(total[i, j] / self.n)
            for total in (self.score, self.square, self.failed_score, self.failed_square)
        )
        derivative = fs - p * s
        # (I - p)^2 = (1 - 2 p) I + p^2
        both, once, spread = (
            (1.0 - 2.0 * p) * fss + p * p * ss,
            (1.0 - 2.0 * p) * fs + p * p * s,
            p * (1.0 - p),
        )
        std_error = math.sqrt(max(both - derivative**2, 0.0) / self.n)
        if self.few(i):
            relative = derivative / p if p > 0.0 else math.nan
            return Differentiated(derivative, math.nan, relative, math.nan)
        relative = derivative / p
        # the linearised error of a ratio
        variance = both - derivative**2 - 2.0 * relative * once + relative**2 * spread
        return Differentiated(
            derivative, std_error, relative, math.sqrt(max(variance, 0.0) / self.n) / p
        )


def _of_systems(
    block: SystemBlock, of_shared: FloatArray, of_individual: FloatArray
) -> Iterator[FloatArray]:
    """Scores (size,) of whole systems, for each criterion the missions that it looks at."""
    per_mission = np.zeros(block.rows.shape)
    per_mission[block.rows] = of_individual.reshape(-1, block.units.count).sum(axis=1)
    shared = _first_of_each(block.units.count * block.rows.sum(axis=1), of_shared)
    mission = np.arange(block.rows.shape[1])
    for criterion in block.criteria:
        flies = mission < block.flown[criterion.missions][:, None]
        yield shared + np.where(flies, per_mission, 0.0).sum(axis=1)


def _first_of_each(counts: IntArray, values: FloatArray) -> FloatArray:
    """Value of the first of so many rows of each system; 0 for a system without any."""
    first = np.zeros(len(counts))
    starts = np.cumsum(counts) - counts
    first[counts > 0] = values[starts[counts > 0]]
    return first
