"""Executors: the same answer everywhere, whoever dies, hangs or raises on the way."""

import socket
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import uqfold
from tests.evaluation import models
from uqfold.evaluation import (
    Dask,
    Evaluator,
    ExecutorError,
    FailedRunError,
    Futures,
    InProcess,
    Processes,
    Store,
    TimeLimitError,
    per_sample,
)
from uqfold.methods import FFNIPearson, MonteCarlo, ReliabilityMethod, ReliabilityResult
from uqfold.typing import Model

ASKED = uqfold.criteria([1.0, 2.0], missions=[1, 2])


@pytest.fixture(scope="module")
def pool() -> Iterator[Processes]:
    with Processes(2) as processes:
        yield processes


def answer(
    model: Model, method: ReliabilityMethod | None = None, **settings: object
) -> ReliabilityResult:
    asked = MonteCarlo(systems=300) if method is None else method
    evaluator = Evaluator(**settings)  # type: ignore[arg-type]
    return asked.estimate(models.problem(model), ASKED, rng=8, evaluator=evaluator)


def numbers(result: ReliabilityResult) -> list[dict[str, object]]:
    return [{**row, "seconds": 0.0, "message": ""} for row in result.to_records()]


@pytest.mark.parametrize("method", [MonteCarlo(systems=300), FFNIPearson()])
def test_processes_and_threads_give_the_answer_of_this_process(
    pool: Processes, method: ReliabilityMethod
) -> None:
    expected = numbers(answer(models.quadratic, method, executor=InProcess()))
    uneven = models.Uneven(0.001)
    assert numbers(answer(uneven, method, executor=pool, batch_rows=5)) == expected
    assert numbers(answer(uneven, method, executor=pool)) == expected
    for workers in (1, 3):
        with ThreadPoolExecutor(workers) as threads:
            assert numbers(answer(uneven, method, executor=threads, batch_rows=7)) == expected


def test_a_pool_of_the_standard_library_is_taken() -> None:
    import multiprocessing

    expected = numbers(answer(models.quadratic))
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        assert numbers(answer(models.quadratic, executor=processes)) == expected
        with pytest.raises(ExecutorError, match="Processes replaces workers"):
            answer(models.deadly, executor=processes)


def test_several_blocks_are_under_way_and_come_in_order(pool: Processes) -> None:
    session = Evaluator(executor=pool, batch_rows=4).session(models.Uneven(0.002), 2, None)
    blocks = [models.rows(n, seed=n) for n in (3, 1, 9, 0, 5, 2, 8)]
    for x, y in zip(blocks, session.stream(iter(blocks)), strict=True):
        np.testing.assert_array_equal(y, models.quadratic(x))
    assert session.n_evals == 28


def test_runs_drawn_ahead_are_not_counted(pool: Processes) -> None:
    counts = set()
    method = MonteCarlo(systems=60_000, target_cov=0.05)
    for settings in ({"executor": pool}, {"executor": pool, "batch_rows": 256}, {}):
        result = answer(models.quadratic, method, **settings)  # type: ignore[arg-type]
        counts.add((result.n_evals, tuple(result.pf)))
    assert len(counts) == 1


@pytest.mark.parametrize("model", [models.raising, models.returning_nan])
def test_failed_runs_are_the_same_everywhere(pool: Processes, model: Model) -> None:
    x, bad = models.with_one_bad_row(60)
    good = np.arange(60) != bad
    session = Evaluator(executor=pool).session(model, 2, None)
    y = session.evaluate(x)
    np.testing.assert_array_equal(y[good], models.quadratic(x[good]))
    assert np.isnan(y[bad])
    assert f"x = [{x[bad, 0]:.6g}, {x[bad, 1]:.6g}]" in session.first_failure
    with pytest.raises(FailedRunError):
        Evaluator("raise", executor=pool).session(model, 2, None).evaluate(x)
    # and the pool goes on
    np.testing.assert_array_equal(
        Evaluator(executor=pool).session(models.quadratic, 2, None).evaluate(x),
        models.quadratic(x),
    )


def test_a_run_that_kills_its_process_fails_and_others_do_not() -> None:
    x, bad = models.with_one_bad_row(30)
    good = np.arange(30) != bad
    with Processes(2, retries=0) as pool:
        session = Evaluator(executor=pool).session(models.deadly, 2, None)
        y = session.evaluate(x)
    np.testing.assert_array_equal(y[good], models.quadratic(x[good]))
    assert np.isnan(y[bad])
    assert session.first_failure == (
        f"the model ended its process (exit code -9) at x = [{x[bad, 0]:.6g}, {x[bad, 1]:.6g}]"
    )


def test_batches_of_workers_that_die_are_run_again(pool: Processes, tmp_path: Path) -> None:
    expected = numbers(answer(models.quadratic))
    once = models.DeadlyOnce(tmp_path)
    assert numbers(answer(once, executor=pool, batch_rows=128)) == expected
    assert len(list(tmp_path.iterdir())) >= 2


def test_a_run_that_takes_too_long_fails_and_others_do_not(pool: Processes) -> None:
    x, bad = models.with_one_bad_row(60)
    good = np.arange(60) != bad
    session = Evaluator(executor=pool, seconds_per_run=0.5).session(models.hanging, 2, None)
    started = time.monotonic()
    y = session.evaluate(x)
    assert time.monotonic() - started < 30.0
    np.testing.assert_array_equal(y[good], models.quadratic(x[good]))
    assert np.isnan(y[bad])
    assert "took longer than 0.5 s" in session.first_failure


def test_loading_the_model_is_no_part_of_a_run(pool: Processes) -> None:
    session = Evaluator(executor=pool, seconds_per_run=0.4).session(SlowToLoad(), 2, None)
    assert session.evaluate(models.rows(4)).tolist() == [1.0] * 4


class SlowToLoad:
    def __setstate__(self, state: object) -> None:
        time.sleep(0.8)

    def __getstate__(self) -> object:
        return 1

    def __call__(self, x: np.ndarray) -> np.ndarray:
        return np.ones(len(x))


class Unloadable:
    def __reduce__(self) -> tuple[object, ...]:
        return (_refuse, ())

    def __call__(self, x: np.ndarray) -> np.ndarray:
        return x[:, 0]


def _refuse() -> None:
    raise ImportError("no module named solver")


def test_models_that_cannot_travel_are_refused_before_any_work(pool: Processes) -> None:
    with pytest.raises(ExecutorError, match="top level of a module"):
        answer(lambda x: x[:, 0], executor=pool)
    with pytest.raises(ExecutorError, match="no module named solver"):
        answer(Unloadable(), executor=pool)
    with ProcessPoolExecutor(1) as processes, pytest.raises(ExecutorError, match="top level"):
        answer(lambda x: x[:, 0], executor=processes)


@pytest.mark.parametrize("executor", [None, "threads"])
def test_a_limit_that_cannot_be_kept_is_refused(executor: str | None) -> None:
    model = models.Counting()
    with (
        ThreadPoolExecutor(1) as threads,
        pytest.raises(ValueError, match=r"seconds_per_run = 2.*Processes\(\)"),
    ):
        answer(model, seconds_per_run=2.0, executor=threads if executor else None)
    assert model.rows == 0


def test_samples_of_a_scalar_function_are_spread_over_the_workers(pool: Processes) -> None:
    model = per_sample(models.scalar)
    expected = numbers(answer(model))
    assert numbers(answer(model, executor=pool)) == expected
    with ThreadPoolExecutor(2) as threads:
        assert numbers(answer(model, executor=threads)) == expected


def test_store_and_workers_together(pool: Processes, tmp_path: Path) -> None:
    path = tmp_path / "runs.db"
    expected = numbers(answer(models.quadratic))
    first = answer(models.Uneven(0.001), executor=pool, store=path)
    # a third of the entries is lost
    with Store(path) as store:
        store._connection.execute("DELETE FROM responses WHERE rowid % 3 = 0")
    second = answer(models.Uneven(0.001), executor=pool, store=path)
    assert numbers(first) == expected
    assert [{**row, "n_reused": 0} for row in numbers(second)] == expected
    # the second mission of each system is another point: all rows differ
    assert second[0].n_reused == second.n_evals - second.n_evals // 3


def test_runs_with_a_limit_of_their_own_are_stored(pool: Processes, tmp_path: Path) -> None:
    """They are run one by one, so that how the model is called is never asked: none was kept."""
    settings = {"store": tmp_path / "runs.db", "executor": pool, "seconds_per_run": 60.0}
    results = [answer(models.quadratic, FFNIPearson(), **settings) for _ in range(2)]
    assert [result[0].n_reused for result in results] == [0, results[0].n_evals]


@pytest.mark.parametrize("retries", [0, 1])
def test_a_run_is_tried_again_as_often_as_said(tmp_path: Path, retries: int) -> None:
    x = models.rows(1)
    with Processes(1, retries=retries) as pool:
        session = Evaluator(executor=pool).session(models.DeadlyOnce(tmp_path, every=1), 2, None)
        y = session.evaluate(x)
    # the first try kills its process, a second would not
    assert np.isnan(y[0]) == (retries == 0)
    assert session.n_failed == 1 - retries


def test_wall_clock_limit_ends_monte_carlo_with_the_systems_that_are_complete(
    pool: Processes,
) -> None:
    slow = per_sample(_slow)
    # the workers are there before the clock runs
    warm = Evaluator(executor=pool, batch_rows=1)
    warm.session(models.Uneven(), 2, None).evaluate(models.rows(40))
    for executor in (None, pool):
        started = time.monotonic()
        evaluator = Evaluator(max_seconds=1.0, executor=executor, batch_rows=2048)
        result = MonteCarlo(systems=10**7).estimate(
            models.problem(models.Uneven(0.001)), ASKED, rng=8, evaluator=evaluator
        )
        assert time.monotonic() - started < 10.0
        for row in result:
            # how many systems there are by then depends on the machine
            known = 0.0 < row.std_error <= 0.1 * row.pf
            assert row.status == ("budget_exhausted" if known else "doubtful")
            assert "the wall-clock limit of 1 s is over" in row.message
        assert result.details.n_systems > 0
        # the last block is perhaps cut, those before are whatever ends them
        whole = int((result.details.history_systems % 4096 == 0).sum())
        if whole:
            same = MonteCarlo(systems=whole * 4096).estimate(models.problem(), ASKED, rng=8)
            found = result.details.history_failures[whole - 1]
            assert same.details.failures.tolist() == found.tolist()
    row = answer(slow, max_seconds=0.02)[0]
    assert (row.status, np.isnan(row.pf)) == ("failed", True)
    assert "out of budget before an answer: the wall-clock limit" in row.message


def test_wall_clock_limit_ends_a_wait_for_workers(pool: Processes) -> None:
    session = Evaluator(max_seconds=0.3, executor=pool).session(models.hanging, 2, None)
    started = time.monotonic()
    with pytest.raises(TimeLimitError):
        session.evaluate(np.full((2, 2), 9.0))
    assert time.monotonic() - started < 5.0


def _slow(x: np.ndarray) -> float:
    time.sleep(0.05)
    return float(x[0])


@pytest.mark.parametrize(
    "settings", [{"workers": 0}, {"retries": -1}, {"workers": 1.5}, {"retries": np.inf}]
)
def test_processes_refuse_impossible_numbers(settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(settings))} = .*: give a whole number"):
        Processes(**settings)


@pytest.mark.parametrize("settings", [{"workers": "2"}, {"workers": True}, {"retries": None}])
def test_processes_refuse_what_is_no_number(settings: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match=f"{next(iter(settings))} = .*: give a whole number"):
        Processes(**settings)
    assert Processes(np.int64(2), retries=np.int8(1)).workers == 2  # type: ignore[arg-type]


def test_futures_refuse_what_is_no_executor() -> None:
    with pytest.raises(TypeError, match=r"executor = 4: give a concurrent.futures.Executor"):
        Futures(4)  # type: ignore[arg-type]
    with ThreadPoolExecutor(3) as threads:
        assert Futures(threads).workers == 3
        with pytest.raises(ValueError, match="workers = 0"):
            Futures(threads, 0)


@pytest.mark.parametrize(
    "address", ["foo", "", "tcp://foo", "tcp://foo:0", "foo:99999", "foo:bar", "http://foo:80/x"]
)
def test_a_cluster_without_an_address_is_refused_at_once(address: str) -> None:
    """``--cluster foo`` waited for a minute."""
    with pytest.raises(ValueError, match=r"cluster = .*give the address of a Dask scheduler"):
        Dask(address)


def test_a_cluster_where_nobody_listens_is_told_at_once() -> None:
    with socket.socket() as closed:
        closed.bind(("127.0.0.1", 0))
        port = closed.getsockname()[1]
    with pytest.raises(ExecutorError, match=f"no Dask scheduler answers at tcp://127.0.0.1:{port}"):
        Dask(f"tcp://127.0.0.1:{port}")


def test_no_process_outlives_its_executor() -> None:
    processes = Processes(2)
    answer(models.quadratic, executor=processes)
    started = [worker.process for worker in processes._pool]
    assert started
    processes.close()
    assert not any(process.is_alive() for process in started)
