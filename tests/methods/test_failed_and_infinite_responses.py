"""Failed runs and infinite responses: bounds that hold, and no error where none is known."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from uqfold.methods import (
    ActiveKriging,
    FFNIPearson,
    FFNISaddlepoint,
    Kriging,
    MonteCarlo,
    OpenTURNSMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
    build,
)
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion, criteria
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem()
METHODS = [
    FFNIPearson(),
    FFNIPearson(rows=500),
    FFNISaddlepoint(),
    Kriging(runs=12, trend="constant", kernel="gaussian"),
    PolynomialChaos(runs=12, max_degree=2),
    ActiveKriging(runs=12, kernel="gaussian"),
]


def problem(model: Callable[[FloatArray], FloatArray], units: int = 4) -> Problem:
    inputs = SYSTEM.problem().inputs
    return Problem(
        model,
        shared=inputs.distribution.getMarginal([0]),
        individual=inputs.distribution.getMarginal([1, 2]),
        names=inputs.names,
        units=units,
    )


def named(method: ReliabilityMethod) -> str:
    return f"{method.name}, {getattr(method, 'rows', None)} rows"


@pytest.mark.parametrize("method", METHODS, ids=named)
def test_bounds_hold_whatever_the_failed_runs_would_have_been(method: ReliabilityMethod) -> None:
    """pf_low, pf_high are bounds when half of the runs fail: also on what the method itself says
    of other responses, however far off."""
    asked = criteria([10.6], tau=[None, 2.5])

    def instead(response: float) -> Callable[[FloatArray], FloatArray]:
        return lambda x: np.where(x[:, 1] > 0.0, response, SYSTEM.response(x))

    rows = method.estimate(problem(instead(math.nan)), asked, rng=1)
    for row in rows:
        assert row.n_failed > 0
        assert row.status in {"doubtful", "unsupported"}
        assert math.isnan(row.std_error)
        assert math.isnan(row.ci_low)
        if row.status == "doubtful":
            assert row.pf_low <= row.pf <= row.pf_high
    # whatever a surface says of other responses lies between 0 and 1
    if all((row.pf_low, row.pf_high) == (0.0, 1.0) for row in rows if row.status == "doubtful"):
        return
    for other in (-50.0, 50.0):
        others = method.estimate(problem(instead(other)), asked, rng=1)
        for row, known in zip(rows, others, strict=True):
            if not math.isnan(known.pf) and row.status != "unsupported":
                assert row.pf_low <= known.pf <= row.pf_high


def test_shared_nodes_without_a_failed_run_keep_their_part_of_the_bounds() -> None:
    """One of three shared nodes is lost: it may add nothing, or its whole weight."""

    def lost(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] > 1.0, np.nan, SYSTEM.response(x))

    row = FFNIPearson().estimate(problem(lost), criteria(10.6))[0]
    whole = FFNIPearson().estimate(problem(SYSTEM.response), criteria(10.6))[0]
    assert row.pf_high - row.pf_low == pytest.approx(1 / 6, rel=1e-9)
    assert 0.3 < row.pf_low < whole.pf < row.pf_high


@pytest.mark.parametrize("tau", [None, 2.5])
@pytest.mark.parametrize("method", METHODS, ids=named)
def test_infinite_responses_are_never_a_clean_number(
    method: ReliabilityMethod, tau: float | None
) -> None:
    """-inf responses under tau, and without: moments and surfaces do not know where they are."""

    def model(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 0.4, -np.inf, SYSTEM.response(x))

    row = method.estimate(problem(model), criteria(10.6, tau=tau), rng=1)[0]
    assert row.status in {"doubtful", "unsupported"}
    assert "infinite" in row.message or row.status == "unsupported"
    assert row.n_failed == 0
    if row.status == "doubtful" and tau is not None:
        assert row.pf > 0.5


@pytest.mark.parametrize("units", [1, 3])
@pytest.mark.parametrize("method", METHODS, ids=named)
def test_nothing_but_minus_infinity(method: ReliabilityMethod, units: int) -> None:
    """It works for every T and fails under every tau: equal infinities do not agree."""
    asked = criteria([-math.inf, 0.0, math.inf], tau=[None, 0.0, math.inf])

    def model(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], -np.inf)

    for row in method.estimate(problem(model, units), asked, rng=1):
        assert row.status in {"doubtful", "unsupported"}
        if row.status == "doubtful":
            assert row.pf == (0.0 if math.isnan(row.tau) else 1.0)


@pytest.mark.parametrize(("response", "said"), [(math.nan, "failed runs"), (math.inf, "infinite")])
def test_what_only_the_last_check_has_met_makes_the_answer_doubtful(
    response: float, said: str
) -> None:
    """A run that fails, or is infinite, among the control runs of a check that has passed."""
    asked, method = criteria([10.6]), ActiveKriging(kernel="gaussian")
    good = method.estimate(problem(SYSTEM.response), asked, rng=1)
    (check,) = good.details.checks
    assert check.passed
    assert good[0].status == "converged"
    last = problem(SYSTEM.response).inputs.from_standard_normal(check.u)[-1]

    def model(x: FloatArray) -> FloatArray:
        there = np.abs(x - last).max(axis=1) < 1e-6
        return np.where(there, response, SYSTEM.response(x))

    row = method.estimate(problem(model), asked, rng=1)[0]
    assert row.n_evals == good[0].n_evals
    assert row.status == "doubtful"
    assert said in row.message
    assert math.isnan(row.std_error)
    if math.isnan(response):
        assert row.n_failed == 1
        assert (row.pf_low, row.pf_high) == (0.0, 1.0)


@pytest.mark.parametrize(
    "method", [OpenTURNSMonteCarlo(target_cov=0.01), MonteCarlo(target_cov=0.01)], ids=named
)
def test_failed_runs_are_doubtful_also_where_the_budget_ends(method: ReliabilityMethod) -> None:
    """Failed runs leave bounds apart: a doubt, and more than the end of the budget."""
    failing = problem(lambda x: np.where(x[:, 1] > 1.0, math.nan, SYSTEM.response(x)), units=1)
    row = method.estimate(failing, criteria(10.6), max_evals=1000, rng=1)[0]
    assert row.pf_low < row.pf_high
    assert row.status == "doubtful"
    assert "the stated error is above 1% of pf" in row.message
    assert f"{row.n_failed} of {row.n_evals} runs failed" in row.message


@pytest.mark.parametrize("name", ["openturns-form", "sorm", "line-sampling", "importance-sampling"])
def test_responses_near_the_largest_number_are_answered(name: str) -> None:
    """Their differences and squares are no numbers, but distances in the inputs are."""
    inputs = {"a": stats.norm(), "b": stats.norm()}
    problem = Problem(
        lambda x: 1.7e308 * np.tanh(0.5 * x[:, 0] + 0.05 * x[:, 1]), individual=inputs
    )
    row = build(name).estimate(problem, Criterion(1.6e308), max_evals=8_000, rng=1)[0]
    exact = float(stats.norm.sf(math.atanh(1.6 / 1.7) / math.hypot(0.5, 0.05)))
    assert row.pf == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize("name", ["ffni", "ffni-spa", "ffni-pearson", "kriging", "pce"])
def test_what_no_fit_can_square_is_refused_with_the_remedy(name: str) -> None:
    inputs = {"a": stats.norm(), "b": stats.norm()}
    problem = Problem(lambda x: 1.7e308 * np.tanh(x[:, 0] + 0.1 * x[:, 1]), individual=inputs)
    row = build(name).estimate(problem, Criterion(1.6e308), max_evals=200, rng=1)[0]
    assert row.status == "failed"
    assert "state them in another unit" in row.message


@pytest.mark.parametrize("name", ["active-kriging", "ffni", "kriging"])
def test_thresholds_near_the_largest_number_are_answered(name: str) -> None:
    inputs = {"a": stats.norm(), "b": stats.norm()}
    problem = Problem(lambda x: x[:, 0] + 0.1 * x[:, 1] ** 2, individual=inputs)
    rows = build(name).estimate(problem, criteria([1.7e308, -1.7e308]), max_evals=60, rng=1)
    assert [row.pf for row in rows] == [0.0, 1.0]
