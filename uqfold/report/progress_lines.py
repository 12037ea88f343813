"""Progress as lines of JSON, for programs that watch a run."""

from __future__ import annotations

import json
import time
from types import TracebackType
from typing import TextIO

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
        self._label = ""
        self._started = self._written = 0.0
        self._latest: tuple[int, int | None] | None = None
        self._estimate: RunningEstimate | None = None

    def __enter__(self) -> ProgressLines:
        """Give itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Write the last report."""
        self._write()

    def watch(self, estimate: RunningEstimate) -> None:
        """Take the running estimate of the method that runs."""
        self._estimate = estimate

    def __call__(self, label: str, n_evals: int, expected: int | None) -> None:
        """Take one report of the comparison; zero runs mean that the method starts."""
        now = time.monotonic()
        if n_evals == 0 or label != self._label:
            self._write()
            self._label, self._started, self._estimate = label, now, None
        self._latest = n_evals, expected
        if n_evals == 0 or now - self._written >= EVERY_SECONDS:
            self._write()

    def _write(self) -> None:
        if self._latest is None:
            return
        self._written = time.monotonic()
        seconds = self._written - self._started
        (n_evals, expected), self._latest = self._latest, None
        line = {
            "method": self._label,
            "n_evals": n_evals,
            "expected": expected,
            "seconds": round(seconds, 3),
            "evals_per_second": round(n_evals / seconds, 1) if n_evals and seconds > 0.0 else 0.0,
        }
        if self._estimate is not None:
            line |= {
                "criterion": self._estimate.criterion,
                "pf": self._estimate.pf,
                "ci_low": self._estimate.ci_low,
                "ci_high": self._estimate.ci_high,
            }
        self._stream.write(json.dumps(line) + "\n")
        self._stream.flush()
