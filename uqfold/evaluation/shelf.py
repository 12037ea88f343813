"""The part of a store that belongs to one model."""

from __future__ import annotations

import numpy as np

from uqfold.evaluation.store import Store, entry_key
from uqfold.typing import FloatArray

WORTH_A_COMMIT_SECONDS = 0.05
"""Work waiting to be written is committed once it took so long: less is quicker to repeat."""
MOST_WAITING = 8192
"""So many entries are committed whatever they took: a cheap model must not fill the memory."""


class Shelf:
    """Responses of one model in a store, in entries of a few rows.

    An entry is found by its rows alone. Failed runs are kept open: a response of NaN is never
    reused, so that a run that failed for a passing reason (a licence, a full disk, a time limit)
    is made again.
    """

    def __init__(self, store: Store, identity: bytes) -> None:
        self._store = store
        self._identity = identity
        self._waiting: list[tuple[bytes, FloatArray]] = []
        self._waiting_seconds = 0.0

    def look_up(self, x: FloatArray, grain: int) -> FloatArray:
        """Give the responses (n,) of X (n, d); NaN where they are not known.

        Parameters
        ----------
        x
            Inputs.
        grain
            Rows of one entry; the last one may have fewer.
        """
        y = np.full(x.shape[0], np.nan)
        pieces = _pieces(x.shape[0], grain)
        keys = [entry_key(self._identity, x[piece]) for piece in pieces]
        found = self._store.get(keys, [piece.stop - piece.start for piece in pieces])
        for piece, known in zip(pieces, found, strict=True):
            if known is not None:
                y[piece] = known
        return y

    def keep(self, x: FloatArray, y: FloatArray, grain: int, seconds: float) -> None:
        """Write responses, of which NaN are left open; `seconds`: what they cost."""
        for piece in _pieces(x.shape[0], grain):
            if not np.isnan(y[piece]).all():
                self._waiting.append((entry_key(self._identity, x[piece]), y[piece].copy()))
        self._waiting_seconds += seconds
        worth_it = self._waiting_seconds >= WORTH_A_COMMIT_SECONDS
        if worth_it or len(self._waiting) >= MOST_WAITING:
            self.flush()

    def flush(self) -> None:
        """Commit what is waiting."""
        entries, self._waiting, self._waiting_seconds = self._waiting, [], 0.0
        if entries:
            self._store.put(entries)


def _pieces(n: int, grain: int) -> list[slice]:
    return [slice(start, min(start + grain, n)) for start in range(0, n, grain)]
