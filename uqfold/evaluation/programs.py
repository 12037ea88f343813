"""Running a program under a guard, which ends it with all that it has started."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from uqfold.evaluation import guard
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.run_folder import STDERR, STDOUT

_GUARD_SECONDS = 15.0
"""How long to wait for a guard that ends its program."""
_WAIT_SECONDS = 1e6
"""The longest single wait: some systems take no longer one."""


class Programs:
    """The programs of one model that are running.

    A copy made for another process has none running.
    """

    def __init__(self) -> None:
        self._ends: dict[int, Callable[[], object]] = {}
        self._lock = threading.Lock()

    def __reduce__(self) -> tuple[type[Programs], tuple[()]]:
        """Hand nothing on but the kind."""
        return Programs, ()

    def run(self, command: Sequence[str], folder: Path, timeout: float | None) -> None:
        """Run a program in a folder until it ends, or its time is over.

        What it prints goes into ``stdout.txt`` and ``stderr.txt`` there. Nothing that it has
        started is left when this returns.

        Raises
        ------
        ExternalRunError
            If it cannot be started, ends with another exit code than 0, takes longer than
            `timeout` seconds, or is ended by `end`.
        """
        with (folder / STDOUT).open("xb") as out, (folder / STDERR).open("xb") as err:
            run = self._guarded if os.name == "posix" else self._direct
            code = run(command, folder, timeout, (out.fileno(), err.fileno()))
        if code != 0:
            raise ExternalRunError(f"exit code {code}")

    def end(self) -> None:
        """End the programs that are running; those that wait for them get an ExternalRunError."""
        with self._lock:
            for end in self._ends.values():
                with suppress(OSError):
                    end()

    @contextmanager
    def _known(self, end: Callable[[], object]) -> Iterator[None]:
        with self._lock:
            self._ends[id(end)] = end
        try:
            yield
        finally:
            with self._lock:
                del self._ends[id(end)]

    def _guarded(
        self, command: Sequence[str], folder: Path, timeout: float | None, files: tuple[int, int]
    ) -> int:
        line, far = socket.socketpair()
        # whatever happens here, Ctrl-C included: the line is cut, and the guard ends the program
        with line:
            with far:
                process = subprocess.Popen(
                    [sys.executable, "-I", "-S", guard.__file__, *command],
                    cwd=folder,
                    stdin=far.fileno(),
                    stdout=files[0],
                    stderr=files[1],
                    # Ctrl-C is for the caller, who decides what it means
                    start_new_session=True,
                )

            def cut() -> None:
                line.shutdown(socket.SHUT_WR)

            try:
                with self._known(cut):
                    kind, told = _report(line, timeout)
            finally:
                with suppress(OSError):
                    cut()
                try:
                    process.wait(_GUARD_SECONDS)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        if kind == guard.NOT_STARTED:
            raise ExternalRunError(f"{command[0]} cannot be started: {told}")
        if kind != guard.ENDED:
            raise ExternalRunError("it was ended before it was through")
        return int(told)

    def _direct(
        self, command: Sequence[str], folder: Path, timeout: float | None, files: tuple[int, int]
    ) -> int:
        """Run a program where no guard can: what it has started itself may outlive it."""
        try:
            process = subprocess.Popen(
                command, cwd=folder, stdin=subprocess.DEVNULL, stdout=files[0], stderr=files[1]
            )
        except OSError as error:
            raise ExternalRunError(f"{command[0]} cannot be started: {error.strerror}") from error
        try:
            with self._known(process.kill):
                return process.wait(timeout)
        except subprocess.TimeoutExpired:
            raise _too_long(timeout) from None
        finally:
            process.kill()
            process.wait()


def _report(line: socket.socket, timeout: float | None) -> tuple[str, str]:
    """Wait for what the guard says: which kind of end, and its details."""
    last = None if timeout is None else time.monotonic() + timeout
    while True:
        left = _WAIT_SECONDS if last is None else last - time.monotonic()
        if left <= 0.0:
            raise _too_long(timeout)
        line.settimeout(min(left, _WAIT_SECONDS))
        try:
            told = line.recv(4096).decode()
        except TimeoutError:
            continue
        except ConnectionError:
            told = ""
        kind = guard.NOT_STARTED if told.startswith(guard.NOT_STARTED) else guard.ENDED
        return (kind, told.removeprefix(kind).strip()) if told else ("", "")


def _too_long(timeout: float | None) -> ExternalRunError:
    return ExternalRunError(f"it took longer than {timeout:g} s")
