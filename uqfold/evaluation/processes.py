"""Worker processes for a slow Python model; workers that die or hang are replaced.

The standard library's pool does not say which task killed a worker, and cannot end a single one.
Here every worker has a line of its own, so that both are known.
"""

from __future__ import annotations

import os
import time
import weakref
from collections import deque
from itertools import count
from multiprocessing.connection import wait
from typing import Any

from uqfold.checks import or_none, whole
from uqfold.evaluation.batch import Caution, Outcome
from uqfold.evaluation.calling import shown
from uqfold.evaluation.errors import ExecutorError
from uqfold.evaluation.executors import QUEUED_PER_WORKER, Executor, Runner, pickled
from uqfold.evaluation.row_model import RowModel
from uqfold.evaluation.worker import Job, Worker
from uqfold.typing import FloatArray, Model

_TOKENS = count()


class Processes(Executor):
    """Runs a model in worker processes.

    The model has to be picklable: a function at the top level of a module, or an object of such a
    class. In a script, what starts the run belongs below ``if __name__ == "__main__":``. The
    workers are started when they are first needed, and kept until `close`, or the end of the
    program.

    A worker that dies has its batch run again; when it dies again the rows are run one by one, and
    a row that still kills `retries` + 1 workers is a failed run. With a limit on the time of a run
    (`Evaluator.seconds_per_run`) a worker whose run takes too long is killed: that run has failed.

    Parameters
    ----------
    workers
        How many; by default one for each core.
    retries
        How often a row that may have killed its worker is tried again.

    Raises
    ------
    TypeError, ValueError
        If a number is none, or out of range.
    """

    def __init__(self, workers: int | None = None, *, retries: int = 2) -> None:
        asked = or_none("workers", workers, whole, at_least=1)
        self.workers = asked or os.cpu_count() or 1
        self.retries = whole("retries", retries, at_least=0)
        self._pool: list[Worker] = []
        self._finalizer = weakref.finalize(self, _kill_all, self._pool)

    def open(self, model: Model, seconds_per_run: float | None) -> Runner:
        """Return a runner; the processes start with its first batch."""
        if isinstance(model, RowModel) and seconds_per_run is not None:
            # who starts a program is the one to end it: killing its parent would leave it running
            keeping = model.with_time_limit(seconds_per_run)
            if keeping is not None:
                model, seconds_per_run = keeping, None
        return _ProcessesRunner(self, pickled(model), seconds_per_run)

    def close(self) -> None:
        """End the processes."""
        _kill_all(self._pool)

    def idle(self) -> Worker | None:
        """Return a worker without a job, started if need be; None if all are busy."""
        for worker in self._pool:
            if worker.job is None:
                return worker
        if len(self._pool) == self.workers:
            return None
        self._pool.append(Worker.start())
        return self._pool[-1]

    def busy(self) -> list[Worker]:
        """Return the workers that have a job."""
        return [worker for worker in self._pool if worker.job is not None]

    def discard(self, worker: Worker) -> int | None:
        """Remove a worker for good and give its exit code."""
        self._pool.remove(worker)
        return worker.end()


class _ProcessesRunner(Runner):
    def __init__(self, pool: Processes, model: bytes, seconds_per_run: float | None) -> None:
        self.capacity = QUEUED_PER_WORKER * pool.workers
        self.retries = pool.retries
        self._pool = pool
        self._model = model
        self._token = next(_TOKENS)
        self._limit = seconds_per_run
        self._queue: deque[Job] = deque()
        self._through: deque[tuple[Any, Outcome]] = deque()
        self._deaths_while_loading = 0

    @property
    def in_flight(self) -> int:
        return len(self._queue) + len(self._pool.busy()) + len(self._through)

    def submit(self, batch: Any, x: FloatArray, caution: Caution) -> None:
        self._queue.append(Job(batch, x, caution))
        self._assign()

    def finished(self, timeout: float) -> tuple[Any, Outcome] | None:
        end = time.monotonic() + timeout
        while not self._through:
            self._assign()
            limits = [w.deadline for w in self._pool.busy() if w.deadline is not None]
            left = max(0.0, min([end, *limits]) - time.monotonic())
            lines = {worker.line: worker for worker in self._pool.busy()}
            for line in wait(list(lines), left):
                self._hear(lines[line])  # type: ignore[index]
            now = time.monotonic()
            for worker in self._pool.busy():
                if worker.deadline is not None and now >= worker.deadline:
                    self._end_overdue(worker)
            if now >= end and not self._through:
                return None
        return self._through.popleft()

    def abandon(self) -> None:
        self._queue.clear()
        self._through.clear()
        for worker in self._pool.busy():
            self._pool.discard(worker)

    def _assign(self) -> None:
        while self._queue and (worker := self._pool.idle()) is not None:
            worker.job = self._queue.popleft()
            self._send(worker)

    def _send(self, worker: Worker) -> None:
        job = worker.job
        assert job is not None
        try:
            if worker.token != self._token:
                worker.token, worker.ready = self._token, False
                worker.line.send(("model", self._model))
            worker.line.send(("batch", (job.x, job.caution)))
        except OSError:
            self._bury(worker)
            return
        if worker.ready and self._limit is not None:
            worker.deadline = time.monotonic() + self._limit

    def _hear(self, worker: Worker) -> None:
        try:
            kind, content = worker.line.recv()
        except (EOFError, OSError):
            self._bury(worker)
            return
        if kind == "unusable":
            raise ExecutorError(
                f"a worker process cannot load the model ({content}): define it in a module that "
                "can be imported"
            )
        if kind == "interrupt":
            raise KeyboardInterrupt
        if kind == "ready":
            # importing and compiling do not count as a run's time
            worker.ready = True
            self._deaths_while_loading = 0
            if self._limit is not None:
                worker.deadline = time.monotonic() + self._limit
            return
        assert worker.job is not None
        self._through.append((worker.job.batch, content))
        worker.job = worker.deadline = None

    def _bury(self, worker: Worker) -> None:
        """A worker has died: of its rows, unless it died before it had the model."""
        code, job = self._pool.discard(worker), worker.job
        assert job is not None
        if worker.ready:
            died = f"the model ended its process (exit code {code})"
            self._through.append((job.batch, Outcome.lost(died=died)))
            return
        self._deaths_while_loading += 1
        if self._deaths_while_loading > self._pool.retries:
            raise ExecutorError(
                f"worker processes end before they have loaded the model (exit code {code}): "
                "in a script, start the run below `if __name__ == '__main__':`"
            )
        self._queue.appendleft(job)

    def _end_overdue(self, worker: Worker) -> None:
        job = worker.job
        assert job is not None
        self._pool.discard(worker)
        reason = f"the run took longer than {self._limit:g} s at x = {shown(job.x[0])}"
        self._through.append((job.batch, Outcome.lost(reason=reason)))


def _kill_all(pool: list[Worker]) -> None:
    for worker in pool:
        worker.process.terminate()
    while pool:
        pool.pop().end()
