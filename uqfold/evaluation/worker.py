"""One worker process: its line, its job, and what it does on the other side."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from contextlib import suppress
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from typing import Any, NoReturn

import numpy as np

from uqfold.evaluation.batch import Caution, Outcome, run_batch
from uqfold.evaluation.guard import adopt_orphans, descendants, end_descendants
from uqfold.typing import FloatArray

ENDING_SECONDS = 1.0
"""How long a worker may take to end what it has started."""


@dataclass(eq=False)
class Job:
    """One batch; `alone`: its rows are run one by one, `done` of them are through."""

    batch: Any
    x: FloatArray
    caution: Caution
    alone: bool
    done: int = 0
    deaths: int = 0
    seconds: float = 0.0
    reason: str = ""
    unusable: str = ""
    y: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.y = np.full(self.x.shape[0], np.nan)

    @property
    def rows(self) -> slice:
        """Rows to be run next."""
        return slice(self.done, self.done + 1 if self.alone else self.x.shape[0])

    def advance(self, outcome: Outcome) -> bool:
        """Take the responses of `rows`; return whether the batch is through."""
        rows = self.rows
        self.y[rows] = outcome.y
        self.reason = self.reason or outcome.reason
        self.unusable = self.unusable or outcome.unusable
        self.seconds += outcome.seconds
        self.caution = replace(self.caution, in_doubt=outcome.in_doubt)
        self.done, self.deaths = rows.stop, 0
        return bool(self.done == self.x.shape[0])

    def outcome(self) -> Outcome:
        """Return the responses of the whole batch."""
        return Outcome(self.y, self.reason, self.seconds, self.caution.in_doubt, self.unusable)


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
    # Ctrl-C reaches all processes of the group; what it means the one that started them decides
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    adopt_orphans()
    signal.signal(signal.SIGTERM, _end)
    threading.Thread(target=_end_with_parent, daemon=True).start()
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
            line.send(("unusable", f"{type(error).__name__}: {error}"))
            return


def _end_with_parent() -> None:
    """End this process when the one that started it is gone, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        _end()


def _end(*_: object) -> NoReturn:
    """End this process, and whatever the model has started."""
    if os.name == "posix":
        end_descendants()
    os._exit(128 + signal.SIGTERM)
