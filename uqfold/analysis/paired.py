"""How much the distribution of one individual input changes pf, where the change is tiny.

Two estimates of pf from different runs differ by their errors, and a quadrature of few nodes
samples whatever roughness the response has in that input. Here both problems answer with the same
random numbers. Given the shared inputs, runs lie along lines in standard-normal space that point
where the other individual inputs raise the response most; a line gives the distribution of the
response along it by normal probabilities, without counting failures (line sampling, Koutsourelakis,
Pradlwarter and Schuëller 2004). The changed input has one value per line and its mirror image on a
second line (antithetic variates), which cancels what it does to first order. What is left of the
response's roughness is averaged, and counted in the standard error.

References
----------
Koutsourelakis P.-S., Pradlwarter H.J., Schuëller G.I. Reliability of structures in high dimensions.
Probabilistic Engineering Mechanics 19 (2004) 409-417.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from uqfold.analysis.affordable import check_affordable
from uqfold.checks import instance, refused, whole
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
)
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.methods.tabular import Tabular
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria
from uqfold.problems.structure import Series
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.missions import over_missions
from uqfold.system.synchronized import mission_probability
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    pass

_Response: TypeAlias = Callable[[FloatArray], FloatArray]

_STATIONS = np.linspace(-6.0, 6.0, 13)
"""Places of the runs along a line, in standard deviations."""
_SCORES = np.linspace(-8.0, 8.0, 17)
"""Places along the average line whose responses are the levels of the tables."""


@dataclass(frozen=True)
class PairedDifference:
    """What the second problem loses against the first under one criterion.

    Attributes
    ----------
    threshold, tau
        The criterion; tau is NaN where there is none.
    missions
        Number of missions, as text.
    pf, pf_other
        Failure probability of the first and of the second problem, each with an error of its own
        that is far larger than that of the difference.
    difference
        ``pf_other`` - ``pf``: by how much the first one is the more reliable.
    std_error
        Standard error of the difference.
    """

    threshold: float
    tau: float
    missions: str
    pf: float
    pf_other: float
    difference: float
    std_error: float


@dataclass(frozen=True, repr=False)
class PairedDifferences(Tabular[PairedDifference]):
    """Differences of two problems with the same random numbers, one row per criterion.

    Attributes
    ----------
    rows
        One `PairedDifference` each.
    changed
        Name of the input whose distributions differ.
    n_evals
        Evaluations of both problems.
    seed
        The seed that repeats the run.
    """

    rows: tuple[PairedDifference, ...]
    changed: str
    n_evals: int
    seed: int

    _SHOWN = ("threshold", "tau", "missions", "pf", "pf_other", "difference", "std_error")


def paired_differences(
    first: Problem,
    second: Problem,
    criteria: CriteriaLike,
    draws: int = 2_000,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> PairedDifferences:
    """Compare two problems that differ in the distribution of one individual input.

    Parameters
    ----------
    first, second
        The problems: series systems of exchangeable units. The response may be rough, but has to
        rise steadily along the lines.
    criteria
        Thresholds, synchronization thresholds and missions; None takes those of `first`.
    draws
        Draws of the shared inputs, at least 2. Each takes 52 runs (two problems, two lines, 13
        runs along each), and the direction of the lines two more per individual input.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`; a budget must pay for all runs.

    Raises
    ------
    TypeError, ValueError
        For wrong arguments; if the problems do not differ in just one individual input, or there
        is none beside it to lay lines along; if a run fails, or a response is infinite or does not
        rise along a line.
    BudgetExceededError
        If the runs cost more than `max_evals`; none is made then.
    """
    draws = whole("draws", draws, at_least=2)
    for name, problem in (("first", first), ("second", second)):
        instance(name, problem, Problem, "give a Problem")
        if not problem.exchangeable or problem.structure != Series():
            raise refused(name, problem, "give a series system of exchangeable units")
    asked = checked_criteria(first, criteria)
    changed = _changed_input(first, second)
    seed = reduced_seed(rng)
    budget = checked_budget(max_evals)
    settings = checked_evaluator(evaluator)
    sessions = [settings.open(problem, budget) for problem in (first, second)]
    own = [i for i in range(first.inputs.n_shared, first.inputs.dimension) if i != changed]
    per_problem = draws * 2 * _STATIONS.size
    needed = 2 * per_problem + 2 * len(own)
    check_affordable(sessions[0], needed)
    sessions[0].expected = per_problem + 2 * len(own)
    sessions[1].expected = per_problem

    def responses(which: int, u: FloatArray) -> FloatArray:
        inputs = (first, second)[which].inputs
        flat = inputs.from_standard_normal(u.reshape(-1, u.shape[-1]))
        y = np.asarray(sessions[which].evaluate(flat), dtype=np.float64)
        if not np.isfinite(y).all():
            raise ValueError(
                f"{int((~np.isfinite(y)).sum())} of {y.size} responses are infinite or failed: "
                "such a response has no line to follow"
            )
        return y.reshape(u.shape[:-1])

    direction = _steepest(lambda u: responses(0, u), own, first.inputs.dimension)
    u = _lines(draws, direction, changed, block_generator(seed, 0))
    both = [_rising(responses(which, u)) for which in (0, 1)]
    found = np.stack([_failures(lines, _levels(both), first.n_units, asked) for lines in both])
    difference = found[1] - found[0]
    errors = difference.std(axis=0, ddof=1) / math.sqrt(draws)
    rows = tuple(
        PairedDifference(
            criterion.threshold,
            math.nan if criterion.tau is None else criterion.tau,
            str(criterion.missions),
            float(found[0, :, i].mean()),
            float(found[1, :, i].mean()),
            float(difference[:, i].mean()),
            float(errors[i]),
        )
        for i, criterion in enumerate(asked)
    )
    n_evals = sum(session.n_evals for session in sessions)
    return PairedDifferences(rows, first.inputs.names[changed], n_evals, seed)


def _changed_input(first: Problem, second: Problem) -> int:
    """Find the column in which the same standard-normal rows give other inputs."""
    one, other = first.inputs, second.inputs
    if (one.names, one.n_shared) != (other.names, other.n_shared):
        raise ValueError(
            f"first has the inputs {', '.join(one.names)}, second {', '.join(other.names)}: give "
            "two problems with the same inputs, the same of them shared"
        )
    if first.n_units != second.n_units:
        raise ValueError(f"first has {first.n_units} units, second {second.n_units}: give as many")
    u = block_generator(0, 0).standard_normal((32, one.dimension))
    x, y = one.from_standard_normal(u), other.from_standard_normal(u)
    columns = np.flatnonzero((x != y).any(axis=0))
    differing = ", ".join(one.names[i] for i in columns) or "none"
    if len(columns) != 1 or columns[0] < one.n_shared:
        raise ValueError(
            f"inputs whose distributions differ: {differing}; give two problems that differ in "
            "that of one individual input"
        )
    if one.n_individual < 2:
        raise ValueError(
            f"{differing} is the only individual input: lines need another one to lie along"
        )
    return int(columns[0])


def _steepest(response: _Response, own: Sequence[int], dimension: int) -> FloatArray:
    """Direction (d,) in which the unchanged individual inputs raise the response most."""
    steps = np.zeros((2, len(own), dimension))
    steps[0, range(len(own)), own], steps[1, range(len(own)), own] = 1.0, -1.0
    up, down = response(steps)
    direction = np.zeros(dimension)
    direction[list(own)] = up - down
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        raise ValueError("the response takes no notice of the other individual inputs")
    return direction / length


def _lines(draws: int, direction: FloatArray, changed: int, rng: np.random.Generator) -> FloatArray:
    """Runs in standard-normal space: (draws, 2 lines, stations, d)."""
    start = rng.standard_normal((draws, direction.size))
    start -= np.outer(start @ direction, direction)
    mirrored = start.copy()
    mirrored[:, changed] *= -1.0
    return np.stack([start, mirrored], axis=1)[:, :, None, :] + _STATIONS[:, None] * direction


def _rising(responses: FloatArray) -> FloatArray:
    if not (np.diff(responses, axis=-1) > 0.0).all():
        raise ValueError(
            "the response does not rise steadily in the direction in which the individual inputs "
            "raise it most near the median: lines along it do not give its distribution"
        )
    return responses


def _levels(both: Sequence[FloatArray]) -> FloatArray:
    """Responses along the average line of each draw, (draws, levels): those of both problems."""
    average = 0.5 * (both[0] + both[1]).mean(axis=1)
    return np.stack([_continued(_SCORES, _STATIONS, line) for line in average])


def _continued(x: FloatArray, places: FloatArray, values: FloatArray) -> FloatArray:
    """Interpolate linearly, and go on with the last slope beyond both ends."""
    inside = np.interp(x, places, values)
    low = (values[1] - values[0]) / (places[1] - places[0])
    high = (values[-1] - values[-2]) / (places[-1] - places[-2])
    below = np.minimum(x - places[0], 0.0) * low
    above = np.maximum(x - places[-1], 0.0) * high
    return np.asarray(inside + below + above)


def _failures(lines: FloatArray, levels: FloatArray, units: int, criteria: Criteria) -> FloatArray:
    """Failure probability (draws, criteria) given each draw of the shared inputs."""
    from scipy.special import ndtr, ndtri

    groups: dict[float | None, list[int]] = {}
    for i, criterion in enumerate(criteria):
        groups.setdefault(criterion.tau, []).append(i)
    failure, success = np.empty((2, len(lines), len(criteria)))
    for row, (pair, level) in enumerate(zip(lines, levels, strict=True)):
        places = np.stack([_continued(level, line, _STATIONS) for line in pair])
        below, above = ndtr(places).mean(axis=0), ndtr(-places).mean(axis=0)
        scores = np.where(below < above, ndtri(below), -ndtri(above))
        response = ConditionalResponse(TabulatedDistribution(level, scores))
        unit = UnitResponse([response], np.ones(1))
        for tau, own in groups.items():
            thresholds, where = np.unique([criteria[i].threshold for i in own], return_inverse=True)
            mission = mission_probability(unit, units, thresholds, tau)
            failure[row, own] = mission.failure[where]
            success[row, own] = mission.success[where]
    columns = [
        over_missions(failure[:, i], success[:, i], criterion.missions)[0]
        for i, criterion in enumerate(criteria)
    ]
    return np.stack(columns, axis=1)
