"""Many inputs: right where five runs for each of them tell, doubtful where fewer cannot."""

import numpy as np
import pytest

from uqfold.inputs import normal
from uqfold.methods import ActiveKriging, PolynomialChaos
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

D, PF = 40, 1e-6
# By inversion of the characteristic function of a quadratic form in normal variables.
LIMIT = 19.622914076511428


def limit_state(x: FloatArray) -> FloatArray:
    """Linear in 40 inputs, each of them mildly curved."""
    return LIMIT - x @ np.linspace(1.0, 0.1, D) - 0.02 * (x**2).sum(axis=1)


PROBLEM = Problem.from_limit_state(limit_state, {f"x{i}": normal(0.0, 1.0) for i in range(D)})


@pytest.mark.thorough
def test_forty_mildly_curved_inputs_are_right_by_default() -> None:
    """100 runs gave a plane, and pf off by hundreds of per cent."""
    row = PolynomialChaos().estimate(PROBLEM, rng=1)[0]
    assert row.n_evals == 5 * D
    assert row.status == "converged"
    assert row.pf == pytest.approx(PF, rel=0.05)
    assert row.ci_low <= PF <= row.ci_high


@pytest.mark.parametrize("seed", [1, 2])
def test_runs_too_few_for_the_curvature_of_many_inputs_are_doubtful(seed: int) -> None:
    row = PolynomialChaos(runs=85).estimate(PROBLEM, rng=seed)[0]
    assert row.status == "doubtful"


def test_active_learning_in_many_inputs_takes_few_steps() -> None:
    """Thirty inputs took 35 steps, each of them a fit of more than a hundred runs."""
    plane = Problem(lambda x: x.sum(axis=1), individual=[normal(0.0, 1.0)] * 20)
    method = ActiveKriging(runs=108, initial=90, kernel="gaussian", noise=0.0)
    history = method.estimate(plane, Criterion(16.0), rng=1).details.history_runs
    assert history[:2].tolist() == [90, 99]
