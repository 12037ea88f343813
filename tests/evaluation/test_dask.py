"""Dask: the answer of this process, also when a worker dies."""

import os
import signal
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import uqfold
from tests.evaluation import models
from uqfold.evaluation import Dask, Evaluator, ExecutorError
from uqfold.methods import MonteCarlo

pytestmark = [
    pytest.mark.thorough,
    # of the loops and servers that the cluster leaves behind
    pytest.mark.filterwarnings("default::ResourceWarning", "default::DeprecationWarning"),
]

ASKED = uqfold.criteria([1.0, 2.0], missions=[1, 2])


@pytest.fixture(scope="module", autouse=True)
def distributed() -> Any:
    """The extra; imported by the tests rather than while they are collected: it takes a second."""
    return pytest.importorskip("distributed", reason="needs the extra `distributed`")


def local_cluster(workers: int) -> Any:
    import distributed

    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0"
    )


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with local_cluster(2) as local:
        yield local


def numbers(model: Any, systems: int = 2000, **settings: Any) -> list[dict[str, object]]:
    result = MonteCarlo(systems=systems).estimate(
        models.problem(model), ASKED, rng=8, evaluator=Evaluator(**settings)
    )
    return [{**row, "seconds": 0.0} for row in result.to_records()]


def test_the_cluster_gives_the_answer_of_this_process(cluster: Any, distributed: Any) -> None:
    expected = numbers(models.quadratic)
    with Dask(cluster.scheduler_address) as dask:
        assert numbers(models.quadratic, executor=dask) == expected
        # a function that no module holds
        assert numbers(lambda x: x[:, 0] + 0.5 * x[:, 1] ** 2, executor=dask) == expected
        assert numbers(models.returning_nan, executor=dask) == numbers(models.returning_nan)
    with distributed.Client(cluster) as client:
        assert numbers(models.quadratic, executor=Dask(client)) == expected
        assert numbers(models.quadratic, executor=client.get_executor()) == expected


@pytest.mark.slow
def test_the_wing_deploys_on_a_cluster(cluster: Any) -> None:
    problem = uqfold.problems.folding_wing()
    x = problem.inputs.sample(np.random.default_rng(2), 256)
    with Dask(cluster.scheduler_address) as dask:
        session = Evaluator(executor=dask).open(problem, None)
        np.testing.assert_array_equal(session.evaluate(x), problem.model(x))


@pytest.mark.thorough
def test_a_worker_that_is_killed_halfway_changes_nothing(cluster: Any, distributed: Any) -> None:
    expected = numbers(models.quadratic)
    with distributed.Client(cluster) as client:
        victim = min(client.run(os.getpid).values())
    done: list[int] = []
    done_at_death: list[int] = []
    halfway = threading.Event()

    def kill() -> None:
        if halfway.wait(timeout=120):
            done_at_death.append(done[-1])
            os.kill(victim, signal.SIGKILL)

    def progress(n_evals: int, _expected: int | None) -> None:
        done.append(n_evals)
        if n_evals > 1000:
            halfway.set()

    killer = threading.Thread(target=kill)
    killer.start()
    with Dask(cluster.scheduler_address) as dask:
        settings = {"executor": dask, "batch_rows": 64, "progress": progress}
        assert numbers(models.Uneven(0.05), **settings) == expected
    killer.join()
    # it was at work when the worker died
    assert 1000 < done_at_death[0] < done[-1] - 1000


@pytest.mark.slow
def test_a_run_that_kills_its_workers_fails_and_others_do_not() -> None:
    import dask.config

    x, bad = models.with_one_bad_row(8)
    good = np.arange(8) != bad
    # Dask gives a worker up that dies while it starts: so few deaths that none has to be replaced
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        local_cluster(4) as cluster,
        Dask(cluster.scheduler_address) as executor,
    ):
        session = Evaluator(executor=executor).session(models.deadly, 2, None)
        y = session.evaluate(x)
    np.testing.assert_array_equal(y[good], models.quadratic(x[good]))
    assert np.isnan(y[bad])
    assert "the model ended its worker" in session.first_failure


def test_an_interrupt_that_a_model_raises_ends_the_program(cluster: Any) -> None:
    """It ended one worker after the other, and counted as a failed run."""

    def interrupting(x: np.ndarray) -> np.ndarray:
        raise KeyboardInterrupt

    with Dask(cluster.scheduler_address) as dask:
        with pytest.raises(KeyboardInterrupt):
            numbers(interrupting, executor=dask)
        assert numbers(models.quadratic, executor=dask) == numbers(models.quadratic)


def test_a_limit_per_run_is_refused(cluster: Any) -> None:
    with (
        Dask(cluster.scheduler_address) as dask,
        pytest.raises(ValueError, match="a run on a cluster cannot be ended"),
    ):
        numbers(models.quadratic, executor=dask, seconds_per_run=1.0)


def test_a_cluster_without_workers_is_not_waited_for_without_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("uqfold.evaluation.dask_cluster.WITHOUT_WORKERS_SECONDS", 1.0)
    monkeypatch.setattr("uqfold.evaluation.dask_cluster.LOOK_SECONDS", 0.2)
    with (
        local_cluster(0) as cluster,
        Dask(cluster.scheduler_address) as dask,
        pytest.raises(ExecutorError, match="has had no worker for 1 s"),
    ):
        numbers(models.quadratic, executor=dask)


def test_an_address_where_nobody_answers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("uqfold.evaluation.dask_cluster.CONNECT_SECONDS", 1.0)
    with pytest.raises(ExecutorError, match="no Dask scheduler answers at tcp"):
        Dask("tcp://127.0.0.1:9")
