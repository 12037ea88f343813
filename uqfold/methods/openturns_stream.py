"""OpenTURNS' one random generator, lent to one simulation at a time.

OpenTURNS draws from a generator that the whole program shares. Whatever runs while a simulation
waits for its model, another simulation in another thread or the model itself, would draw from the
simulation's stream, or start it anew: samples that count twice. So the generator is the
simulation's only while OpenTURNS draws.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from uqfold.inputs.engine import openturns

_LENT = threading.Lock()
"""Held while the generator is a simulation's; never while a model runs."""


class RandomStream:
    """The random stream of one simulation.

    Parameters
    ----------
    seed
        32-bit seed of OpenTURNS' generator.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._own: Any = None
        self._others: Any = None

    @contextmanager
    def drawn_from(self) -> Iterator[None]:
        """Let OpenTURNS draw from this stream; the generator is put back as it was."""
        self._take()
        try:
            yield
        finally:
            self._give_back()

    @contextmanager
    def put_aside(self) -> Iterator[None]:
        """Within `drawn_from`: let others have the generator while the model runs."""
        self._give_back()
        try:
            yield
        finally:
            self._take()

    def _take(self) -> None:
        ot = openturns()
        _LENT.acquire()
        self._others = ot.RandomGenerator.GetState()
        if self._own is None:
            ot.RandomGenerator.SetSeed(self._seed)
        else:
            ot.RandomGenerator.SetState(self._own)

    def _give_back(self) -> None:
        ot = openturns()
        self._own = ot.RandomGenerator.GetState()
        ot.RandomGenerator.SetState(self._others)
        _LENT.release()
