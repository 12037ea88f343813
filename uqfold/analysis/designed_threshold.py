"""The smallest response threshold T that meets a target failure probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.analysis.design import MOST_POINTS, Design, Scan, checked_target, located
from uqfold.checks import listed, refused, whole
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import checked_problem
from uqfold.methods.base import ReliabilityMethod, checked_method
from uqfold.methods.kriging import Kriging
from uqfold.methods.result import CriterionResult
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion, Missions


def design_threshold(
    problem: Problem,
    target_pf: float,
    between: tuple[float, float],
    *,
    tau: float | None = None,
    missions: Missions = 1,
    method: ReliabilityMethod | None = None,
    points: int = 129,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> Design:
    """Find the smallest threshold T for which pf <= target; see `design_thresholds`.

    Parameters
    ----------
    tau, missions
        The rest of the criterion.

    Examples
    --------
    >>> import uqfold
    >>> from uqfold.analysis import design_threshold
    >>> method = uqfold.methods.Kriging(runs=40)
    >>> design = design_threshold(
    ...     uqfold.problems.series(), 1e-3, between=(0.0, 8.0), method=method, rng=1
    ... )
    >>> design.status, f"{design.value:.2f}"
    ('found', '4.18')
    """
    asked = [(tau, missions)]
    return design_thresholds(
        problem, target_pf, between, asked, method=method, points=points, max_evals=max_evals,
        rng=rng, evaluator=evaluator,
    )[0]  # fmt: skip


def design_thresholds(
    problem: Problem,
    target_pf: float,
    between: tuple[float, float],
    profiles: Sequence[tuple[float | None, Missions]],
    *,
    method: ReliabilityMethod | None = None,
    points: int = 129,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> list[Design]:
    """Find the smallest threshold T for several tau and missions from one run of a method.

    pf never rises with T, so that the target is met from one T on. The method answers a row of
    thresholds over the range; its interval on pf becomes the interval on T.

    Parameters
    ----------
    problem
        Model, inputs and units.
    target_pf
        Failure probability to be met: pf <= target.
    between
        Range of T to look at, in the unit of the response.
    profiles
        Pairs of tau (or None) and missions.
    method
        Any method; None: `Kriging` with its default settings.
    points
        Thresholds in the range, from 9 to 10,000.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Returns
    -------
    list[Design]
        One per profile.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, before any run is spent.
    """
    checked_problem(problem)
    target_pf, (low, high) = checked_target(target_pf, between)
    points = whole("points", points, at_least=9, at_most=MOST_POINTS)
    thresholds = np.linspace(low, high, points).tolist()
    grid = Criteria(
        Criterion(threshold, tau, missions)
        for tau, missions in _checked_profiles(profiles)
        for threshold in thresholds
    )
    chosen = checked_method(method) or Kriging()
    result = chosen.estimate(problem, grid, max_evals=max_evals, rng=rng, evaluator=evaluator)
    designs = []
    for k in range(len(grid) // len(thresholds)):
        rows = result.rows[k * len(thresholds) : (k + 1) * len(thresholds)]
        designs.append(
            _design(problem, target_pf, (low, high), grid[k * len(thresholds)],
                    Scan.of(thresholds, rows), rows[0])
        )  # fmt: skip
    return designs


def _checked_profiles(
    profiles: Sequence[tuple[float | None, Missions]],
) -> list[tuple[float | None, Missions]]:
    pairs = [listed(f"profiles[{i}]", one) for i, one in enumerate(listed("profiles", profiles))]
    if not pairs or any(len(pair) != 2 for pair in pairs):
        raise refused("profiles", profiles, "give pairs of tau (or None) and missions")
    return [(tau, missions) for tau, missions in pairs]


def _design(
    problem: Problem,
    target_pf: float,
    between: tuple[float, float],
    criterion: Criterion,
    scan: Scan,
    row: CriterionResult,
) -> Design:
    found, low, high = located(scan, target_pf, "smallest")

    def place(threshold: float) -> tuple[Problem, Criterion]:
        return problem, replace(criterion, threshold=threshold)

    return Design(
        parameter=f"threshold on {problem.response}",
        unit=problem.response_unit,
        target_pf=target_pf,
        seek="smallest",
        between=between,
        status=found.status,
        message=found.message,
        value=found.value,
        low=low,
        high=high,
        scan=scan,
        criterion=criterion,
        method=row.method,
        n_evals=row.n_evals,
        n_reused=row.n_reused,
        seconds=row.seconds,
        seed=row.seed,
        place=place,
    )
