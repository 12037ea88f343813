"""A limit on time holds within a batch too: how many rows the model is run on at once.

The clock is one that only the model moves, so that every number here is exact.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import uqfold
from tests.evaluation import models
from uqfold.evaluation import (
    EvaluationSession,
    Evaluator,
    FailedRunError,
    ModelError,
    TimeLimitError,
)
from uqfold.evaluation.batch import Caution, Outcome
from uqfold.evaluation.calling import REPEATS
from uqfold.evaluation.executors import Runner
from uqfold.evaluation.pipeline import LONGEST_SECONDS, LONGEST_SHARE, BatchSize, Pipeline
from uqfold.inputs import normal
from uqfold.methods import (
    ConditionalMonteCarlo,
    FFNIPearson,
    MonteCarlo,
    OpenTURNSFORM,
    OpenTURNSMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
)
from uqfold.typing import FloatArray

ASKED = uqfold.criteria([1.0, 2.0])
RUN_SECONDS = 0.01
PF_ABOVE_1 = 0.9213503964748574  # Phi(2 / sqrt 2)


class Clock:
    """Moved by a model: so many seconds for each row, and for each call."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 0.0
        self.sizes: list[int] = []
        told = SimpleNamespace(monotonic=lambda: self.now, perf_counter=lambda: self.now)
        for module in ("deadline", "batch"):
            monkeypatch.setattr(f"uqfold.evaluation.{module}.time", told)

    def model(
        self,
        response: Callable[[FloatArray], FloatArray] = models.quadratic,
        seconds: float = RUN_SECONDS,
        per_call: float = 0.0,
    ) -> Callable[[FloatArray], FloatArray]:
        def run(x: FloatArray) -> FloatArray:
            self.now += per_call + seconds * len(x)
            self.sizes.append(len(x))
            return response(x)

        return run


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


def opened(model: Any, **given: Any) -> EvaluationSession:
    return Evaluator(**given).session(model, 2, None)


@pytest.mark.parametrize("given", [{}, {"batch_rows": 4096}, {"batch_rows": 100}])
@pytest.mark.parametrize("n", [2000, 100_000])
def test_a_time_limit_during_one_batch_of_a_vectorised_model_is_kept(
    clock: Clock, n: int, given: dict[str, int]
) -> None:
    """4,096 runs of 10 ms each were one batch, and took 41 s under a limit of 4 s."""
    session = opened(clock.model(), max_seconds=4.0, **given)
    x = models.rows(n)
    with pytest.raises(TimeLimitError) as caught:
        session.evaluate(x)
    assert 4.0 <= clock.now < 4.0 + 2 * RUN_SECONDS
    # two runs were made again alone in a batch of 2, 4 and 8, to see how the model is called
    assert session.n_evals == round(clock.now / RUN_SECONDS) - 6
    made = caught.value.responses
    np.testing.assert_array_equal(made, models.quadratic(x[: session.n_evals]))


@pytest.mark.parametrize(
    ("method", "seconds"),
    [
        (MonteCarlo(), 0.01),
        (ConditionalMonteCarlo(), 0.01),
        (PolynomialChaos(runs=60), 0.1),
        (OpenTURNSMonteCarlo(block_size=200, target_cov=1e-3), 0.01),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_every_method_keeps_a_limit_that_is_over_within_one_batch(
    clock: Clock, method: ReliabilityMethod, seconds: float
) -> None:
    """Streams and designs alike answer with what was made in time, not with a batch of 41 s."""
    problem = models.problem(clock.model(seconds=seconds), units=1)
    row = method.estimate(problem, ASKED, rng=3, evaluator=Evaluator(max_seconds=4.0))[0]
    assert clock.now < 4.0 + 2 * seconds
    # perhaps two runs were made again alone in a batch of 2, 4 and 8
    assert round(clock.now / seconds) - row.n_evals in {0, 2, 6}
    assert row.status in {"budget_exhausted", "doubtful"}


def test_workers_get_small_batches_under_a_time_limit(clock: Clock) -> None:
    """A batch in a worker that takes longer than the limit was lost as a whole."""
    with ThreadPoolExecutor(1) as threads:
        session = opened(clock.model(), max_seconds=4.0, executor=threads, batch_rows=4096)
        with pytest.raises(TimeLimitError) as caught:
            session.evaluate(models.rows(2000))
    assert clock.now < 4.0 + 2 * LONGEST_SHARE * 4.0
    assert caught.value.responses.size == session.n_evals > 300


def test_a_single_expensive_run_is_the_first_batch_alone(clock: Clock) -> None:
    session = opened(clock.model(seconds=10.0), max_seconds=15.0)
    with pytest.raises(TimeLimitError):
        session.evaluate(models.rows(50))
    # none of them is spent on finding out how the model is called: one row needs no check
    assert clock.sizes == [1, 1]
    assert session.n_evals == 2


def test_the_run_that_ends_beyond_the_limit_counts(clock: Clock) -> None:
    """What is complete is handed out, though no time is left for more."""
    session = opened(clock.model(seconds=10.0), max_seconds=5.0)
    x = models.rows(1)
    np.testing.assert_array_equal(session.evaluate(x), models.quadratic(x))
    with pytest.raises(TimeLimitError):
        session.evaluate(x)


def normalised(x: FloatArray) -> FloatArray:
    y = x[:, 0] - x[:, 1]
    return np.asarray((y - y.mean()) / y.std() if len(y) > 50 else y)


def in_order(x: FloatArray) -> FloatArray:
    return np.sort(x[:, 0] - x[:, 1])


def clipped(x: FloatArray) -> FloatArray:
    y = x[:, 0] - x[:, 1]
    return np.asarray(np.clip(y, *np.quantile(y, [0.05, 0.95])) if len(y) > 50 else y)


def clipped_with_noise(x: FloatArray) -> FloatArray:
    """The last digits are those of a sum in several threads."""
    rng = np.random.default_rng()
    return clipped(x) * (1.0 + 1e-9 * rng.standard_normal(len(x)))


MIXING = [normalised, in_order, clipped, clipped_with_noise]


@pytest.mark.parametrize("model", MIXING)
@pytest.mark.parametrize("threads", [0, 1])
def test_rows_that_depend_on_each_other_in_large_batches_only_are_found_out(
    clock: Clock, model: Any, threads: int
) -> None:
    """Only batches of 1 and 2 rows were looked at under a limit: 0.160 was told for 0.921."""
    told = clock.model(model, seconds=1e-4)
    with ThreadPoolExecutor(1) as pool:
        session = opened(told, max_seconds=60.0, executor=pool if threads else None)
        with pytest.raises(ModelError, match="beside it"):
            session.evaluate(models.rows(20_000))


@pytest.mark.parametrize("model", MIXING)
@pytest.mark.parametrize(
    "method",
    [
        MonteCarlo(systems=5000),
        ConditionalMonteCarlo(),
        FFNIPearson(nodes_individual=5),
        OpenTURNSFORM(),
    ],
    ids=lambda method: method.name,
)
def test_no_method_answers_under_a_limit_with_responses_of_other_rows(
    clock: Clock, model: Any, method: ReliabilityMethod
) -> None:
    """It is refused, or has met no batch in which its rows depend on each other."""
    told = clock.model(model, seconds=1e-4)
    inputs = {"a": normal(5.0, 1.0), "b": normal(2.0, 1.0)}
    problem = uqfold.Problem(told, individual=inputs, name="mixing")
    row = method.estimate(
        problem, uqfold.criteria(1.0), rng=1, evaluator=Evaluator(max_seconds=60.0)
    )[0]
    if row.status == "failed":
        assert "beside it" in row.message
    else:
        assert max(clock.sizes) <= 50
        assert row.pf == pytest.approx(PF_ABOVE_1, rel=0.05)


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1.0, 100.0])
def test_a_few_rows_are_compared_as_batches_grow(clock: Clock, noise: float) -> None:
    """A noisy model is taken, and the comparisons are few and count nowhere."""
    rng = np.random.default_rng(2)

    def response(x: FloatArray) -> FloatArray:
        return models.quadratic(x) + noise * rng.standard_normal(len(x))

    session = opened(clock.model(response, seconds=1e-6), max_seconds=60.0)
    session.evaluate(models.rows(50_000))
    assert session.n_evals == 50_000
    again = sum(clock.sizes) - session.n_evals
    assert again == 12 if noise == 0.0 else again <= 4 * 4 * (1 + REPEATS)


def test_a_row_that_fails_alone_by_chance_refuses_no_model_later(clock: Clock) -> None:
    rng = np.random.default_rng(4)

    def response(x: FloatArray) -> FloatArray:
        if len(clock.sizes) > 6 and len(x) == 1 and rng.random() < 0.9:
            raise OSError("no licence")
        return models.quadratic(x)

    session = opened(clock.model(response, seconds=1e-6), max_seconds=60.0)
    assert session.evaluate(models.rows(20_000)).size == session.n_evals == 20_000


def test_a_cheap_model_soon_gets_batches_as_large_as_without_a_limit(clock: Clock) -> None:
    session = opened(clock.model(seconds=1e-6, per_call=1e-4), max_seconds=60.0)
    session.evaluate(models.rows(100_000))
    assert len(clock.sizes) < 50
    assert max(clock.sizes) == 4096


def test_the_first_run_may_take_long_since_it_compiles(clock: Clock) -> None:
    def compiling(x: FloatArray) -> FloatArray:
        clock.now += 5.0 if len(clock.sizes) == 1 else 0.0
        return models.quadratic(x)

    session = opened(clock.model(compiling, seconds=1e-6), max_seconds=60.0)
    session.evaluate(models.rows(20_000))
    assert len(clock.sizes) < 40


class Dying(Runner):
    """Workers die over several rows, and take a second for each single one."""

    capacity = 1

    def __init__(self) -> None:
        self.now = 0.0
        self.calls: list[tuple[Any, FloatArray]] = []

    @property
    def in_flight(self) -> int:
        return len(self.calls)

    def submit(self, batch: Any, x: FloatArray, caution: Caution) -> None:
        self.calls.append((batch, x))

    def finished(self, timeout: float) -> tuple[Any, Outcome]:
        batch, x = self.calls.pop()
        if len(x) > 1:
            return batch, Outcome.lost(died="the worker has died")
        self.now += 1.0
        return batch, Outcome(models.quadratic(x), "", 1.0)

    def abandon(self) -> None:
        self.calls.clear()


@pytest.mark.parametrize("seconds", [7.0, 1e6])
def test_a_limit_holds_while_rows_are_run_one_by_one_after_a_death(seconds: float) -> None:
    runner = Dying()

    def check() -> None:
        if runner.now >= seconds:
            raise TimeLimitError("over")

    x = models.rows(20)
    pipeline = Pipeline(runner, lambda _: 20, lambda: np.inf, None, in_doubt=False)
    if seconds < 20.0:
        with pytest.raises(TimeLimitError):
            list(pipeline.batches([x], check))
        assert runner.now == seconds
    else:
        [batch] = pipeline.batches([x], check)
        np.testing.assert_array_equal(batch.y, models.quadratic(x))


def test_a_batch_takes_a_small_part_of_what_is_left() -> None:
    left = 100.0
    size = BatchSize(lambda: left)
    assert size.rows(4096) == 1
    rows = 1
    for _ in range(20):
        size.took(rows, 0.1 * rows)
        assert size.rows(4096) <= 2 * rows
        rows = size.rows(4096)
    assert rows == LONGEST_SECONDS / 0.1
    left = 1.0
    assert size.rows(4096) == 1
    # the model has become slower: less at once
    left = 100.0
    size.took(10, 5.0)
    assert size.rows(4096) == 2
    left = -1.0
    assert size.rows(4096) == 1
    assert BatchSize(lambda: np.inf).rows(4096) == 4096


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 5000),
    st.floats(1e-6, 1e-2),
    st.sets(st.integers(0, 4999), max_size=5),
    st.sampled_from(["bound", "count-as-failure"]),
)
def test_results_do_not_depend_on_the_size_of_the_batches(
    n: int, seconds: float, bad: set[int], policy: str
) -> None:
    def response(x: FloatArray) -> FloatArray:
        return np.where(np.isin(x[:, 0], list(bad)), np.nan, x[:, 0])

    x = np.column_stack([np.arange(float(n)), np.ones(n)])
    whole = opened(response, failed_runs=policy)
    with pytest.MonkeyPatch.context() as patch:
        clock = Clock(patch)
        session = opened(clock.model(response, seconds), max_seconds=1e3, failed_runs=policy)
        y = session.evaluate(x)
    np.testing.assert_array_equal(y, whole.evaluate(x))
    assert session.n_evals == whole.n_evals
    assert session.n_failed == whole.n_failed
    assert session.first_failure == whole.first_failure


@pytest.mark.parametrize("n", [500, 3000])
def test_what_was_made_in_time_is_stored_and_found_again(
    clock: Clock, n: int, tmp_path: Path
) -> None:
    """An entry of 64 rows that the limit has cut is completed by the next run."""
    x = models.rows(n)
    made = 0
    for _ in range(3):
        evaluator = Evaluator(store=tmp_path / "runs.db", max_seconds=1.0)
        session = evaluator.open(models.problem(models.Counting(clock.model())), None)
        with pytest.raises(TimeLimitError):
            session.evaluate(x)
        assert session.n_reused == made
        made = session.n_evals
    session = Evaluator(store=tmp_path / "runs.db").open(
        models.problem(models.Counting(clock.model())), None
    )
    np.testing.assert_array_equal(session.evaluate(x), models.quadratic(x))
    assert session.n_reused == made
    session = Evaluator(store=tmp_path / "runs.db").open(
        models.problem(models.Counting(models.never)), None
    )
    assert session.evaluate(x).size == session.n_reused == n


@pytest.mark.parametrize("limit", [None, 1e6])
def test_a_model_is_given_up_at_the_same_row_with_and_without_a_limit(
    clock: Clock, limit: float | None
) -> None:
    def late(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] < good, np.nan, x[:, 0])

    x = np.column_stack([np.arange(8000.0), np.ones(8000)])
    good = 4000
    session = opened(clock.model(late), max_seconds=limit)
    assert np.count_nonzero(~np.isnan(session.evaluate(x))) == 4000
    good = 5000
    session = opened(clock.model(late), max_seconds=limit)
    with pytest.raises(FailedRunError, match="all of the first 4096 runs failed"):
        session.evaluate(x)


def test_progress_is_told_about_once_a_second_under_a_limit(clock: Clock) -> None:
    """Progress, and Ctrl-C between two calls of the model, have the bound of the batches."""
    told: list[float] = []
    session = opened(clock.model(), max_seconds=3600.0, progress=lambda *_: told.append(clock.now))
    session.evaluate(models.rows(5000))
    assert np.diff(told).max() <= LONGEST_SECONDS + 4 * RUN_SECONDS
