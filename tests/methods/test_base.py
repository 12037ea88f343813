"""What the base owns: arguments, seeds, statuses, the promises of every row."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from uqfold.comparison import run_comparison
from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.methods import (
    ConditionalMonteCarlo,
    Estimate,
    MonteCarlo,
    OpenTURNSMonteCarlo,
    ReliabilityMethod,
    Solution,
    Task,
    available,
    build,
)
from uqfold.methods.result import Status, reliability_index
from uqfold.methods.seeding import block_generator, reduced_seed
from uqfold.methods.task import attempt
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion, criteria
from uqfold.problems.structure import Parallel
from uqfold.testing import LinearNormalSystem

SYSTEM = LinearNormalSystem()


A_QUARTER = Estimate(0.25)


@dataclass(frozen=True)
class Scripted(ReliabilityMethod):
    """Runs the model once and answers what it is told."""

    name: ClassVar[str] = "scripted"
    answer: Estimate = A_QUARTER
    runs: int = 1

    def _solve(self, task: Task) -> Solution:
        task.session.evaluate(np.tile(np.arange(float(self.runs))[:, None], 3))
        return Solution([self.answer] * len(task.criteria), details="found")


@dataclass(frozen=True)
class Breaks(ReliabilityMethod):
    name: ClassVar[str] = "breaks"

    def _solve(self, task: Task) -> Solution:
        raise ArithmeticError("no root")


@dataclass(frozen=True)
class TooFew(ReliabilityMethod):
    name: ClassVar[str] = "too-few"

    def _solve(self, task: Task) -> Solution:
        return Solution([])


@dataclass(frozen=True)
class FirstOrderSecondMoment(ReliabilityMethod):
    def _solve(self, task: Task) -> Solution:
        return Solution([A_QUARTER for _ in task.criteria])


def test_a_method_is_named_after_its_class_unless_it_says_otherwise() -> None:
    result = FirstOrderSecondMoment().estimate(SYSTEM.problem(), 1.0, rng=1)
    assert result.method == FirstOrderSecondMoment.name == "first-order-second-moment"
    assert Scripted.name == "scripted"


def test_row_carries_cost_and_identity() -> None:
    result = Scripted(runs=7).estimate(SYSTEM.problem(), criteria([1.0, 2.0]), rng=12)
    assert result.details == "found"
    assert [row.threshold for row in result] == [1.0, 2.0]
    assert all(row.n_evals == row.n_evals_row == 7 for row in result)
    assert (result.method, result.seed, result.n_failed) == ("scripted", 12, 0)
    assert result[0].reliability == 0.75
    assert result.seconds > 0.0
    frame = result.to_frame()
    assert list(frame["pf"]) == [0.25, 0.25]
    assert math.isnan(frame["tau"][0])


@pytest.mark.parametrize(
    ("stated", "status"),
    [
        ({}, "unchecked"),
        ({"std_error": math.inf}, "unchecked"),
        ({"ci_low": 0.2}, "unchecked"),
        ({"std_error": 0.01}, "converged"),
        ({"ci_low": 0.23, "ci_high": 0.27}, "converged"),
    ],
)
def test_converged_without_an_error_becomes_unchecked(
    stated: dict[str, float], status: str
) -> None:
    """A clean status without an error bar misleads: nobody can claim it, plug-ins included."""
    claimed = Estimate(0.25, status="converged", **stated)
    row = Scripted(answer=claimed).estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert (row.status, row.pf) == (status, 0.25)


@pytest.mark.parametrize("claimed", ["converged", "budget_exhausted"])
@pytest.mark.parametrize(
    ("pf", "stated"),
    [
        (0.25, {"std_error": 0.026}),
        (0.25, {"ci_low": 0.19, "ci_high": 0.31}),
        (0.0, {"ci_low": 0.0, "ci_high": 1e-9}),
        (0.0, {"std_error": 0.0, "ci_low": 0.0, "ci_high": 1e-9}),
    ],
)
def test_an_error_above_a_tenth_of_pf_is_doubtful(
    claimed: Status, pf: float, stated: dict[str, float]
) -> None:
    """`converged` requires a stated relative error of at most 10 %, whatever the method says."""
    answer = Estimate(pf, status=claimed, **stated)
    row = Scripted(answer=answer).estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert (row.status, row.message) == ("doubtful", "the stated error is above 10% of pf")


@pytest.mark.parametrize(
    ("method", "budget"),
    [
        (MonteCarlo(target_cov=0.3), 300),
        (ConditionalMonteCarlo(target_cov=0.3), 1500),
        (OpenTURNSMonteCarlo(target_cov=0.3), 1200),
    ],
)
def test_the_largest_error_of_a_converged_row_is_a_setting(
    method: ReliabilityMethod, budget: int
) -> None:
    """`target_cov` in every method that estimates an error; it does not change the answer."""
    for target, status in ((0.3, "converged"), (0.02, "doubtful")):
        one = replace(method, target_cov=target)  # type: ignore[call-arg]
        row = one.estimate(SYSTEM.problem(), criteria(11.5), max_evals=budget, rng=2)[0]
        assert (row.status, 0.02 < row.std_error / row.pf < 0.3) == (status, True), one


def test_a_status_of_nobodys_is_no_answer() -> None:
    claimed = Estimate(0.25, status="fine")  # type: ignore[arg-type]
    row = Scripted(answer=claimed).estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert row.status == "failed"
    assert "'fine'" in row.message


def test_exceptions_of_a_method_become_a_status() -> None:
    row = Breaks().estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert row.status == "failed"
    assert row.message == "ArithmeticError: no root"
    assert math.isnan(row.pf)
    short = TooFew().estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert "0 answers to 1 criteria" in short.message


@pytest.mark.parametrize("pf", [-0.1, 1.1, math.nan, math.inf])
def test_what_is_no_probability_is_no_answer(pf: float) -> None:
    row = Scripted(answer=Estimate(pf)).estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert row.status == "failed"
    assert math.isnan(row.pf)


def test_number_beside_no_answer_is_removed() -> None:
    answer = Estimate(0.0, status="unsupported", message="why")
    row = Scripted(answer=answer).estimate(SYSTEM.problem(), criteria(1.0))[0]
    assert math.isnan(row.pf)
    assert math.isnan(row.reliability)
    assert math.isnan(row.beta)


@pytest.mark.parametrize("budget", [0, -1, 2.5])
def test_impossible_budget_is_refused(budget: float) -> None:
    with pytest.raises(ValueError, match="max_evals"):
        Scripted().estimate(SYSTEM.problem(), criteria(1.0), max_evals=budget)  # type: ignore[arg-type]


def test_criteria_are_needed_unless_the_problem_has_its_own() -> None:
    with pytest.raises(ValueError, match="no criteria given"):
        Scripted().estimate(SYSTEM.problem())
    own = Problem.from_limit_state(lambda x: x[:, 0], SYSTEM.problem().inputs.marginals[0])
    assert MonteCarlo(systems=10).estimate(own, rng=1)[0].threshold < 0.0
    single = Scripted().estimate(SYSTEM.problem(), Criterion(3.0))
    assert len(single) == 1
    with pytest.raises(TypeError, match=r"criteria\[0\] = 3.0: give a Criterion"):
        Scripted().estimate(SYSTEM.problem(), [3.0])  # type: ignore[list-item]


@pytest.mark.parametrize("name", list(available()))
def test_tau_needs_a_series(name: str) -> None:
    problem = Problem(
        SYSTEM.response, inputs=SYSTEM.problem().inputs.distribution, shared=["V"], units=3,
        structure=Parallel(),
    )  # fmt: skip
    row = build(name).estimate(problem, criteria(1.0, tau=1.0))[0]
    assert row.status == "unsupported"
    assert row.n_evals == 0


def test_policy_raise_raises_and_others_do_not() -> None:
    problem = Problem(
        lambda x: np.full(len(x), np.nan), individual=SYSTEM.problem().inputs.marginals[0]
    )
    with pytest.raises(FailedRunError, match="NaN"):
        MonteCarlo().estimate(problem, criteria(1.0), rng=1, evaluator=Evaluator("raise"))
    assert MonteCarlo().estimate(problem, criteria(1.0), rng=1)[0].status == "failed"


def test_method_that_cannot_bound_failed_runs_gives_no_number() -> None:
    inputs = SYSTEM.problem().inputs.distribution
    problem = Problem(lambda x: np.where(x[:, 0] == 0.0, np.nan, 1.0), inputs=inputs, shared=["V"])
    row = Scripted(runs=3).estimate(problem, criteria(1.0))[0]
    assert row.status == "failed"
    assert "cannot bound" in row.message
    assert (row.n_evals, row.n_failed) == (3, 1)


def test_attempt_keeps_a_hard_criterion_to_itself() -> None:
    def hard() -> Estimate:
        raise ZeroDivisionError("flat")

    assert attempt(hard).message == "ZeroDivisionError: flat"
    assert attempt(lambda: Estimate(0.5)).pf == 0.5

    def broken_model() -> Estimate:
        raise FailedRunError("all")

    with pytest.raises(FailedRunError):
        attempt(broken_model)


def test_seeds_are_reduced_to_an_integer() -> None:
    assert reduced_seed(5) == 5
    assert reduced_seed(np.int64(5)) == 5
    generator = np.random.default_rng(1)
    assert reduced_seed(generator) != reduced_seed(generator)
    assert reduced_seed(np.random.default_rng(1)) == reduced_seed(np.random.default_rng(1))
    sequence = np.random.SeedSequence(3)
    assert reduced_seed(sequence) == reduced_seed(np.random.SeedSequence(3))
    assert reduced_seed(sequence.spawn(1)[0]) != reduced_seed(sequence)
    assert reduced_seed(None) != reduced_seed(None)
    with pytest.raises(ValueError, match="rng = -"):
        reduced_seed(-1)
    for wrong in ("a", b"1", True, 5j):
        with pytest.raises(TypeError, match=r"^rng = "):
            reduced_seed(wrong)  # type: ignore[arg-type]
    first, second = block_generator(1, 0).random(), block_generator(1, 1).random()
    assert first != second
    assert first == block_generator(1, 0).random()


def test_recorded_seed_repeats_the_run() -> None:
    first = MonteCarlo(systems=500).estimate(SYSTEM.problem(), criteria(11.0))
    again = MonteCarlo(systems=500).estimate(SYSTEM.problem(), criteria(11.0), rng=first.seed)
    assert first.pf == again.pf


@pytest.mark.parametrize(
    ("pf", "reliability", "beta"),
    [(0.5, 0.5, 0.0), (1e-20, 1.0, 9.262340089798408), (1.0, 1e-20, -9.262340089798408)],
)
def test_reliability_index_uses_the_smaller_tail(
    pf: float, reliability: float, beta: float
) -> None:
    assert reliability_index(pf, reliability) == pytest.approx(beta, rel=1e-12)


def test_registry_builds_by_name_and_names_the_choices() -> None:
    assert isinstance(build("mc"), MonteCarlo)
    with pytest.raises(ValueError, match="choose from 'ffni-spa'"):
        build("subset")


def test_progress_is_reported_per_batch() -> None:
    seen: list[tuple[int, int | None]] = []
    evaluator = Evaluator(batch_rows=1000, progress=lambda n, expected: seen.append((n, expected)))
    MonteCarlo(systems=1000).estimate(SYSTEM.problem(), criteria(11.0), rng=1, evaluator=evaluator)
    assert seen == [(1000, 3000), (2000, 3000), (3000, 3000)]


def test_the_former_name_of_active_kriging_is_understood_with_a_warning() -> None:
    """``ak-mcs`` did no crude Monte Carlo: it is ``active-kriging`` now, for one release both."""
    assert "ak-mcs" not in available()
    assert build("active-kriging").name == "active-kriging"
    said = "'ak-mcs' is called 'active-kriging' now"
    with pytest.warns(FutureWarning, match=said) as told:
        assert build("ak-mcs") == build("active-kriging")
    assert told[0].filename == __file__
    with pytest.warns(FutureWarning, match=said) as told:
        run_comparison(SYSTEM.problem(), "ak-mcs", criteria(11.0))
    assert told[0].filename == __file__, "where it is asked for, however deep it is built"


@dataclass(frozen=True)
class OfTheFormerRelease(ReliabilityMethod):
    """Asks its task for what the session has."""

    name: ClassVar[str] = "former"

    def _solve(self, task: Task) -> Solution:
        with pytest.warns(DeprecationWarning, match=r"task.evaluate is task.session.evaluate now"):
            y = task.evaluate(np.ones((4, 3)))  # type: ignore[attr-defined]
        with pytest.warns(DeprecationWarning, match=r"task.session.max_evals now"):
            assert task.max_evals == 9  # type: ignore[attr-defined]
        with pytest.raises(AttributeError, match="no attribute 'evalute'"):
            task.evalute(np.ones((1, 3)))  # type: ignore[attr-defined]
        assert np.isfinite(y).all()
        return Solution([A_QUARTER] * len(task.criteria))


def test_what_a_task_handed_on_is_asked_of_its_session() -> None:
    """A task is no facade; its former names warn for one release."""
    row = OfTheFormerRelease().estimate(SYSTEM.problem(), criteria(1.0), max_evals=9, rng=1)[0]
    assert (row.pf, row.n_evals) == (0.25, 4), row.message
