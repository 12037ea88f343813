"""A model that is a program: write its input, start it, read its output.

Most engineers' models look like that: a solver with an input file, of which some numbers are
random.
"""

from __future__ import annotations

import copy
import math
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from uqfold.evaluation.batch import RowModel
from uqfold.evaluation.outputs import STDERR, STDOUT, ExternalRunError
from uqfold.typing import FloatArray

Keep = Literal["failed", "all", "none"]

REASON = "reason.txt"
"""File in the folder of a failed run that says why."""

_PLACEHOLDER = re.compile(r"\{\{\s*(\w+)\s*(?::([^{}]*))?\}\}")
_STDERR_SHOWN = 300

_running: set[subprocess.Popen[bytes]] = set()
_running_lock = threading.Lock()


@dataclass(frozen=True)
class ExternalCode(RowModel):
    """A command line as a response model.

    Every run gets a folder of its own, in which the program is started. The templates are written
    there with each ``{{name}}`` replaced by the value of that input, in all its digits;
    ``{{name:12.5e}}`` formats it as Python does. The words of the command may hold placeholders
    too. No shell is involved.

    A run fails, and raises `ExternalRunError`, when the program cannot be started, ends with
    another exit code than 0, takes longer than `timeout`, or leaves no number to be read; NaN is
    no number, an infinity is one. During an estimate a failed run is a NaN for the policy for
    failed runs. The folder of a failed run is kept, with ``reason.txt`` in it.

    Attributes
    ----------
    command
        The program and its arguments. It is started in the run's folder, so that paths to things
        elsewhere have to be absolute.
    names
        Names of the inputs, in column order (shared inputs first).
    output
        Reads the response from the run's folder: `Regex`, `Column`, or any function of the folder.
        What the program printed is there as ``stdout.txt`` and ``stderr.txt``.
    templates
        Name of a file in the run's folder -> its template.
    timeout
        Seconds that a run may take, None for no limit. The program is then killed, with all that
        it started.
    parallel
        Runs at the same time, where no executor is given.
    folder
        Where the runs' folders are made; None: in the folder for temporary files.
    keep
        Which of these folders to keep: ``failed``, ``all`` or ``none``.

    Raises
    ------
    ValueError
        If a placeholder is no input, an input occurs nowhere, or a setting is out of range.
    OSError
        If a template cannot be read.
    """

    command: Sequence[str]
    names: Sequence[str]
    output: Callable[[Path], float]
    # what is not compared has no influence on a response, and no part in its key in a store
    templates: Mapping[str, str | PathLike[str]] = field(default_factory=dict, compare=False)
    timeout: float | None = field(default=None, compare=False)
    parallel: int = field(default=4, compare=False)
    folder: str | PathLike[str] | None = field(default=None, compare=False)
    keep: Keep = field(default="failed", compare=False)
    _texts: Mapping[str, str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if isinstance(self.command, str) or not self.command:
            raise ValueError(f"command = {self.command!r}: give a list of words, as in ['a', '-b']")
        if self.timeout is not None and not 0.0 < self.timeout < math.inf:
            raise ValueError(f"timeout = {self.timeout}: give a positive number of seconds")
        if self.parallel < 1:
            raise ValueError(f"parallel = {self.parallel}: give at least 1")
        if self.keep not in get_args(Keep):
            raise ValueError(f"keep = {self.keep!r}: choose from {get_args(Keep)}")
        # read once: what happens to the file later must not mix two models
        texts = {name: Path(path).read_text() for name, path in self.templates.items()}
        object.__setattr__(self, "_texts", texts)
        used = set()
        for text in (*texts.values(), *self.command):
            used |= {match[1] for match in _PLACEHOLDER.finditer(text)}
        if unknown := used - set(self.names):
            raise ValueError(
                f"the placeholder {{{{{min(unknown)}}}}} is no input: choose from "
                f"{', '.join(self.names)}"
            )
        if missing := [name for name in self.names if name not in used]:
            raise ValueError(
                f"the input {missing[0]!r} occurs nowhere: put {{{{{missing[0]}}}}} into a "
                "template or the command"
            )

    def run(self, x: FloatArray) -> float:
        """Run the program for one sample x (d,).

        Raises
        ------
        ExternalRunError
            If the run fails.
        """
        if x.shape != (len(self.names),):
            raise ValueError(f"{x.shape[-1]} inputs for {len(self.names)} names")
        values = dict(zip(self.names, x.tolist(), strict=True))
        if self.folder is not None:
            Path(self.folder).mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self.folder)).absolute()
        failed = True
        try:
            for name, text in self._texts.items():
                target = folder / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(_filled(text, values))
            self._start([_filled(word, values) for word in self.command], folder)
            y = float(self.output(folder))
            if math.isnan(y):
                raise ExternalRunError("the output is NaN")
            failed = False
        except Exception as error:
            told = isinstance(error, ExternalRunError)
            reason = str(error) if told else f"{type(error).__name__}: {error}"
            if self.keep == "none":
                raise ExternalRunError(reason) from error
            (folder / REASON).write_text(reason + "\n")
            raise ExternalRunError(f"{reason} (see {folder})") from error
        finally:
            if self.keep == "none" or (self.keep == "failed" and not failed):
                shutil.rmtree(folder, ignore_errors=True)
        return y

    def with_time_limit(self, seconds: float) -> ExternalCode:
        """Give the same model with a timeout of at most that."""
        limited = copy.copy(self)
        timeout = seconds if self.timeout is None else min(seconds, self.timeout)
        object.__setattr__(limited, "timeout", timeout)
        return limited

    def stop(self) -> None:
        """Kill the programs that are running."""
        with _running_lock:
            for process in _running:
                _kill(process)

    def __call__(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, d), `parallel` at a time; NaN for failed runs."""
        from concurrent.futures import ThreadPoolExecutor

        def response(row: FloatArray) -> float:
            try:
                return self.run(row)
            except ExternalRunError:
                return math.nan

        with ThreadPoolExecutor(self.parallel) as pool:
            return np.array(list(pool.map(response, x)), dtype=np.float64)

    def _start(self, command: Sequence[str], folder: Path) -> None:
        with (folder / STDOUT).open("wb") as out, (folder / STDERR).open("wb") as err:
            try:
                process = subprocess.Popen(
                    command,
                    cwd=folder,
                    stdin=subprocess.DEVNULL,
                    stdout=out,
                    stderr=err,
                    # a group of its own: what the program starts is killed with it, and Ctrl-C
                    # does not reach it past the caller
                    start_new_session=os.name == "posix",
                )
            except OSError as error:
                raise ExternalRunError(f"{command[0]} cannot be started: {error}") from error
            with _running_lock:
                _running.add(process)
            try:
                code = process.wait(self.timeout)
            except subprocess.TimeoutExpired:
                raise ExternalRunError(f"it took longer than {self.timeout:g} s") from None
            finally:
                with _running_lock:
                    _running.discard(process)
                if process.poll() is None:
                    _kill(process)
                    process.wait()
        if code != 0:
            said = (folder / STDERR).read_text(errors="replace").strip()[-_STDERR_SHOWN:]
            raise ExternalRunError(f"exit code {code}" + (f": {said}" if said else ""))


def _filled(text: str, values: Mapping[str, float]) -> str:
    def value(match: re.Match[str]) -> str:
        number, spec = values[match[1]], match[2]
        # repr reads back to the same bits
        return repr(number) if spec is None else format(number, spec)

    return _PLACEHOLDER.sub(value, text)


def _kill(process: subprocess.Popen[bytes]) -> None:
    try:
        if os.name == "posix":
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    except ProcessLookupError:
        pass
