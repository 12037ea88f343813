"""The part of a store that belongs to one model."""

from __future__ import annotations

import numpy as np

from uqfold.evaluation.store import Store, entry_key
from uqfold.typing import FloatArray, IntArray

SMALL_CALL = 2048
"""Blocks of up to so many rows are stored row by row, so that designs share their points."""
GRAIN = 64
"""Rows of one entry, for larger blocks."""
WORTH_A_COMMIT_SECONDS = 0.05
"""Work waiting to be written is committed once it took so long: less is quicker to repeat."""
MOST_WAITING = 8192
"""So many entries are committed whatever they took: a cheap model must not fill the memory."""


class Shelf:
    """Responses of one model in a store, in entries of a few rows of a block.

    An entry is found by its rows alone. Failed runs are kept open: a response of NaN is never
    reused, so that a run that failed for a passing reason (a licence, a full disk, a time limit)
    is made again.

    Parameters
    ----------
    store
        The store.
    identity
        What tells the model from others, as `identity.model_identity` returns it.
    row_by_row
        Whether blocks of any size are stored row by row, as for a model of one sample.
    """

    def __init__(self, store: Store, identity: bytes, *, row_by_row: bool = False) -> None:
        self._store = store
        self._identity = identity
        self._row_by_row = row_by_row
        self._waiting: dict[bytes, FloatArray] = {}
        self._waiting_seconds = 0.0
        self._held: dict[bytes, FloatArray] = {}

    def look_up(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of a block X (n, d); NaN where they are not known."""
        n, grain = x.shape[0], self._grain(x.shape[0])
        y = np.full(n, np.nan)
        entries = [slice(start, min(start + grain, n)) for start in range(0, n, grain)]
        keys = [entry_key(self._identity, x[entry]) for entry in entries]
        found = self._store.get(keys, [entry.stop - entry.start for entry in entries])
        for entry, known in zip(entries, found, strict=True):
            if known is not None:
                y[entry] = known
        return y

    def keep(
        self, x: FloatArray, y: FloatArray, rows: IntArray, seconds: float, *, hold: bool = False
    ) -> None:
        """Write those entries of a block that hold certain rows.

        Parameters
        ----------
        x, y
            The block: inputs (n, d) and responses (n,), of which NaN are left open.
        rows
            Numbers of the rows that have just been run.
        seconds
            What they cost.
        hold
            Whether they are written only if they are released.
        """
        grain = self._grain(x.shape[0])
        target = self._held if hold else self._waiting
        for start in (np.unique(rows // grain) * grain).tolist():
            entry = slice(start, start + grain)
            if not np.isnan(y[entry]).all():
                target[entry_key(self._identity, x[entry])] = y[entry].copy()
        self._waiting_seconds += seconds
        worth_it = self._waiting_seconds >= WORTH_A_COMMIT_SECONDS
        if worth_it or len(self._waiting) >= MOST_WAITING:
            self._commit()

    def release(self) -> None:
        """Let what was held be written."""
        self._waiting = {**self._held, **self._waiting}
        self._held = {}

    def flush(self) -> None:
        """Commit what is waiting, and drop what is held."""
        self._held = {}
        self._commit()

    def _commit(self) -> None:
        entries, self._waiting, self._waiting_seconds = self._waiting, {}, 0.0
        if entries:
            self._store.put(entries.items())

    def _grain(self, n: int) -> int:
        return 1 if n <= SMALL_CALL or self._row_by_row else GRAIN
