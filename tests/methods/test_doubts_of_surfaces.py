"""What a surface does not describe: it is doubted, and no interval pretends to know it."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

import uqfold
from uqfold.methods import Kriging, PolynomialChaos, surface_errors, surface_verdict
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.fitted_kind import FittedKind, HeldOut
from uqfold.methods.result import CriterionResult
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

ROOT_TWO = math.sqrt(2.0)


def answer(model: object, threshold: float, d: int = 2) -> CriterionResult:
    problem = uqfold.Problem(model, individual=[stats.norm() for _ in range(d)])  # type: ignore[arg-type]
    return PolynomialChaos().estimate(problem, uqfold.criteria(threshold), rng=0)[0]


def test_responses_that_differ_in_their_last_digits_are_doubted() -> None:
    """1e12 + 1e-3 u: pf = 1e-3 was called 0 with an error of 0, and converged."""
    row = answer(lambda x: 1e12 + 1e-3 * x[:, 0], 1e12 + 3.05e-3, d=1)
    assert row.status == "doubtful"
    assert "last digit" in row.message
    assert math.isnan(row.ci_low)


def test_a_hundred_runs_that_all_give_nought_are_doubted() -> None:
    """Their process was so small that its inverse overflowed: `failed`, and a warning of NumPy."""
    problem = uqfold.Problem(lambda x: 0.0 * x[:, 0], individual=stats.norm())
    row = Kriging(runs=100).estimate(problem, uqfold.criteria(1.0), rng=0)[0]
    assert (row.pf, row.status) == (0.0, "doubtful")
    assert "all runs gave the same response" in row.message


def test_no_failure_on_the_surface_is_no_certainty() -> None:
    """A thin band that no run has met: pf = 0 with an error of 0 is never converged."""

    def band(x: FloatArray) -> FloatArray:
        return np.tanh(0.1 * x[:, 0]) + 50.0 * (np.abs(x[:, 1] - 2.5) < 1e-4)

    row = answer(band, 30.0)
    assert (row.pf, row.status) == (0.0, "doubtful")
    assert math.isnan(row.std_error)


def test_a_threshold_at_infinity_is_a_doubt() -> None:
    """A surface of finite responses knows of no infinite ones."""
    row = answer(lambda x: x.sum(axis=1), math.inf)
    assert (row.pf, row.status) == (0.0, "doubtful")
    assert math.isnan(row.std_error)


@pytest.mark.parametrize("threshold", [0.0, 1.0])
def test_the_interval_holds_the_step_in_which_the_threshold_lies(threshold: float) -> None:
    """round(2 (x + y)) / 2: the border lies half a step beyond where a smooth surface crosses T."""
    row = answer(lambda x: np.round(2.0 * x.sum(axis=1)) / 2.0, threshold)
    exact = float(stats.norm.sf((threshold + 0.25) / ROOT_TWO))
    assert row.status == "doubtful"
    assert math.isnan(row.ci_low) or row.ci_low <= exact <= row.ci_high


@pytest.mark.parametrize("seed", [0, 3])
def test_beside_a_plateau_the_bend_of_the_surface_is_an_error(seed: int) -> None:
    """Clipped at 4, T = 3.9: kriging was 7 to 16 % of pf too low, 1 to 3 % stated, converged."""

    def clipped(x: FloatArray) -> FloatArray:
        return np.clip(x.sum(axis=1), -4.0, 4.0)

    problem = uqfold.Problem(clipped, individual=[stats.norm(), stats.norm()])
    row = Kriging(runs=100).estimate(problem, uqfold.criteria([0.0, 3.9]), rng=seed)
    exact = float(stats.norm.sf(3.9 / ROOT_TWO))
    assert row[1].status == "doubtful"
    assert row[1].ci_low < exact < row[1].ci_high
    # far from both plateaus nothing bends
    assert (row[0].status, row[0].pf) == ("converged", pytest.approx(0.5, rel=0.02))


def test_a_surface_that_predicts_badly_states_no_interval() -> None:
    """Two regimes: the interval of a surface that misses left-out runs held no truth."""

    def regimes(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] < 1.0, x[:, 1], 1.0 - 2.0 * x[:, 1])

    row = answer(regimes, 3.0)
    assert row.status == "doubtful"
    assert "left out" in row.message
    assert math.isnan(row.ci_low)
    assert math.isnan(row.std_error)
    assert row.error_kind == "none"


def test_runs_added_until_a_step_looks_predicted_do_not_make_it_so() -> None:
    """Kriging with 200 and 300 runs called steps converged that it had doubted with 100."""
    limits = [
        surface_verdict.poor_share(DesignRuns(np.zeros((n, 1)), np.zeros(n), n))
        for n in (50, 100, 300)
    ]
    assert limits == pytest.approx([0.1, 0.1, 0.1 / 3.0])


def test_runs_near_the_threshold_that_are_missed_by_half_more_widen_the_error() -> None:
    """A surface sure of itself on the whole, and missing its outer runs, is believed less there."""
    y = np.arange(100.0)
    residuals = np.where(y >= 90.0, 1.5, 0.5) * np.where(y % 2 == 0.0, 1.0, -1.0)
    validated = LeaveOneOut(residuals, np.ones(100))
    assert surface_errors.overconfidence(validated, y, 110.0) == pytest.approx(1.5)
    assert surface_errors.overconfidence(validated, y, 50.0) == 1.0


def test_outer_runs_that_are_missed_to_one_side_count_as_an_error() -> None:
    """Where a tail is extrapolated, it is wrong by more than scatter says."""
    y = np.arange(100.0)
    outer = np.where(y >= 90.0, 0.5, 0.0)
    scatter = np.where(y % 2 == 0.0, 0.1, -0.1)
    runs = DesignRuns(np.zeros((100, 1)), y, 100)
    lean = []
    for some in (outer + scatter, scatter):
        validated = LeaveOneOut(some, np.ones(100))
        surface: Any = SimpleNamespace(leave_one_out=lambda known=validated: known)
        fitted = [FittedKind(surface, runs)]
        lean.append(surface_errors.lean(fitted, Criterion(110.0), SystemUnits(1)))
    assert lean == pytest.approx([0.5, 0.0])


def test_runs_held_out_at_the_limit_speak_against_the_stated_error() -> None:
    """One of six that is missed by far, or all missed to one side, by more than is stated."""
    y = np.linspace(0.0, 10.0, 100)
    validated = LeaveOneOut(np.where(np.arange(100) % 2 == 0, 0.1, -0.1), np.full(100, 0.1))
    surface: Any = SimpleNamespace(leave_one_out=lambda: validated)
    fitted = [FittedKind(surface, DesignRuns(np.zeros((100, 1)), y, 100))]
    one_far = np.array([0.0, 0.0, 0.6, 0.0, 0.0, 0.0])
    foretold, elsewhere = np.full(6, 5.0), np.full(6, 9.0)
    told = []
    for residuals, where in ((one_far, foretold), (np.zeros(6), foretold), (one_far, elsewhere)):
        # those at another threshold say nothing of this one
        near = np.concatenate([where, foretold[where != foretold]])
        errors = np.concatenate([residuals, np.zeros(near.size - 6)])
        held = HeldOut(near, LeaveOneOut(errors, np.full(near.size, 0.1)))
        factor = surface_errors.overconfidence(validated, y, 5.0, held)
        lean = surface_errors.lean(fitted, Criterion(5.0), SystemUnits(1), [held])
        told.append((factor, lean))
    assert told[0] == (pytest.approx(math.sqrt(6.0)), pytest.approx(0.1))
    assert told[1] == told[2] == (pytest.approx(1.0), 0.0)


def sway(x: FloatArray) -> FloatArray:
    """Sway of a frame: six loads over two stiffnesses and a length."""
    loads = np.array([1.0, 0.8, 0.6, 0.5, 0.3, 0.2])
    column, beam, length = x[:, 6:].T
    slope = (1.0 + 0.02 * length) ** 3 * (np.exp(-0.1 * column) + 0.5 * np.exp(-0.15 * beam))
    return slope * (loads.sum() + 0.25 * x[:, :6] @ loads)


def test_a_budget_above_the_design_buys_runs_at_the_limit() -> None:
    """Kriging was 19 % too low in a tail, 7.7 % stated, converged: no residual showed it."""
    problem = uqfold.Problem(sway, individual=[stats.norm()] * 9)
    method = Kriging(target_cov=0.25)
    [row] = method.estimate(problem, uqfold.criteria(10.0), max_evals=106, rng=51)
    assert row.n_evals == 106
    # by quadrature
    assert row.ci_low < 9.117e-7 < row.ci_high


def test_what_hangs_on_few_runs_is_not_known() -> None:
    """A step in five inputs: 16 % too low, 2.1 % stated, converged without runs at its limit."""

    def step(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] > 2.0, 3.0, 0.0) + x[:, 1:].sum(axis=1)

    problem = uqfold.Problem(step, individual=[stats.norm()] * 5)
    method = Kriging(runs=100, trend="pce", kernel="matern52")
    [row] = method.estimate(problem, uqfold.criteria(7.0), rng=1)
    beyond = stats.norm.sf(2.0)
    exact = beyond * stats.norm.sf(2.0) + (1.0 - beyond) * stats.norm.sf(3.5)
    assert abs(row.pf - exact) < 3.0 * row.std_error
