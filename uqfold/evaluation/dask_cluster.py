"""Evaluations on many machines, by Dask (the extra ``distributed``)."""

from __future__ import annotations

import pickle
import re
import socket
import time
from functools import lru_cache
from importlib import import_module
from types import ModuleType
from typing import Any, ClassVar

from uqfold.checks import instance, raised, refused, shown
from uqfold.evaluation.batch import Caution, Outcome, run_batch
from uqfold.evaluation.errors import ExecutorError
from uqfold.evaluation.executors import Executor, FuturesRunner, Runner, limited
from uqfold.typing import FloatArray, Model

ANSWER_SECONDS = 5.0
"""How long to wait for anything to answer at the address of the scheduler."""
CONNECT_SECONDS = 15.0
"""How long to wait for the scheduler itself, which tries so often."""
WITHOUT_WORKERS_SECONDS = 300.0
"""How long to wait for workers when there is none."""
LOOK_SECONDS = 5.0
"""How often to count the workers."""
_ADDRESS = re.compile(
    r"(?:(?:tcp|tls|ws|wss|ucx)://)?(?P<host>\[[0-9a-fA-F:.%\w]+\]|[\w.-]+):(?P<port>[0-9]{1,5})/?",
    re.ASCII,
)
QUEUED_PER_THREAD = 4
"""Batches handed over per thread of the workers: the way there and back takes milliseconds."""


class Dask(Executor):
    """Runs a model on the workers of a Dask cluster.

    Dask runs the batches of a worker that dies again elsewhere; a batch that several workers died
    of is run row by row, and a row that still kills them is a failed run. The model may be
    anything that cloudpickle takes; what it imports has to be installed on the workers. Workers
    with several threads run it several times at once: a model that does not allow that needs
    workers with one thread each.

    Parameters
    ----------
    cluster
        Address of the scheduler, as in ``tcp://10.0.0.1:8786``, or a `distributed.Client`, which
        stays the caller's.

    Raises
    ------
    TypeError, ValueError
        If it is neither an address with a port nor a client.
    ExecutorError
        If `distributed` is not installed, or no scheduler answers.
    """

    batch_rows: ClassVar[int] = 256

    def __init__(self, cluster: Any) -> None:
        self._own = isinstance(cluster, str)
        if self._own:
            _check_answer(cluster)
        distributed = _distributed()
        if not self._own:
            self.client = instance(
                "cluster",
                cluster,
                distributed.Client,
                "give the address of a scheduler, as in 'tcp://10.0.0.1:8786', or a Client",
            )
            return
        try:
            self.client = distributed.Client(cluster, timeout=CONNECT_SECONDS, set_as_default=False)
        except Exception as error:
            # what listens there may be anything, or want certificates
            raise _no_answer(cluster, error) from error

    def open(self, model: Model, seconds_per_run: float | None) -> Runner:
        """Return a runner for the workers that are there now."""
        return _DaskRunner(self.client, limited(model, seconds_per_run, "a run on a cluster"))

    def close(self) -> None:
        """Close the connection to the cluster, if it was made here."""
        if self._own:
            self.client.close()


class _InterruptedRunError(Exception):
    """The model raised KeyboardInterrupt."""


class _DaskRunner(FuturesRunner):
    def __init__(self, client: Any, model: Model) -> None:
        # comes with distributed
        import cloudpickle

        try:
            pickled: Any = cloudpickle.dumps(model)
        except Exception as error:
            raise ExecutorError(
                f"the model {shown(model)} cannot be sent to a cluster "
                f"({raised(error)}): make it a function "
                "of what it needs, without open files, locks or connections"
            ) from error
        super().__init__(client.get_executor(pure=False), pickled, workers=1)
        self._run = _run_pickled
        self._client = client
        self._last_seen = time.monotonic()
        self._next_look = 0.0
        self._look_for_workers()

    def finished(self, timeout: float) -> tuple[Any, Outcome] | None:
        self._look_for_workers()
        return super().finished(timeout)

    def _without_outcome(self, error: BaseException) -> Outcome:
        if isinstance(error, _distributed().KilledWorker):
            # which Dask says after several workers have died
            return Outcome.lost(died="the model ended its worker")
        if isinstance(error, _InterruptedRunError):
            raise KeyboardInterrupt
        raise ExecutorError(
            f"the cluster gave no responses ({raised(error)}): uqfold, in this "
            "version, and what the model imports have to be installed on its workers"
        ) from error

    def _look_for_workers(self) -> None:
        """Adapt to workers that have come or gone; without any there is nothing to wait for."""
        now = time.monotonic()
        if now < self._next_look:
            return
        self._next_look = now + LOOK_SECONDS
        threads = sum(self._client.nthreads().values())
        if threads:
            self.capacity, self._last_seen = QUEUED_PER_THREAD * threads, now
        elif now - self._last_seen > WITHOUT_WORKERS_SECONDS:
            raise ExecutorError(
                f"the cluster has had no worker for {WITHOUT_WORKERS_SECONDS:.0f} s: start some "
                "with `dask worker ADDRESS`, and the run again"
            )


@lru_cache(maxsize=4)
def _unpickled(model: bytes) -> Any:
    return pickle.loads(model)


def _run_pickled(model: bytes, x: FloatArray, caution: Caution) -> Outcome:
    """Run a batch on a worker, which loads the model once only."""
    try:
        return run_batch(_unpickled(model), x, caution)
    except KeyboardInterrupt as error:
        # it would end the worker, and the batch would be run again
        raise _InterruptedRunError from error


def _check_answer(cluster: str) -> None:
    """Refuse what is not an address, and one where nothing listens, which takes Dask a minute."""
    if cluster.startswith("inproc://"):
        return
    match = _ADDRESS.fullmatch(cluster)
    if match is None or not 0 < int(match["port"]) < 2**16:
        raise refused(
            "cluster", cluster, "give the address of a Dask scheduler, as in tcp://10.0.0.1:8786"
        )
    try:
        with socket.create_connection(
            (match["host"].strip("[]"), int(match["port"])), ANSWER_SECONDS
        ):
            return
    except (OSError, UnicodeError) as error:
        raise _no_answer(cluster, error) from error


def _no_answer(cluster: str, error: Exception) -> ExecutorError:
    return ExecutorError(
        f"no Dask scheduler answers at {cluster} ({error}): start one with `dask scheduler`, "
        "workers with `dask worker ADDRESS`, and give its address"
    )


def _distributed() -> ModuleType:
    try:
        return import_module("distributed")
    except ImportError as error:
        raise ExecutorError(
            "a cluster needs the package distributed: pip install 'uqfold[distributed]'"
        ) from error
