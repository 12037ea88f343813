"""Every method on discrete inputs: the right answer, or why there is none, before any run."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import openturns as ot
import pytest
from scipy.special import ndtr
from scipy.stats import poisson as poisson_law

import uqfold
from uqfold.inputs import bernoulli, censored, discrete, normal, poisson
from uqfold.methods import FFNISaddlepoint, Kriging, OpenTURNSFORM, available, build

THRESHOLD = 7.0
RUNS = 6_000


def _response(x: Any) -> Any:
    gust, cracks, load = x.T
    return 3.0 * gust + cracks + load


def _coarse(x: Any) -> Any:
    return _response(x) - 0.1 * x[:, 1]


def storm(units: int = 2) -> uqfold.Problem:
    """Return units that a gust hits together, each with cracks of its own."""
    return uqfold.Problem(
        _response,
        shared={"gust": bernoulli(0.1)},
        individual={"cracks": poisson(2.0), "load": normal(0.0, 1.0)},
        units=units,
        low_fidelity=_coarse,
    )


def pf_of_storm(units: int = 2) -> float:
    """Return the probability that one unit or more exceeds the threshold: sums over all values."""
    k = np.arange(60)
    p = [poisson_law(2.0).pmf(k) @ ndtr(-(THRESHOLD - 3.0 * gust - k)) for gust in (0.0, 1.0)]
    return sum(w * -math.expm1(units * math.log1p(-q)) for w, q in zip((0.9, 0.1), p, strict=True))


ANEW = "cracks is discrete, and drawn anew for every unit and mission"


@pytest.mark.parametrize("name", available())
def test_every_method_is_right_or_says_why_not(name: str) -> None:
    asked: list[int] = []

    def counted(x: Any) -> Any:
        asked.append(len(x))
        return _response(x)

    problem = uqfold.Problem(counted, inputs=storm().inputs, units=2, low_fidelity=_coarse)
    row = build(name).estimate(problem, THRESHOLD, max_evals=RUNS, rng=1)[0]
    if row.status == "unsupported":
        assert row.message == f"{name} needs continuous inputs: {ANEW}"
        assert not asked
        assert not available()[name].inputs_may_step
        return
    truth = pf_of_storm()
    assert row.status in ("converged", "doubtful", "budget_exhausted"), row.message
    assert row.std_error > 0.0
    assert abs(row.pf - truth) <= 4.0 * row.std_error
    assert row.std_error < 0.5 * truth


HELD = [
    OpenTURNSFORM(),
    FFNISaddlepoint(),
    Kriging(runs=20, kernel="gaussian", trend="linear"),
]


@pytest.mark.parametrize("method", HELD, ids=lambda one: one.name)
def test_of_one_unit_answers_for_all_values_are_summed_up(method: Any) -> None:
    seen = np.empty((0, 3))

    def noted(x: Any) -> Any:
        nonlocal seen
        seen = np.vstack([seen, x])
        return _response(x)

    values, p = np.array([0.0, 1.0, 3.0]), np.array([0.6, 0.3, 0.1])
    problem = uqfold.Problem(
        noted,
        shared={"gust": bernoulli(0.1)},
        individual={"cracks": discrete(values, p), "load": normal(0.0, 1.0)},
    )
    thresholds = (3.7, THRESHOLD)
    result = method.estimate(problem, uqfold.criteria(thresholds), rng=1)
    for row, threshold in zip(result, thresholds, strict=True):
        given = [p @ ndtr(-(threshold - 3.0 * gust - values)) for gust in (0.0, 1.0)]
        assert row.status == "converged", row.message
        assert row.pf == pytest.approx(0.9 * given[0] + 0.1 * given[1], rel=0.02)
        assert row.message == "given each of 6 values of gust, cracks"
        assert row.ci_low <= row.pf <= row.ci_high
    held = result.details.held
    assert held.names == ("gust", "cracks")
    assert held.probabilities.sum() == pytest.approx(1.0, abs=1e-12)
    # nothing but values that occur reaches the model
    assert set(np.unique(seen[:, 0])) == {0.0, 1.0}
    assert set(np.unique(seen[:, 1])) == set(values)


def test_a_shared_value_is_held_for_all_units_and_missions() -> None:
    problem = uqfold.Problem(
        lambda x: 2.0 * x[:, 0] + 0.5 * x[:, 1] + x[:, 2],
        shared={"gust": bernoulli(0.1), "wind": normal(0.0, 1.0)},
        individual={"load": normal(0.0, 1.0)},
        units=3,
    )
    node, weight = np.polynomial.hermite_e.hermegauss(60)
    q = [ndtr(-(4.0 - 2.0 * gust - 0.5 * node)) for gust in (0.0, 1.0)]
    given = [-np.expm1(6.0 * np.log1p(-one)) @ weight / weight.sum() for one in q]
    row = OpenTURNSFORM().estimate(problem, uqfold.criteria(4.0, missions=2))[0]
    assert row.status == "converged"
    assert row.pf == pytest.approx(0.9 * given[0] + 0.1 * given[1], rel=1e-3)


def test_a_doubt_for_one_value_is_one_of_the_sum_unless_the_value_is_too_rare() -> None:
    def response(x: Any) -> Any:
        # flat where nothing blows
        return np.where(x[:, 0] == 1.0, x[:, 1], -9.0)

    def asked(p: float) -> Any:
        problem = uqfold.Problem(
            response, individual={"gust": bernoulli(p), "load": normal(0.0, 1.0)}
        )
        return OpenTURNSFORM().estimate(problem, 1.0)[0]

    half = asked(0.5)
    assert half.status == "doubtful"
    assert half.pf == pytest.approx(0.5 * ndtr(-1.0), rel=1e-6)
    assert "gust = 0: no run out of" in half.message
    assert math.isnan(half.ci_low)
    assert math.isnan(half.ci_high)
    calm = asked(1.0 - 1e-4)
    assert calm.status == "converged"
    assert calm.ci_high >= calm.pf + 1e-4


def test_failed_runs_for_one_value_bound_the_sum() -> None:
    def response(x: Any) -> Any:
        y = x[:, 0] + x[:, 1]
        return np.where((x[:, 0] == 1.0) & (x[:, 1] > 2.0), np.nan, y)

    problem = uqfold.Problem(
        response, individual={"gust": bernoulli(0.2), "load": normal(0.0, 1.0)}
    )
    method = Kriging(runs=30, kernel="gaussian", trend="linear")
    row = method.estimate(problem, 2.0, rng=1)[0]
    assert row.status == "doubtful"
    assert row.n_failed > 0
    assert row.pf_low < row.pf <= row.pf_high
    failed = OpenTURNSFORM().estimate(problem, 2.0)[0]
    assert failed.status == "failed" or failed.n_failed == 0


def test_seeds_budgets_and_sessions_are_kept() -> None:
    problem = uqfold.Problem(
        lambda x: x.sum(axis=1), individual={"gust": bernoulli(0.2), "load": normal(0.0, 1.0)}
    )
    method = Kriging(runs=12, kernel="gaussian", trend="linear")
    one, two = (method.estimate(problem, 2.0, rng=3) for _ in range(2))
    assert one.pf.tolist() == two.pf.tolist()
    short = method.estimate(problem, 2.0, max_evals=3, rng=3)[0]
    assert short.status == "failed"
    assert short.n_evals <= 3
    elsewhere = uqfold.Problem(None, inputs=problem.inputs)
    session = method.start(elsewhere, 2.0, rng=3)
    while not session.done:
        x = session.ask()
        assert x.shape[1] == 2
        session.tell(x, x.sum(axis=1))
    assert session.result().pf.tolist() == one.pf.tolist()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"individual": {"a": poisson(2.0), "b": poisson(1.0)}},
            "a is discrete, and so are all others",
        ),
        (
            {"individual": {"a": poisson(200.0), "b": normal(0, 1)}},
            "a takes more than 50 values",
        ),
        (
            {
                "inputs": ot.JointDistribution(
                    [bernoulli(0.5), ot.Normal()],
                    ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.5], [0.5, 1.0]])),
                ),
            },
            "X0 is discrete and depends on others",
        ),
        (
            {
                "shared": {"a": bernoulli(0.5)},
                "individual": {"b": normal(0, 1)},
                "units": [uqfold.Unit(), uqfold.Unit(individual={"c": normal(1, 1)})],
            },
            "a is discrete, in units with models or inputs of their own",
        ),
    ],
)
def test_what_cannot_be_held_is_told(options: dict[str, Any], message: str) -> None:
    problem = uqfold.Problem(lambda x: x.sum(axis=1), **options)
    row = OpenTURNSFORM().estimate(problem, 3.0)[0]
    assert row.status == "unsupported"
    assert row.message == f"openturns-form needs continuous inputs: {message}"
    assert uqfold.methods.MonteCarlo().estimate(problem, 3.0, max_evals=100, rng=1)[0].pf >= 0.0


def test_an_input_that_is_cut_off_has_no_steps_and_is_open_to_more_methods() -> None:
    snow = censored(normal(-1.0, 1.0), low=0.0)
    problem = uqfold.Problem(
        lambda x: x[:, 0] + x[:, 1], individual={"snow": snow, "load": normal(0.0, 0.5)}
    )
    grid = np.linspace(-9.0, 9.0, 4_001)
    density = np.exp(-0.5 * grid**2) / math.sqrt(2.0 * math.pi) * (grid[1] - grid[0])
    truth = float(density @ ndtr(-(3.0 - np.maximum(0.0, grid - 1.0)) / 0.5))
    row = build("line-sampling").estimate(problem, 3.0, max_evals=2_000, rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - truth) <= max(4.0 * row.std_error, 2e-3 * truth)
    refused = build("ffni").estimate(problem, 3.0, rng=1)[0]
    assert refused.status == "unsupported"
    assert "no Gauss rule for snow" in refused.message


def test_runs_for_each_value_are_kept_in_a_store(tmp_path: Path) -> None:
    inputs = {"gust": bernoulli(0.2), "load": normal(0.0, 1.0)}
    problem = uqfold.Problem(_sum, individual=inputs, version="1")
    evaluator = uqfold.Evaluator(store=tmp_path / "runs.db")
    first, second = (OpenTURNSFORM().estimate(problem, 2.0, evaluator=evaluator) for _ in range(2))
    assert first.n_reused == 0
    assert second.n_reused == second.n_evals == first.n_evals
    assert f"{second.n_evals} of them from a store" in str(second)
    assert second.pf.tolist() == first.pf.tolist()


def _sum(x: Any) -> Any:
    return x.sum(axis=1)
