"""Conditional Monte Carlo: against exact systems, and what its rows say."""

import math
from dataclasses import replace

import numpy as np
import pytest

from uqfold import Problem, criteria
from uqfold.inputs import normal
from uqfold.methods import ConditionalMonteCarlo, MonteCarlo
from uqfold.methods.conditional_sums import BLOCK_DRAWS
from uqfold.problems import series
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import Model

SYSTEM = LinearNormalSystem(units=4, shared_std=0.8)
GRID = criteria([11.0, 12.5], tau=[None, 2.5], missions=[1, 2, 5, Binomial(5, 0.6)])


def test_answers_are_those_of_the_exact_system() -> None:
    """All 16 criteria over 40 seeds: mean z-score and spread as the stated errors promise."""
    exact = np.array([SYSTEM.pf(criterion) for criterion in GRID])
    problem = SYSTEM.problem()
    rows = [
        ConditionalMonteCarlo(blocks=30).estimate(problem, GRID, rng=seed) for seed in range(40)
    ]
    pf = np.array([result.pf for result in rows])
    stated = np.array([[row.std_error for row in result] for result in rows])
    error = pf.std(axis=0, ddof=1)
    # five standard errors of a mean over 40, and of a spread over 40
    assert np.all(np.abs(pf.mean(axis=0) - exact) < 5.0 * error / math.sqrt(40))
    ratio = error / np.sqrt((stated**2).mean(axis=0))
    assert np.all(np.abs(ratio - 1.0) < 5.0 / math.sqrt(2 * 39))


def with_partner(partner: Model | None, model: Model = SYSTEM.response) -> Problem:
    individual = {"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)}
    return Problem(
        model, shared={"V": normal(0.0, 1.0)}, individual=individual, units=4, low_fidelity=partner
    )


def test_a_partner_divides_the_variance_and_leaves_no_bias() -> None:
    """The partner as control variate: mean, stated error and gain over 12 seeds; failed runs."""
    asked = criteria([11.0, 12.0])
    exact = np.array([SYSTEM.pf(criterion) for criterion in asked])
    plain = ConditionalMonteCarlo(blocks=20, missions_per_draw=1)
    method = replace(plain, partner_blocks=4)
    results = [method.estimate(SYSTEM.problem(), asked, rng=seed) for seed in range(12)]
    pf = np.array([result.pf for result in results])
    stated = np.array([[row.std_error for row in result] for result in results])
    error = np.sqrt((stated**2).mean(axis=0))
    assert np.all(np.abs(pf.mean(axis=0) - exact) < 4.0 * error / math.sqrt(12))
    assert np.all(pf.std(axis=0, ddof=1) < (1.0 + 4.0 / math.sqrt(24)) * error)
    alone = [plain.estimate(SYSTEM.problem(), asked, rng=seed) for seed in range(4)]
    assert error.mean() < 0.8 * np.mean([[row.std_error for row in result] for result in alone])
    assert np.nanmedian([result.details.gain for result in results]) > 1.8
    assert results[0].details.partner_evals == 5 * results[0].n_evals
    # a failed run is a failure in pf, and a safe one in pf_low
    problem = with_partner(
        SYSTEM.partner, lambda x: np.where(x[:, 1] > 2.0, np.nan, SYSTEM.response(x))
    )
    row = method.estimate(problem, asked[0], rng=1)[0]
    assert 0.0 < row.pf_low < row.pf == row.pf_high


@pytest.mark.parametrize(
    ("partner", "blocks", "message", "share"),
    [
        (lambda x: 10.0 + np.sin(1e3 * x[:, 1]), 12, "the partner is of no use", 1),
        (lambda x: np.full(len(x), np.nan), 12, "the partner failed", 1),
        (SYSTEM.partner, 9, "9 blocks are too few to ask the partner", 0),
    ],
    ids=["of no use", "broken", "few blocks"],
)
def test_a_partner_of_no_use_costs_its_runs_on_the_blocks_of_the_model_and_says_so(
    partner: Model, blocks: int, message: str, share: int
) -> None:
    """The answer is then that without a partner."""
    plain = ConditionalMonteCarlo(blocks=blocks, missions_per_draw=1)
    problem, method = with_partner(partner), replace(plain, partner_blocks=5)
    alone, result = (one.estimate(problem, Criterion(11.0), rng=1) for one in (plain, method))
    assert message in result[0].message
    for name in ("pf", "std_error", "ci_low", "ci_high", "status"):
        assert getattr(result[0], name) == getattr(alone[0], name)
    assert result.details.partner_evals <= share * result.n_evals
    assert np.isnan(result.details.gain).all()


def test_a_partner_that_is_not_there_is_unsupported() -> None:
    method = ConditionalMonteCarlo(partner_blocks=5)
    result = method.estimate(with_partner(None), Criterion(11.0), rng=1)
    assert (result[0].status, result.n_evals) == ("unsupported", 0)
    assert "partner_blocks = 5 needs a cheaper partner" in result[0].message


def test_a_partner_seen_wrong_too_rarely_is_doubted() -> None:
    """Right in all draws but a few, it leaves a small error that nobody has seen the whole of."""
    problem = with_partner(lambda x: SYSTEM.response(x) + np.where(x[:, 0] > 2.5, 3.0, 0.0))
    method = ConditionalMonteCarlo(blocks=24, missions_per_draw=1, partner_blocks=2)
    rows = [method.estimate(problem, Criterion(11.0), rng=seed)[0] for seed in range(5)]
    assert {row.status for row in rows} == {"doubtful"}
    assert all("model and partner differ in" in row.message for row in rows)


def test_shared_inputs_drawn_anew_would_be_seen() -> None:
    """The check above can fail: the independent system lies many standard errors away."""
    criterion = Criterion(11.0, missions=5)
    row = ConditionalMonteCarlo(blocks=60).estimate(SYSTEM.problem(), criterion, rng=1)[0]
    total = math.hypot(SYSTEM.shared_std, SYSTEM.individual_std)
    independent = LinearNormalSystem(units=4, shared_std=1e-9, individual_std=total)
    assert abs(row.pf - SYSTEM.pf(criterion)) < 4.0 * row.std_error
    assert abs(row.pf - independent.pf(criterion)) > 8.0 * row.std_error


def test_it_errs_less_than_crude_monte_carlo_at_the_same_cost() -> None:
    problem, asked = SYSTEM.problem(), criteria(12.0, missions=[1, 2])
    conditional = ConditionalMonteCarlo(missions_per_draw=5)
    for i in range(2):
        ours, crude = (
            method.estimate(problem, asked, max_evals=32_000, rng=2)[i]
            for method in (conditional, MonteCarlo())
        )
        assert ours.n_evals <= crude.n_evals
        assert ours.std_error < 0.8 * crude.std_error


def test_example_1_agrees_with_its_exact_reference() -> None:
    problem = series()
    asked = criteria([0.0, 2.0], tau=[None, 16.0], missions=[1, 2])
    method = ConditionalMonteCarlo(blocks=100, target_cov=0.2)
    result = method.estimate(problem, asked, rng=3)
    assert problem.references is not None
    for row, criterion in zip(result, asked, strict=True):
        known = problem.references.lookup(criterion)
        assert known is not None
        assert abs(row.pf - known.pf) < 4.0 * row.std_error
        assert row.status == "converged"


def test_cost_and_details_follow_from_the_settings() -> None:
    asked = criteria(12.0, missions=[1, 6])
    result = ConditionalMonteCarlo(blocks=3).estimate(SYSTEM.problem(), asked, rng=1)
    assert result.details.blocks == 3
    assert result.details.missions_per_draw == 6
    assert result.n_evals == 3 * BLOCK_DRAWS * 6 * 4
    assert (
        ConditionalMonteCarlo().estimate(SYSTEM.problem(), asked[0], max_evals=600).n_evals == 512
    )


def test_it_stops_at_the_target_wherever_the_budget_ends() -> None:
    """Every row meets it, no later for a larger budget; without a target all is run."""
    asked, problem = criteria([11.0, 12.5], tau=[None, 2.5]), SYSTEM.problem()
    exact = np.array([SYSTEM.pf(criterion) for criterion in asked])
    method, answers = ConditionalMonteCarlo(target_cov=0.1), []
    for seed in range(20):
        result = method.estimate(problem, asked, rng=seed)
        assert {row.status for row in result} == {"converged"}
        assert all(row.std_error < 0.1 * row.pf for row in result)
        answers.append(result)
    pf = np.array([result.pf for result in answers])
    stated = np.array([[row.std_error for row in result] for result in answers])
    assert np.all(np.abs((pf - exact).mean(axis=0)) < 5.0 * stated.mean(axis=0) / math.sqrt(20))
    assert len({result.n_evals for result in answers}) > 1
    first = answers[0]
    for budget, settings in ((first.n_evals, {}), (10 * first.n_evals, {"blocks": 777})):
        again = replace(method, **settings).estimate(problem, asked, max_evals=budget, rng=0)
        assert again.rows == tuple(
            replace(row, seconds=other.seconds) for row, other in zip(first, again, strict=True)
        )
    everything = replace(method, target_cov=None).estimate(
        problem, asked, max_evals=2 * first.n_evals, rng=0
    )
    assert everything.details.blocks == 2 * first.details.blocks


def test_with_a_partner_it_stops_sooner() -> None:
    method = ConditionalMonteCarlo(missions_per_draw=1, target_cov=0.05)
    asked, problem = Criterion(11.5), SYSTEM.problem()
    alone = method.estimate(problem, asked, rng=1)
    helped = replace(method, partner_blocks=4).estimate(problem, asked, rng=1)
    assert helped.n_evals < alone.n_evals
    assert helped[0].status == "converged"
    assert helped[0].std_error < 0.05 * helped[0].pf
    assert helped.details.partner_evals < 2 * 5 * helped.n_evals


def test_a_budget_below_what_was_asked_for_is_said() -> None:
    row = ConditionalMonteCarlo(blocks=50).estimate(
        SYSTEM.problem(), criteria(11.0), max_evals=3_000, rng=1
    )[0]
    assert (row.status, row.message) == ("budget_exhausted", "11 of 50 blocks")


def test_too_small_a_budget_is_refused_before_any_run() -> None:
    result = ConditionalMonteCarlo().estimate(
        SYSTEM.problem(), criteria(11.0), max_evals=511, rng=1
    )
    assert result[0].status == "failed"
    assert "cost 512 runs, max_evals = 511" in result[0].message
    assert result.n_evals == 0


def test_few_and_no_failures_are_doubtful() -> None:
    few, none = ConditionalMonteCarlo(blocks=20).estimate(
        SYSTEM.problem(), criteria([14.0, 30.0]), rng=5
    )
    assert few.status == "doubtful"
    assert f"of {20 * BLOCK_DRAWS} shared draws" in few.message
    assert (none.pf, none.ci_low, none.status) == (0.0, 0.0, "doubtful")
    # the bound for as many systems as there are shared draws
    assert none.ci_high == pytest.approx(1.0 - 0.05 ** (1.0 / (20 * BLOCK_DRAWS)))
    assert math.isnan(none.std_error)


def test_a_reliability_that_rests_on_a_few_draws_is_doubtful() -> None:
    """Where the shared input decides nearly alone, errors of rare success are understated."""
    system = LinearNormalSystem(units=4, shared_std=2.0)
    asked = criteria([5.5, 11.0])
    results = [
        ConditionalMonteCarlo(blocks=6).estimate(system.problem(), asked, rng=seed)
        for seed in range(20)
    ]
    exact = system.pf(asked[0])
    assert max(abs(rare.pf - exact) / rare.std_error for rare, _ in results) > 100.0
    assert {rare.status for rare, _ in results} == {"doubtful"}
    assert all("the reliability rests on about" in rare.message for rare, _ in results)
    assert {(common.status, common.message) for _, common in results} == {("converged", "")}


@pytest.mark.parametrize("missions", [Binomial(3, 0.95), Binomial(6, 0.3)])
def test_a_binomial_number_of_missions_hides_no_rare_draws(missions: Binomial) -> None:
    """Near the floor that unflown missions leave, a few shared draws carry the rest.

    Old answers there were converged, and up to thousands of stated errors off.
    """
    system = LinearNormalSystem(units=4, shared_std=1.5)
    floor = (1.0 - missions.p) ** missions.planned
    asked = criteria([5.5, 6.4, 11.8], missions=missions)
    exact = np.array([system.pf(criterion) for criterion in asked])
    assert np.all(1.0 - exact[:2] < 6.0 * floor)
    method, problem = ConditionalMonteCarlo(blocks=16), system.problem()
    rows = [method.estimate(problem, asked, rng=seed).rows for seed in range(30)]
    sure = np.array([[row.status == "converged" for row in run] for run in rows])
    covers = np.array(
        [[row.ci_low <= pf <= row.ci_high for row, pf in zip(run, exact, strict=True)]
         for run in rows]
    )  # fmt: skip
    assert sure[:, :2].mean() < 0.05
    assert sure[:, 2].all()
    # 95 % of 30 cover, less four standard deviations
    assert np.all(covers.mean(axis=0) > 0.79)
    assert any("the reliability rests on about" in row.message for run in rows for row in run[:2])


def test_draws_that_all_agree_leave_a_bound_that_holds() -> None:
    """Where every draw fails whatever is flown, pf is what the number of missions says."""
    system, missions = LinearNormalSystem(units=4, shared_std=0.5), Binomial(6, 0.3)
    row = ConditionalMonteCarlo(blocks=8).estimate(
        system.problem(), criteria(6.0, missions=missions), rng=1
    )[0]
    assert row.pf == pytest.approx(1.0 - 0.7**6, rel=1e-15)
    assert (row.status, row.message) == ("doubtful", "only failures in 128 shared draws")
    assert row.ci_low < system.pf(criteria(6.0, missions=missions)[0]) < row.pf
    assert row.ci_high == row.pf
    assert math.isnan(row.std_error)


def test_problem_without_shared_inputs() -> None:
    def first(x: np.ndarray) -> np.ndarray:
        return x[:, 0]

    problem = Problem(first, individual={"a": normal(0.0, 1.0)}, units=2)
    row = ConditionalMonteCarlo(blocks=60).estimate(problem, criteria(1.5, missions=2), rng=1)[0]
    exact = 1.0 - 0.9331927987311419**4
    assert abs(row.pf - exact) < 4.0 * row.std_error


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"blocks": 1}, "blocks = 1: give a whole number >= 2, or None"),
        ({"blocks": 2.5}, "blocks = 2.5"),
        ({"missions_per_draw": 0}, "missions_per_draw = 0: give a whole number >= 1"),
        ({"target_cov": 0.0}, "target_cov = 0"),
    ],
)
def test_bad_settings_are_refused(settings: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ConditionalMonteCarlo(**settings)
