"""When the wall-clock limit strikes, methods answer with the runs that they have."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from uqfold.evaluation import Evaluator, TimeLimitError
from uqfold.evaluation.batch import Caution, run_batch
from uqfold.methods import (
    ActiveKriging,
    ConditionalMonteCarlo,
    FFNIPearson,
    Kriging,
    MonteCarlo,
    OpenTURNSFORM,
    OpenTURNSMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
)
from uqfold.methods.openturns_search import DesignPointSearch
from uqfold.problems import Problem
from uqfold.problems.criterion import criteria
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.time_limit import check_time, time_checked_by
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem()
ASKED = criteria([11.0, 12.0], missions=[1, 3])


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], dict[str, Any]]:
    """A model that takes one second for each run, by a clock that only it moves."""
    clock = [0.0]
    monkeypatch.setattr(
        "uqfold.evaluation.deadline.time", SimpleNamespace(monotonic=lambda: clock[0])
    )
    plain = SYSTEM.problem()

    def model(x: FloatArray) -> FloatArray:
        clock[0] += len(x)
        return np.asarray(plain.model(x))

    def arguments(seconds: float) -> dict[str, Any]:
        problem = Problem(
            model,
            inputs=plain.inputs.distribution,
            names=plain.inputs.names,
            shared=plain.inputs.shared_names,
            units=plain.n_units,
        )
        evaluator = Evaluator(max_seconds=seconds, batch_rows=1)
        return {"problem": problem, "rng": 1, "evaluator": evaluator}

    return arguments


def test_the_error_holds_the_responses_that_were_made(slow: Callable[..., Any]) -> None:
    given = slow(7.0)
    session = given["evaluator"].open(given["problem"], None)
    x = given["problem"].inputs.sample(np.random.default_rng(0), 10)
    np.testing.assert_array_equal(session.evaluate(x[:3]), SYSTEM.response(x[:3]))
    with pytest.raises(TimeLimitError, match="is over after 7 runs") as caught:
        session.evaluate(x)
    np.testing.assert_array_equal(caught.value.responses, SYSTEM.response(x[:4]))
    with pytest.raises(TimeLimitError) as caught:
        session.evaluate(x)
    assert caught.value.responses.size == 0


@pytest.mark.parametrize(
    ("method", "seconds"),
    [
        (Kriging(runs=60), 40),
        (PolynomialChaos(runs=60), 40),
        (ActiveKriging(), 10),  # in the first design
        (ActiveKriging(), 14),  # in the first step of learning
        (OpenTURNSMonteCarlo(block_size=50, target_cov=0.01), 450),
        (MonteCarlo(), 4000),  # in the first block
        (ConditionalMonteCarlo(), 4000),  # in the first call
    ],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_a_cut_design_is_an_answer(
    slow: Callable[..., Any], method: ReliabilityMethod, seconds: int
) -> None:
    given = slow(seconds)
    asked = ASKED if method.name != "openturns-mc" else criteria(11.0)
    exact = [SYSTEM.pf(criterion) for criterion in asked]
    result = method.estimate(criteria=asked, **given)
    assert result.n_evals == seconds
    for row, pf in zip(result, exact, strict=True):
        assert row.status in {"budget_exhausted", "doubtful"}
        assert f"the wall-clock limit of {seconds} s is over after {seconds} runs" in row.message
        assert row.ci_low <= pf <= row.ci_high
        assert abs(row.pf - pf) < 5 * row.std_error


@pytest.mark.parametrize(
    "method",
    [Kriging(), PolynomialChaos(), ActiveKriging(), PolynomialChaos(design="ffni"), FFNIPearson()],
    ids=lambda method: method.name,
)
def test_too_few_runs_are_none(slow: Callable[..., Any], method: ReliabilityMethod) -> None:
    result = method.estimate(criteria=ASKED, **slow(5.0))
    assert {row.status for row in result} == {"failed"}
    assert (
        "out of budget before an answer: the wall-clock limit of 5 s is over" in result[0].message
    )


@pytest.mark.parametrize(
    ("method", "of", "hook"),
    [
        (OpenTURNSFORM(), DesignPointSearch, "_run"),
        (OpenTURNSMonteCarlo(block_size=10), OpenTURNSMonteCarlo, "_simulate"),
    ],
)
def test_no_criterion_is_begun_after_the_limit(
    slow: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
    method: ReliabilityMethod,
    of: type,
    hook: str,
) -> None:
    """Many criteria do not stretch the limit: OpenTURNS is not started for those that are left."""
    begin, begun = getattr(of, hook), []

    def counted(*words: Any) -> Any:
        begun.append(words)
        return begin(*words)

    monkeypatch.setattr(of, hook, counted)
    asked = criteria(np.linspace(10.2, 13.0, 60).tolist())
    result = method.estimate(criteria=asked, **slow(40.0))
    assert result.n_evals == 40
    assert 1 <= len(begun) <= 3
    assert len({row.status for row in result}) > 1


def test_kriging_fits_one_surface_when_the_time_is_over(
    slow: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time for summing up goes to the answer, not to choosing among four surfaces."""
    fits = []

    def counted(*words: Any, **options: Any) -> Any:
        fits.append(options["trend"])
        return fit_gaussian_process(*words, **options)

    monkeypatch.setattr("uqfold.methods.kriging.fit_gaussian_process", counted)
    row = Kriging().estimate(criteria=criteria(11.0), **slow(40.0))[0]
    assert len(fits) == 1
    assert row.status == "budget_exhausted"
    assert "1 of 4 surfaces fitted; the wall-clock limit of 40 s is over" in row.message
    assert row.ci_low <= SYSTEM.pf(criteria(11.0)[0]) <= row.ci_high


def test_form_names_the_limit_that_cut_its_search(slow: Callable[..., Any]) -> None:
    row = OpenTURNSFORM().estimate(criteria=criteria(11.0), **slow(9.0))[0]
    assert row.status == "budget_exhausted"
    assert "the wall-clock limit of 9 s is over after 9 runs" in row.message


@pytest.mark.parametrize(
    "method",
    [Kriging(runs=20), PolynomialChaos(runs=20), ActiveKriging(runs=20), FFNIPearson(rows=9_000)],
    ids=lambda method: method.name,
)
def test_a_limit_holds_in_every_phase(
    monkeypatch: pytest.MonkeyPatch, method: ReliabilityMethod
) -> None:
    """Every time limit holds in every phase: here each look at the clock takes a second."""
    clock = iter(range(10**9))
    monkeypatch.setattr(
        "uqfold.evaluation.deadline.time", SimpleNamespace(monotonic=lambda: float(next(clock)))
    )
    looks = 20.0
    row = method.estimate(
        SYSTEM.problem(), criteria(11.0, tau=1.0), rng=1, evaluator=Evaluator(max_seconds=looks)
    )[0]
    assert row.status in {"failed", "budget_exhausted", "doubtful"}
    assert "max_seconds" in row.message
    assert next(clock) < 2 * looks


def test_the_limit_is_lifted_while_the_model_runs() -> None:
    """A run that was started is finished, though its model asks for the time itself."""
    asked = []

    def model(x: FloatArray) -> FloatArray:
        check_time()
        asked.append(len(x))
        return x[:, 0]

    def expired() -> None:
        raise TimeLimitError("over")

    with time_checked_by(expired):
        assert run_batch(model, np.zeros((3, 1)), Caution()).y.tolist() == [0.0, 0.0, 0.0]
        with pytest.raises(TimeLimitError):
            check_time()
    check_time()
    assert asked == [3]
