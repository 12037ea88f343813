"""Progress as lines of JSON, for programs that watch a run."""

from __future__ import annotations

import json
import time
from typing import Any, Self, TextIO

from uqfold.evaluation import RunningEstimate

EVERY_SECONDS = 1.0


class ProgressLines:
    """Writes one JSON object per line as each method starts, then at most every second.

    Its fields: ``method``, ``n_evals``, ``expected`` (null: not known), ``seconds`` since the
    method started, ``evals_per_second``; from methods that have a running estimate also
    ``criterion``, ``pf``, ``ci_low`` and ``ci_high``.

    Used as `uqfold.report.progress.ComparisonProgressBar` is.

    Parameters
    ----------
    stream
        Where to write.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._started = self._written = 0.0
        self._line: dict[str, Any] = {}
        self._told = True

    def __enter__(self) -> Self:
        """Return the lines themselves."""
        return self

    def __exit__(self, *error: object) -> None:
        """Write the last report."""
        self._write()

    def watch(self, estimate: RunningEstimate) -> None:
        """Take the running estimate of the method that runs."""
        named = "criterion", "pf", "ci_low", "ci_high"
        self._line |= {name: getattr(estimate, name) for name in named}

    def __call__(self, label: str, n_evals: int, expected: int | None) -> None:
        """Take one report of the comparison; zero runs mean that the method starts."""
        now = time.monotonic()
        if n_evals == 0 or label != self._line.get("method"):
            self._write()
            self._line, self._started = {}, now
        seconds = now - self._started
        rate = round(n_evals / seconds, 1) if n_evals and seconds > 0.0 else 0.0
        self._line |= {
            "method": label,
            "n_evals": n_evals,
            "expected": expected,
            "seconds": round(seconds, 3),
            "evals_per_second": rate,
        }
        self._told = False
        if n_evals == 0 or now - self._written >= EVERY_SECONDS:
            self._write()

    def _write(self) -> None:
        if not self._told:
            self._stream.write(json.dumps(self._line) + "\n")
            self._stream.flush()
            self._written, self._told = time.monotonic(), True
