"""One worker process: its line, its job, and what it does on the other side."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, NamedTuple, NoReturn

from uqfold.checks import raised
from uqfold.evaluation.batch import Caution, run_batch
from uqfold.evaluation.guard import adopt_orphans, descendants, end_descendants
from uqfold.typing import FloatArray

ENDING_SECONDS = 1.0
"""How long a worker may take to end what it has started."""


class Job(NamedTuple):
    """The rows X (n, d) of a batch, for a worker."""

    batch: Any
    x: FloatArray
    caution: Caution


@dataclass(eq=False)
class Worker:
    """A process and the line to it; `ready`: it has loaded the model with that token."""

    process: Any
    line: Connection
    token: int = -1
    ready: bool = False
    job: Job | None = None
    deadline: float | None = None

    @classmethod
    def start(cls) -> Worker:
        """Start a process."""
        # a fork would copy locks that other threads hold, and the lines to the other workers
        methods = multiprocessing.get_all_start_methods()
        context: Any = multiprocessing.get_context(
            "forkserver" if "forkserver" in methods else "spawn"
        )
        here, there = context.Pipe()
        process = context.Process(target=_serve, args=(there,), daemon=True)
        process.start()
        there.close()
        return cls(process, here)

    def end(self) -> int | None:
        """End the process with all that it has started, and return its exit code."""
        self.process.terminate()
        self.process.join(ENDING_SECONDS)
        if self.process.is_alive():
            # compiled code does not listen
            started = descendants(self.process.pid) if os.name == "posix" else []
            self.process.kill()
            self.process.join()
            for one in started:
                with suppress(OSError):
                    os.kill(one, signal.SIGKILL)
        self.line.close()
        code: int | None = self.process.exitcode
        return code


def _serve(line: Connection) -> None:
    """Life of a worker: load models, run batches, until the line is cut."""
    follow_parent()
    try:
        _work(line)
    finally:
        # a model whose programs were killed may return while others are still to be killed
        _end_what_was_started()


def follow_parent() -> None:
    """Make this process a worker: it leaves Ctrl-C to its parent, and ends with it."""
    # Ctrl-C reaches all processes of the group; what it means the one that started them decides
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    adopt_orphans()
    signal.signal(signal.SIGTERM, _end)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _work(line: Connection) -> None:
    model: Any = None
    while True:
        try:
            kind, content = line.recv()
            if kind == "model":
                model = pickle.loads(content)
                line.send(("ready", None))
            else:
                line.send(("batch", run_batch(model, *content)))
        except (EOFError, BrokenPipeError, ConnectionResetError):
            return
        except KeyboardInterrupt:
            # of the model's own making, since the signal is ignored here
            line.send(("interrupt", None))
            return
        except Exception as error:
            line.send(("unusable", raised(error)))
            return


def _end_with_parent() -> None:
    """End this process when the one that started it is gone, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        _end()


def _end(*_: object) -> NoReturn:
    """End this process, and whatever the model has started."""
    _end_what_was_started()
    os._exit(128 + signal.SIGTERM)


def _end_what_was_started() -> None:
    if os.name == "posix":
        end_descendants()
