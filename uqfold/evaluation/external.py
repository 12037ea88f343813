"""A model that is a program: write its input, start it, read its output.

Most engineers' models look like that: a solver with an input file, of which some numbers are
random.
"""

from __future__ import annotations

import copy
import math
import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from uqfold.checks import (
    choice,
    function,
    keep,
    or_none,
    path,
    raised,
    real,
    refused,
    said_by,
    several,
    text,
    whole,
)
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.outputs import response
from uqfold.evaluation.programs import Programs
from uqfold.evaluation.row_model import RowModel
from uqfold.evaluation.run_folder import REASON, last_lines
from uqfold.evaluation.templates import (
    check_placeholders,
    filled,
    input_names,
    template_texts,
    write_filled,
)
from uqfold.typing import FloatArray
from uqfold.writing import replacing

Keep = Literal["failed", "all", "none"]


@dataclass(frozen=True)
class ExternalCode(RowModel):
    """A command line as a response model.

    Every run gets a folder of its own, in which the program is started. The templates are written
    there with each ``{{name}}`` replaced by the value of that input, in all its digits;
    ``{{name:12.5e}}`` formats it as Python does. All other bytes of a template stay as they are,
    whatever its encoding (which has to hold ASCII as it is, as UTF-8 and Latin-1 do) and its line
    ends. The words of the command may hold placeholders too. No shell is involved.

    A run fails, and raises `ExternalRunError`, when the program cannot be started, ends with
    another exit code than 0, takes longer than `timeout`, or leaves no number to be read; NaN is
    not a number, an infinity is one. During an estimate a failed run is a NaN for the policy for
    failed runs. The folder of a failed run is kept, with ``reason.txt`` in it.

    No process that a run has started outlives it: not after a time-out, nor when the caller is
    interrupted or killed. Linux and macOS see to that by a guard process (`guard`); on Windows
    only the program itself is ended.

    Attributes
    ----------
    command
        The program and its arguments. It is started in the run's folder, so that paths to things
        elsewhere have to be absolute.
    names
        Names of the inputs, in column order (shared inputs first): letters, digits, underscores.
    output
        Reads the response from the run's folder: `Regex`, `Column`, or any function of the folder
        that returns a number, or its text. What the program printed is there as ``stdout.txt``
        and ``stderr.txt``.
    templates
        File in the run's folder -> its template. The file is a relative path that stays there.
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
    TypeError, ValueError
        If a placeholder is not an input, an input occurs nowhere or twice, a file does not stay in
        the run's folder, or a setting is out of range.
    OSError
        If a template cannot be read.
    """

    command: Sequence[str]
    names: Sequence[str]
    output: Callable[[Path], float | str]
    # what is not compared has no influence on a response, and no part in its key in a store
    templates: Mapping[str, str | PathLike[str]] = field(default_factory=dict, compare=False)
    timeout: float | None = field(default=None, compare=False)
    parallel: int = field(default=4, compare=False)
    folder: str | PathLike[str] | None = field(default=None, compare=False)
    keep: Keep = field(default="failed", compare=False)
    _texts: Mapping[str, str] = field(init=False, repr=False)
    _programs: Programs = field(default_factory=Programs, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if isinstance(self.command, str | bytes):
            raise refused("command", self.command, "give a list of words, as in ['a', '-b']")
        keep(self, "command", several, _word)
        if not self.command or not self.command[0]:
            raise refused("command", self.command, "give a list of words, as in ['a', '-b']")
        keep(self, "names", input_names)
        keep(self, "output", function, "give Regex(...), Column(...) or a function of the folder")
        keep(self, "timeout", or_none, real, above=0.0, what="number of seconds")
        keep(self, "parallel", whole, at_least=1)
        keep(self, "folder", or_none, path)
        keep(self, "keep", choice, get_args(Keep))
        # read once: what happens to the file later must not mix two models
        object.__setattr__(self, "_texts", template_texts("templates", self.templates))
        check_placeholders([*self._texts.values(), *self.command], self.names)

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
        failed = False
        try:
            write_filled(folder, self._texts, values)
            command = [filled(word, values) for word in self.command]
            self._programs.run(command, folder, self.timeout)
            return response(self.output(folder))
        except Exception as error:
            failed = True
            told = isinstance(error, ExternalRunError)
            reason = said_by(error) if told else raised(error)
            if printed := last_lines(folder):
                reason += f"; it printed last: {printed}"
            if self.keep == "none":
                raise ExternalRunError(reason) from error
            with replacing(folder / REASON) as stream:
                stream.write(reason.encode("utf-8", "replace") + b"\n")
            raise ExternalRunError(f"{reason} (see {folder})") from error
        finally:
            if self.keep == "none" or (self.keep == "failed" and not failed):
                shutil.rmtree(folder, ignore_errors=True)

    def with_time_limit(self, seconds: float) -> ExternalCode:
        """Return the same model with a timeout of at most that."""
        limited = copy.copy(self)
        timeout = seconds if self.timeout is None else min(seconds, self.timeout)
        object.__setattr__(limited, "timeout", timeout)
        return limited

    def stop(self) -> bool:
        """Kill the programs that are running."""
        self._programs.end()
        return True

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of X (n, d), `parallel` at a time; NaN for failed runs."""
        from concurrent.futures import ThreadPoolExecutor, wait

        def answer(row: FloatArray) -> float:
            try:
                return self.run(row)
            except ExternalRunError:
                return math.nan

        with ThreadPoolExecutor(self.parallel) as pool:
            runs = [pool.submit(answer, row) for row in x]
            try:
                return np.array([run.result() for run in runs], dtype=np.float64)
            finally:
                # after Ctrl-C nobody waits for the others
                pool.shutdown(wait=False, cancel_futures=True)
                while left := [run for run in runs if not run.done()]:
                    self.stop()
                    wait(left, 0.02)


def _word(name: str, value: object) -> str:
    if value == "" and isinstance(value, str):
        return ""
    word = text(name, value, what="a word")
    if "\0" in word:
        raise refused(name, word, "give a word without NUL")
    return word
