"""OpenTURNS' simulation against exact answers, and what it must not do to budget and generator."""

import math
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.special import log_ndtr, ndtr

import uqfold
from uqfold import Binomial, Criterion, criteria
from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.inputs import normal
from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo
from uqfold.testing.counting import RowCount
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem(units=3, shared_std=0.5)


class Counted:
    """Count the rows that a model sees."""

    def __init__(self, model=SYSTEM.response) -> None:
        self.model, self.count = model, RowCount()

    @property
    def rows(self) -> int:
        return self.count.rows

    def __call__(self, x: FloatArray) -> FloatArray:
        self.count.add(x)
        return self.model(x)


def problem_of(model) -> uqfold.Problem:
    one = normal(0.0, 1.0)
    return uqfold.Problem(model, shared={"V": one}, individual={"U": one, "W": one}, units=3)


class TestAccuracy:
    @pytest.mark.parametrize("missions", [1, 3, Binomial(4, 0.6)])
    @pytest.mark.parametrize(("threshold", "tau"), [(10.5, None), (12.0, None), (12.0, 2.0)])
    def test_exact_within_standard_errors(
        self, threshold: float, tau: float | None, missions: int | Binomial
    ) -> None:
        criterion = Criterion(threshold, tau, missions)
        row = OpenTURNSMonteCarlo(target_cov=0.03, max_samples=40_000).estimate(
            SYSTEM.problem(), criterion, rng=1
        )[0]
        exact = SYSTEM.pf(criterion)
        assert row.status == "converged"
        assert row.error_kind == "sampling"
        assert row.std_error / row.pf <= 0.031
        assert abs(row.pf - exact) < 4 * row.std_error
        # the check can fail: a system that mostly stays at home is far outside
        other = SYSTEM.pf(Criterion(threshold, tau, Binomial(1, 0.3)))
        assert abs(row.pf - other) > 4 * row.std_error

    @pytest.mark.thorough
    def test_stated_errors_are_calibrated(self) -> None:
        criterion = Criterion(11.5, missions=Binomial(3, 0.5))
        method = OpenTURNSMonteCarlo(target_cov=0.15)
        exact = SYSTEM.pf(criterion)
        rows = [method.estimate(SYSTEM.problem(), criterion, rng=seed)[0] for seed in range(150)]
        z = np.array([(row.pf - exact) / row.std_error for row in rows])
        assert abs(z.mean()) < 4 / math.sqrt(len(z))
        assert abs(z.std(ddof=1) - 1.0) < 4 / math.sqrt(2 * len(z))

    def test_limit_state_boundary_fails(self) -> None:
        # g takes the value 0 with probability 1/2, and 0 fails
        problem = uqfold.Problem.from_limit_state(
            lambda x: np.where(x[:, 0] > 0, 0.0, 1.0), {"a": normal(0, 1)}
        )
        row = OpenTURNSMonteCarlo().estimate(problem, rng=2)[0]
        assert abs(row.pf - 0.5) < 4 * row.std_error

    def test_infinite_responses_fail_and_are_no_failed_runs(self) -> None:
        def never(x: FloatArray) -> FloatArray:
            return np.where(x[:, 1] > 1.0, np.inf, SYSTEM.response(x))

        asked = criteria([1e5, math.inf], tau=[None, 1e5])
        result = OpenTURNSMonteCarlo().estimate(problem_of(never), asked, rng=3)
        exact = -math.expm1(3 * log_ndtr(1.0))
        assert result.n_failed == 0
        for row in result:
            assert abs(row.pf - exact) < 4 * row.std_error


class TestStopping:
    def test_target_is_reached_and_no_more(self) -> None:
        method = OpenTURNSMonteCarlo(target_cov=0.1, block_size=50)
        result = method.estimate(SYSTEM.problem(), criteria(11.5), rng=4)
        run = result.details.runs[0]
        assert result[0].status == "converged"
        assert run.block_size == 50
        assert run.n_samples % 50 == 0
        # one block earlier the target was not reached (pf near 0.2 needs some 400 samples)
        assert 200 <= run.n_samples <= 800
        assert run.failures / run.n_samples == result.pf[0]

    def test_samples_run_out(self) -> None:
        method = OpenTURNSMonteCarlo(target_cov=0.01, max_samples=999)
        result = method.estimate(SYSTEM.problem(), criteria(11.5), rng=5)
        row, run = result[0], result.details.runs[0]
        assert (row.status, row.message) == ("doubtful", "the stated error is above 1% of pf")
        assert 990 <= run.n_samples <= 999
        assert (row.ci_low, row.ci_high) == clopper_pearson(run.failures, run.n_samples)

    def test_no_failure_is_a_bound(self) -> None:
        row = OpenTURNSMonteCarlo(max_samples=1000).estimate(
            SYSTEM.problem(), criteria(20.0), rng=6
        )[0]
        assert (row.pf, row.status, row.ci_low) == (0.0, "doubtful", 0.0)
        assert row.ci_high == pytest.approx(1.0 - 0.05 ** (1 / 1000))
        assert "one-sided" in row.ci_kind
        assert math.isnan(row.std_error)
        assert "no failures among 1000" in row.message

    def test_nothing_but_failures_is_a_bound(self) -> None:
        # OpenTURNS has no coefficient of variation to stop at, so that all samples are spent
        method = OpenTURNSMonteCarlo(max_samples=600)
        row = method.estimate(SYSTEM.problem(), criteria(0.0), rng=7)[0]
        assert (row.pf, row.reliability, row.status, row.ci_high) == (1.0, 0.0, "doubtful", 1.0)
        assert row.ci_low == pytest.approx(0.05 ** (1 / 600))

    def test_no_mission_at_all(self) -> None:
        asked = criteria(11.0, missions=Binomial(3, 0.0))
        for budget in (None, 100):
            model = Counted()
            row = OpenTURNSMonteCarlo().estimate(problem_of(model), asked, rng=8, max_evals=budget)[
                0
            ]
            assert model.rows == 0
            assert (row.pf, row.status) == (0.0, "doubtful")


class TestBudget:
    asked = criteria([9.5, 12.0, 16.0], tau=[None, 2.0], missions=[2, Binomial(3, 0.6)])

    @pytest.mark.parametrize("budget", [1, 5, 30, 100, 101, 997, 5000, 20_000])
    def test_never_exceeded(self, budget: int) -> None:
        model = Counted()
        result = OpenTURNSMonteCarlo().estimate(
            problem_of(model), self.asked, max_evals=budget, rng=9
        )
        assert result.n_evals == model.rows <= budget
        assert sum(run.n_samples > 0 for run in result.details.runs) == sum(
            row.status != "failed" for row in result
        )

    def test_a_block_that_does_not_fit_is_shortened(self) -> None:
        # 3 units in 2 missions: 100 runs pay for 16 systems
        result = OpenTURNSMonteCarlo().estimate(
            SYSTEM.problem(), Criterion(12.0, missions=2), max_evals=100, rng=10
        )
        assert result.details.runs[0].n_samples == 16
        assert result.n_evals == 96

    def test_random_missions_use_most_of_the_budget(self) -> None:
        method = OpenTURNSMonteCarlo(target_cov=1e-3)
        result = method.estimate(
            SYSTEM.problem(), Criterion(12.0, missions=Binomial(10, 0.3)), max_evals=30_000, rng=11
        )
        assert 0.85 * 30_000 < result.n_evals <= 30_000
        # many more systems than the worst case would allow
        assert result.details.runs[0].n_samples > 2 * 30_000 // 30

    def test_what_an_easy_criterion_leaves_goes_to_the_others(self) -> None:
        result = OpenTURNSMonteCarlo().estimate(
            SYSTEM.problem(), criteria([10.0, 14.0]), max_evals=10_000, rng=12
        )
        easy, hard = result.rows
        assert easy.status == "converged"
        assert easy.n_evals_row < 1000
        assert hard.n_evals_row > 8500
        assert easy.n_evals_row + hard.n_evals_row == result.n_evals

    def test_too_small_a_share_is_a_status(self) -> None:
        row = OpenTURNSMonteCarlo().estimate(
            SYSTEM.problem(), Criterion(12.0, missions=4), max_evals=11, rng=13
        )[0]
        assert row.status == "failed"
        assert "12 runs" in row.message


class TestSeeds:
    asked = criteria([10.5, 11.5], tau=[None, 2.0], missions=[1, Binomial(2, 0.5)])

    def test_same_seed_same_answer_other_seed_another(self) -> None:
        first, again, other = (
            OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), self.asked, rng=seed).pf
            for seed in (1, 1, 2)
        )
        assert np.array_equal(first, again)
        assert not np.array_equal(first, other)

    def test_answer_does_not_depend_on_the_other_criteria(self) -> None:
        together = OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), self.asked, rng=3)
        for criterion, row in zip(self.asked, together, strict=True):
            alone = OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), criterion, rng=3)[0]
            assert (alone.pf, alone.std_error) == (row.pf, row.std_error)

    def test_large_seeds_differ(self) -> None:
        # OpenTURNS itself keeps only 32 bits of a seed
        pf = [
            OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), criteria(11.5), rng=seed).pf[0]
            for seed in (5, 5 + 2**32, 5 + 2**40)
        ]
        assert len(set(pf)) == 3

    def test_global_generator_is_restored(self) -> None:
        import openturns as ot

        ot.RandomGenerator.SetSeed(99)
        expected = ot.RandomGenerator.Generate(4)
        ot.RandomGenerator.SetSeed(99)
        OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), self.asked, rng=4)
        assert list(ot.RandomGenerator.Generate(4)) == list(expected)

    def test_a_model_that_seeds_the_generator_disturbs_nothing(self) -> None:
        """A model that reseeds OpenTURNS' generator made all blocks the same: a false error."""
        import openturns as ot

        def seeding(x: FloatArray) -> FloatArray:
            ot.RandomGenerator.SetSeed(3)
            return SYSTEM.response(x)

        plain, disturbed = (
            OpenTURNSMonteCarlo().estimate(problem_of(model), self.asked, rng=1).pf
            for model in (SYSTEM.response, seeding)
        )
        assert np.array_equal(plain, disturbed)

    def test_estimates_in_several_threads_share_no_stream(self) -> None:
        """Estimates at once started each other's stream anew: samples counted twice."""

        def waiting(x: FloatArray) -> FloatArray:
            time.sleep(1e-4)  # lets other threads go on
            return SYSTEM.response(x)

        def estimated(threshold: float) -> float:
            method = OpenTURNSMonteCarlo(block_size=50)
            return float(method.estimate(problem_of(waiting), criteria(threshold), rng=1).pf[0])

        thresholds = [11.0, 11.3, 11.6]
        with ThreadPoolExecutor(3) as threads:
            together = list(threads.map(estimated, thresholds))
        assert together == [estimated(threshold) for threshold in thresholds]

    def test_global_generator_is_restored_after_an_exception(self) -> None:
        import openturns as ot

        def broken(x: FloatArray) -> FloatArray:
            raise KeyboardInterrupt

        ot.RandomGenerator.SetSeed(99)
        expected = ot.RandomGenerator.Generate(4)
        ot.RandomGenerator.SetSeed(99)
        with pytest.raises(KeyboardInterrupt):
            OpenTURNSMonteCarlo().estimate(problem_of(broken), self.asked, rng=4)
        assert list(ot.RandomGenerator.Generate(4)) == list(expected)


class TestFailedRuns:
    def lost(self, x: FloatArray) -> FloatArray:
        """Fail where the second individual input is above 1.2."""
        return np.where(x[:, 2] > 1.2, np.nan, SYSTEM.response(x))

    @pytest.mark.parametrize("tau", [None, 2.0])
    @pytest.mark.parametrize("missions", [1, Binomial(3, 0.5)])
    def test_pf_is_bounded(self, tau: float | None, missions: int | Binomial) -> None:
        criterion = Criterion(11.0, tau, missions)
        method = OpenTURNSMonteCarlo(target_cov=0.02)
        result = method.estimate(problem_of(self.lost), criterion, rng=5)
        row, run = result[0], result.details.runs[0]
        assert result.n_failed > 0
        assert run.open_samples > 0
        assert row.status == "doubtful"
        exact = SYSTEM.pf(criterion)
        slack = 4 * math.sqrt(0.25 / run.n_samples)
        assert row.pf_low - slack < exact < row.pf_high + slack
        assert row.pf == row.pf_high > row.pf_low
        assert row.ci_low <= row.pf_low
        assert row.pf_high <= row.ci_high

    def test_bounds_are_those_of_the_open_samples(self) -> None:
        # without tau: low counts the units that answered, high also those that did not
        criterion = Criterion(11.0)
        method = OpenTURNSMonteCarlo(target_cov=0.01, max_samples=20_000)
        row = method.estimate(problem_of(self.lost), criterion, rng=6)[0]
        v = np.linspace(-8, 8, 4001)
        density = np.exp(-0.5 * v**2) / math.sqrt(2 * math.pi) * (v[1] - v[0])
        w = np.linspace(-8, 1.2, 4001)
        weight = np.exp(-0.5 * w**2) / math.sqrt(2 * math.pi) * (w[1] - w[0])
        weight[[0, -1]] /= 2
        top = (11.0 - 10.0 - 0.5 * v[:, None] - 0.8 * w) / 0.6
        answered_and_works = ndtr(top) @ weight
        lost = ndtr(-1.2)
        for got, unit_works in (
            (row.pf_low, answered_and_works + lost),
            (row.pf_high, answered_and_works),
        ):
            expected = float(density @ (1.0 - unit_works**3))
            assert abs(got - expected) < 4 * math.sqrt(expected * (1 - expected) / 20_000)

    def test_policy_raise_comes_through_openturns(self) -> None:
        with pytest.raises(FailedRunError, match="returned NaN"):
            OpenTURNSMonteCarlo().estimate(
                problem_of(self.lost), criteria(11.0), rng=7, evaluator=Evaluator("raise")
            )

    def test_model_that_always_raises_is_a_status(self) -> None:
        def broken(x: FloatArray) -> FloatArray:
            raise ZeroDivisionError("no wing")

        for row in OpenTURNSMonteCarlo().estimate(
            problem_of(broken), criteria([11.0, 12.0]), rng=8
        ):
            assert row.status == "failed"
            assert "no wing" in row.message


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"target_cov": 0.0}, "target_cov = 0.0"),
        ({"target_cov": math.inf}, "target_cov = inf"),
        ({"block_size": 0}, "block_size = 0"),
        ({"max_samples": 0}, "max_samples = 0"),
    ],
)
def test_settings_are_checked(settings: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        OpenTURNSMonteCarlo(**settings)


def test_many_dimensions() -> None:
    # 40 missions of 3 units with 2 inputs each and a shared one: 241 variables
    criterion = Criterion(13.5, missions=40)
    row = OpenTURNSMonteCarlo().estimate(SYSTEM.problem(), criterion, rng=10)[0]
    assert abs(row.pf - SYSTEM.pf(criterion)) < 4 * row.std_error
