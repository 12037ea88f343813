"""Cases measured side by side, in two worker processes.

Speeds are measured alone: whatever else runs would be a part of them.
"""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

from uqfold.validation.case import Case
from uqfold.validation.record import CaseRecord
from uqfold.validation.runner import Validation, unseen

WORKERS = 2
WORTH = 8
"""Cases for which starting workers pays."""
WAKE_SECONDS = 0.2
"""How often a wait for workers looks at Ctrl-C."""


def side_by_side(
    validation: Validation, cases: Sequence[Case], wake: Callable[[], None]
) -> Iterator[tuple[Case, CaseRecord]]:
    """Measure cases in worker processes, if there are enough of them.

    Speeds are left out, and whatever a worker that dies leaves undone. The full tier, which goes on
    where it was interrupted, measures one case after the other.

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
    chosen = [case for case in cases if case.declared.kind != "benchmark"]
    if validation.tier == "full" or len(chosen) < WORTH:
        return
    before = multiprocessing.active_children()
    workers = concurrent.futures.ProcessPoolExecutor(
        WORKERS,
        multiprocessing.get_context("spawn"),
        # Ctrl-C is left to the process that ends the workers
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    )
    quiet = replace(validation, progress=unseen)
    try:
        waiting = {workers.submit(quiet.run, case): case for case in chosen}
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
        for process in multiprocessing.active_children():
            if process not in before:
                process.terminate()
        # the pool's own thread takes leave of them: two that wait for one process can miss its end
        workers.shutdown(cancel_futures=True)
