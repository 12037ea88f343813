"""Cases measured side by side, in a few worker processes.

Speeds are measured alone: whatever else runs would be a part of them.
"""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

from uqfold.validation.case import Case
from uqfold.validation.record import CaseRecord
from uqfold.validation.runner import Validation, existing_record, unseen

WORKERS = 2
WORTH = 20.0
"""Seconds of work for which starting workers pays."""
WAKE_SECONDS = 0.2
"""How often a wait for workers looks at Ctrl-C."""


def for_workers(cases: Sequence[Case], tier: str) -> list[Case]:
    """Return the cases that are worth measuring side by side, the longest first.

    How long a case takes is known from its kept record of the quick tier. The full tier, which
    goes on where it was interrupted, measures one case after the other.
    """
    if tier == "full" or (os.cpu_count() or 1) < WORKERS:
        return []
    seconds = {}
    for case in cases:
        kept = existing_record(case.kept("quick"))
        if case.declared.kind != "benchmark" and kept is not None:
            seconds[case.name] = kept.seconds
    chosen = [case for case in cases if case.name in seconds]
    if len(chosen) < WORKERS or sum(seconds.values()) < WORTH:
        return []
    return sorted(chosen, key=lambda case: -seconds[case.name])


def side_by_side(
    validation: Validation, cases: Sequence[Case], wake: Callable[[], None]
) -> Iterator[tuple[Case, CaseRecord]]:
    """Measure cases in worker processes; what a worker that dies leaves undone is left out.

    Parameters
    ----------
    validation
        How they are measured.
    cases
        In the order in which they start.
    wake
        Called several times a second; whatever it raises ends the workers.

    Yields
    ------
    tuple[Case, CaseRecord]
        Each case as soon as it is measured.
    """
    if not cases:
        return
    before = multiprocessing.active_children()
    workers = concurrent.futures.ProcessPoolExecutor(
        WORKERS, multiprocessing.get_context("spawn"), initializer=_deaf
    )
    quiet = replace(validation, progress=unseen)
    try:
        waiting = {workers.submit(quiet.run, case): case for case in cases}
        while waiting:
            done, _ = concurrent.futures.wait(
                waiting, WAKE_SECONDS, return_when=concurrent.futures.FIRST_COMPLETED
            )
            wake()
            for future in done:
                yield waiting.pop(future), future.result()
    except BrokenProcessPool:
        return
    finally:
        workers.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            if process not in before:
                process.terminate()
                process.join()


def _deaf() -> None:
    """Leave Ctrl-C to the process that ends the workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
