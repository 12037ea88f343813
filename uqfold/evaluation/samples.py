"""The samples of an estimate, kept on request: what was run, what came of it, and what for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from uqfold.typing import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    import pandas as pd

Label: TypeAlias = str | float | np.ndarray[Any, Any]
MOST_PARTS = 256
"""Parts are joined when there are more."""


class KeptSamples:
    """Runs in the order in which they were made, thinned out evenly where they are many.

    Parameters
    ----------
    most
        Runs to keep, at most. When there are more, every second one is dropped, and so on.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._every = 1
        self._seen = 0
        self._labels: dict[str, Label] = {}
        self._labelled_from = 0
        self._parts: list[pd.DataFrame] = []
        self._rows = 0

    def label(self, **labels: Label) -> None:
        """Say what the next runs are: text and numbers for all of them, an array for as many."""
        self._labels, self._labelled_from = labels, self._seen

    def add(self, x: FloatArray, y: FloatArray) -> None:
        """Add the runs X (n, d) with their responses (n,), NaN for a failed one."""
        import pandas as pd

        number = np.arange(self._seen, self._seen + len(x))
        kept = number % self._every == 0
        columns: dict[object, object] = {"run": number[kept]}
        columns |= {i: column[kept] for i, column in enumerate(x.T)}
        columns["response"] = y[kept]
        for name, label in self._labels.items():
            columns[name] = self._of_rows(label, number, kept)
        self._seen += len(x)
        self._parts.append(pd.DataFrame(columns))
        self._rows += int(kept.sum())
        while self._rows > self._most:
            self._every *= 2
            self._join()
            self._parts[0] = self._parts[0][self._parts[0]["run"] % self._every == 0]
            self._rows = len(self._parts[0])
        if len(self._parts) > MOST_PARTS:
            self._join()

    def _of_rows(self, label: Label, number: IntArray, kept: BoolArray) -> object:
        if not isinstance(label, np.ndarray):
            return label
        place = (number - self._labelled_from)[kept]
        there = place < label.size
        return np.where(there, label[np.where(there, place, 0)] if label.size else 0, np.nan)

    def _join(self) -> None:
        import pandas as pd

        self._parts = [pd.concat(self._parts, ignore_index=True)]

    def frame(self, names: list[str]) -> pd.DataFrame:
        """Return the runs as a table.

        Parameters
        ----------
        names
            What the columns of X are called.

        Returns
        -------
        pandas.DataFrame
            Columns ``run`` (its number, from 0), the inputs, ``response``, and what the method has
            said of them. ``attrs["every"]`` tells that one run in so many is there.
        """
        import pandas as pd

        if not self._parts:
            self._parts = [pd.DataFrame(columns=["run", *range(len(names)), "response"])]
        self._join()
        own = {"run", "response", *map(str, self._parts[0].columns[len(names) + 2 :])}
        called = {i: f"{name} (input)" if name in own else name for i, name in enumerate(names)}
        found = self._parts[0].rename(columns=called)
        found.attrs["every"] = self._every
        return found
