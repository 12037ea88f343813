"""Monte Carlo with a cheap partner, against exact pairs of models."""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import openturns as ot
import pytest
from scipy.special import ndtr
from scipy.stats import binom, chi2

from uqfold.evaluation import Evaluator, TimeLimitError
from uqfold.inputs import normal
from uqfold.methods import MonteCarlo, MultifidelityMonteCarlo
from uqfold.methods.partner_allocation import inclusion
from uqfold.methods.partner_sample import Partner
from uqfold.methods.partner_sums import PartnerSums, weighted_count
from uqfold.methods.result import CriterionResult
from uqfold.methods.task import Task
from uqfold.problems import Problem, Unit
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.problems.structure import KOutOfN
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray

Response = Callable[[FloatArray], FloatArray]
METHOD = MultifidelityMonteCarlo(partner_systems=4_000, cost_ratio=20.0, pilot=60)


def total(x: FloatArray) -> FloatArray:
    return x[:, 0] + x[:, 1]


def close(x: FloatArray) -> FloatArray:
    return total(x) + 0.05 + 0.03 * np.sin(5.0 * x[:, 0])


def blind(x: FloatArray) -> FloatArray:
    """Of a failure mode of its own nothing is left in the partner."""
    return np.where(x[:, 1] < -1.5, -5.0, total(x))


def two_modes(x: FloatArray) -> FloatArray:
    return np.where(x[:, 1] < -2.6, 9.0, total(x))


def useless(x: FloatArray) -> FloatArray:
    return 4.0 * np.sin(40.0 * x[:, 0])


def pair(model: Response, partner: Response, units: int = 1) -> Problem:
    return Problem(
        model,
        shared={"V": normal(0.0, 1.0)},
        individual={"U": normal(0.0, 1.0)},
        units=units,
        low_fidelity=partner,
    )


def repeated(problem: Problem, threshold: float, budget: int, seeds: int) -> list[CriterionResult]:
    return [
        METHOD.estimate(problem, Criterion(threshold), max_evals=budget, rng=seed)[0]
        for seed in range(seeds)
    ]


FAR = 2.0
"""Threshold of the exact pairs, sqrt(2) standard deviations away."""
PLAIN = float(ndtr(-FAR / math.sqrt(2.0)))


def in_two_modes() -> float:
    u = np.linspace(-2.6, 9.0, 20_001)
    density = np.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi)
    return float(ndtr(-2.6) + np.trapezoid(density * ndtr(u - FAR), u))


@pytest.mark.parametrize(
    ("model", "partner", "exact", "of_crude", "seeds"),
    [
        pytest.param(total, close, PLAIN, 0.5, 300, id="close", marks=pytest.mark.slow),
        pytest.param(
            total, lambda x: np.minimum(total(x), 1.9), PLAIN, 1.3, 300,
            id="no tail", marks=pytest.mark.slow,
        ),
        pytest.param(
            two_modes, blind, in_two_modes(), 1.0, 300,
            id="wrong in one region", marks=pytest.mark.slow,
        ),
        pytest.param(two_modes, blind, in_two_modes(), 1.0, 60, id="wrong in one region, fewer"),
        pytest.param(total, useless, PLAIN, 1.3, 300, id="useless", marks=pytest.mark.slow),
    ],
)  # fmt: skip
def test_whatever_the_partner_is_the_estimate_is_without_bias_and_its_interval_holds(
    model: Response, partner: Response, exact: float, of_crude: float, seeds: int
) -> None:
    """Multifidelity over many seeds: mean, stated error, interval, and the error of crude runs."""
    budget = 500
    rows = repeated(pair(model, partner), FAR, budget, seeds)
    pf, stated = (np.array([getattr(row, name) for row in rows]) for name in ("pf", "std_error"))
    spread = float(pf.std(ddof=1))
    assert abs(pf.mean() - exact) < 4.0 * spread / math.sqrt(seeds)
    assert spread < of_crude * math.sqrt(exact * (1.0 - exact) / budget)
    # four standard errors of a spread
    assert math.sqrt(np.mean(stated**2)) == pytest.approx(spread, rel=4.0 / math.sqrt(2 * seeds))
    covered = sum(row.ci_low <= exact <= row.ci_high for row in rows)
    assert covered >= binom.ppf(1e-4, seeds, 0.95)


def test_what_no_run_has_shown_is_in_the_interval_and_a_doubt() -> None:
    """A partner right in every run seen: the standard error is small, the interval is not."""
    problem, exact = pair(total, close), float(ndtr(-4.0 / math.sqrt(2.0)))
    row = MultifidelityMonteCarlo().estimate(problem, Criterion(4.0), max_evals=1_000, rng=1)[0]
    assert row.std_error < 0.1 * row.pf
    assert row.ci_high - row.pf > 2.0 / 1_000
    assert row.status == "doubtful"
    assert "do not tell whether the partner is wrong elsewhere" in row.message
    assert row.ci_low < exact < row.ci_high


def test_an_error_that_rests_on_few_wrong_verdicts_is_doubted() -> None:
    """By the effective number of those seen; where the partner's part is larger they matter not."""
    problem = pair(total, close)
    sums = PartnerSums(Task(problem, (Criterion(FAR),), 1, Evaluator().open(problem, None)))
    sums.population, sums.systems, sums.by_partner = 100_000, 1_000, np.array([10_000.0])
    sums.unseen[:, 1], sums.squares[:, 1], sums.total[:, 1] = 900.0, 8_000.0, 910.0
    assert sums.alike(0) == math.inf
    sums.squares[:, 1] = 200_000.0
    assert sums.alike(0) == pytest.approx(4.05)
    answer = sums.estimate(0, 0.1, [], "")
    assert answer.status == "doubtful"
    assert "rests on about 4 systems with a wrong verdict" in answer.message


def test_a_useless_partner_costs_the_pilot_and_says_so() -> None:
    result = METHOD.estimate(pair(total, useless), Criterion(FAR), max_evals=1_000, rng=3)
    row, details = result[0], result.details
    assert "the partner is of no use" in row.message
    assert row.n_evals == 1_000
    assert details.pilot_systems == 60
    assert details.systems == 940
    assert details.partner_systems == 0
    assert row.pf == round(940 * row.pf) / 940
    assert row.ci_kind == "clopper-pearson 95 %"


@pytest.mark.parametrize("partner", ["nan", "wrong shape"])
def test_a_partner_that_cannot_be_run_leaves_crude_monte_carlo(partner: str) -> None:
    def broken(x: FloatArray) -> FloatArray:
        return np.full(len(x) + (partner != "nan"), np.nan)

    row = METHOD.estimate(pair(total, broken), Criterion(FAR), max_evals=900, rng=1)[0]
    assert "the partner failed" in row.message
    assert row.n_failed == 0
    assert abs(row.pf - PLAIN) < 4.0 * row.std_error


def test_failed_runs_of_the_partner_are_counted_apart_and_do_no_harm() -> None:
    def often(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.5, np.nan, close(x))

    problem = pair(total, often)
    result = METHOD.estimate(problem, Criterion(FAR), max_evals=900, rng=2)
    assert result.n_failed == 0
    assert 0.05 < result.details.partner_failed / result.details.partner_evals < 0.09
    assert result.details.partner_evals == 2 * 20 * 60 + 4_000
    assert abs(result[0].pf - PLAIN) < 4.0 * result[0].std_error
    assert result[0].pf_low == result[0].pf_high


def test_failed_runs_of_the_model_are_bounded() -> None:
    def lost(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 2.0, np.nan, total(x))

    row = METHOD.estimate(pair(lost, close), Criterion(FAR), max_evals=900, rng=1)[0]
    assert row.status == "doubtful"
    assert row.ci_low < PLAIN < row.ci_high
    assert row.pf_low < row.pf_high == row.pf


def test_a_problem_without_a_partner_is_unsupported_before_any_run() -> None:
    """Also where one unit has a model of its own without one; a partner of its own mends it."""

    def other(x: FloatArray) -> FloatArray:
        return total(x) - 0.2

    def asked(units: list[Unit] | int, partner: Response | None) -> CriterionResult:
        problem = Problem(
            total, shared={"V": normal(0.0, 1.0)}, individual={"U": normal(0.0, 1.0)},
            units=units, low_fidelity=partner,
        )  # fmt: skip
        return METHOD.estimate(problem, Criterion(FAR), max_evals=2_000, rng=1)[0]

    for units, partner, remedy in (
        (1, None, "low_fidelity="),
        ([Unit(), Unit(model=other)], close, "Unit(low_fidelity=...)"),
    ):
        row = asked(units, partner)
        assert (row.status, row.n_evals) == ("unsupported", 0)
        assert remedy in row.message
    row = asked([Unit(), Unit(model=other, low_fidelity=lambda x: close(x) - 0.2)], close)
    v = np.linspace(-9.0, 9.0, 20_001)
    density = np.exp(-0.5 * v * v) / math.sqrt(2.0 * math.pi)
    exact = np.trapezoid(density * (1.0 - ndtr(FAR - v) * ndtr(FAR + 0.2 - v)), v)
    assert abs(row.pf - exact) < 4.0 * row.std_error
    assert row.std_error < 0.7 * math.sqrt(exact / 1_000)


def test_structures_missions_and_tau_at_once() -> None:
    """Every criterion is exact within its error, and better than crude runs make it."""
    series = LinearNormalSystem(units=3, shared_std=0.5)
    asked = criteria([11.0, 12.0], tau=[None, 2.5], missions=[1, Binomial(3, 0.6)])
    spare = LinearNormalSystem(units=3, structure=KOutOfN(2))
    method = replace(METHOD, partner_systems=20_000)
    for system, grid in ((series, asked), (spare, criteria([10.5, 11.5]))):
        result = method.estimate(system.problem(), grid, max_evals=9_000, rng=4)
        for criterion, row in zip(grid, result, strict=True):
            assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error
        crude = MonteCarlo().estimate(system.problem(), grid, max_evals=9_000, rng=4)
        ratio = [a.std_error / b.std_error for a, b in zip(result, crude, strict=True)]
        assert max(ratio) < 1.0
        assert np.median(ratio) < 0.75


def test_infinite_responses_fail_as_the_conventions_say() -> None:
    uniform = ot.Uniform(0.0, 1.0)

    def response(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 0.85, np.inf, np.where(x[:, 1] < 0.1, -np.inf, 0.0))

    def partner(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 0.83, np.inf, np.where(x[:, 1] < 0.1, -np.inf, 0.0))

    problem = Problem(
        response, shared={"v": uniform}, individual={"u": uniform}, units=2, low_fidelity=partner
    )
    rows = METHOD.estimate(problem, criteria([0.0], tau=[None, 0.5]), max_evals=4_000, rng=1)
    for row, works in zip(rows, (0.85**2, 0.75**2), strict=True):
        assert abs(row.pf - (1.0 - works)) < 4.0 * row.std_error


def test_it_stops_at_its_target_and_answers_the_same_by_every_way_of_running(
    tmp_path: Path,
) -> None:
    """In small batches, by workers, from a store, asked and told, saved and resumed half-way."""
    method = MultifidelityMonteCarlo(partner_systems=20_000, pilot=40, target_cov=0.05)
    asked, budget, seed = Criterion(1.5), 20_000, 5
    problem = Problem(
        total, shared={"V": normal(0.0, 1.0)}, individual={"U": normal(0.0, 1.0)}, units=2,
        low_fidelity=close, version="1",
    )  # fmt: skip
    whole = method.estimate(problem, asked, max_evals=budget, rng=seed)
    assert whole.n_evals < 15_000
    assert whole[0].status == "converged"
    assert whole[0].std_error < 0.05 * whole[0].pf
    results = []
    with ThreadPoolExecutor(2) as workers:
        for evaluator in (
            Evaluator(batch_rows=777),
            Evaluator(batch_rows=300, executor=workers),
            Evaluator(store=tmp_path / "runs.db"),
            Evaluator(store=tmp_path / "runs.db"),
        ):
            results.append(
                method.estimate(problem, asked, max_evals=budget, rng=seed, evaluator=evaluator)
            )
    assert results[-1].rows[0].n_reused == whole.n_evals
    session = method.start(problem, asked, max_evals=budget, rng=seed)
    for step in range(100):
        if session.done:
            break
        if step == 2:
            session.save(tmp_path / "session")
            session = method.resume(tmp_path / "session", problem, asked)
        x = session.ask()
        session.tell(x, total(x))
    results.append(session.result())
    for other in results:
        assert other[0].pf == whole[0].pf
        assert other[0].std_error == whole[0].std_error
        assert other.n_evals == whole.n_evals
        assert other.details.partner_evals == whole.details.partner_evals


def test_when_the_time_is_over_the_complete_rounds_answer() -> None:
    problem, evaluator = pair(total, close), Evaluator()
    task = Task(problem, (Criterion(FAR),), 1, evaluator.open(problem, 2_000), evaluator)
    steps = METHOD._steps(task)
    x = next(steps)
    for _ in range(3):  # the pilot and two rounds
        x = steps.send(total(x))
    with pytest.raises(StopIteration) as ended:
        steps.throw(TimeLimitError("the time is over"))
    [answer] = ended.value.value.estimates
    details = ended.value.value.details
    assert details.systems < 1_940
    assert details.partner_systems < 4_000
    assert answer.status in {"budget_exhausted", "doubtful"}
    assert answer.message.startswith(f"{details.systems} of 1940 systems; the time is over")
    assert abs(answer.pf - PLAIN) < 4.0 * answer.std_error


def test_chosen_systems_estimate_any_sum_without_bias() -> None:
    """Priority sampling: sums weighted by the reciprocal chances, over 200 draws."""
    problem = pair(total, close)
    evaluator = Evaluator()
    found = []
    for seed in range(200):
        session = evaluator.open(problem, None)
        partner = Partner(Task(problem, (Criterion(FAR),), seed, session, evaluator))
        chosen = partner.chosen(300, 20, lambda margins: np.exp(0.5 * margins[0]))
        assert chosen.chance.size == 20
        found.append(float((1.0 / chosen.chance).sum()))
    error = np.std(found) / math.sqrt(len(found))
    assert error < 10.0
    assert abs(np.mean(found) - 300.0) < 4.0 * error


def test_inclusion_keeps_the_sum() -> None:
    sizes = np.array([100.0, 5.0, 1.0, 1.0, 1.0, 2.0])
    chance = inclusion(sizes, 3.0)
    assert chance.sum() == pytest.approx(3.0)
    assert chance[0] == 1.0
    assert chance[1] / chance[2] == pytest.approx(5.0)
    assert inclusion(sizes, 9.0).tolist() == [1.0] * 6


def test_weighted_count_is_exact_for_equal_weights() -> None:
    """Garwood's interval of a Poisson count, and the rule of three where nothing was seen."""
    low, high = weighted_count(0.5, 0.05, 0.1)
    assert low == pytest.approx(0.05 * chi2.ppf(0.025, 10))
    assert high == pytest.approx(0.05 * chi2.ppf(0.975, 12))
    assert weighted_count(0.0, 0.0, 0.1) == (0.0, pytest.approx(-0.1 * math.log(0.025)))
    assert weighted_count(0.3, 0.0, 0.0) == (0.3, 0.3)
