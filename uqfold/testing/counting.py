"""Counting rows as the evaluator counts them."""

from __future__ import annotations

from dataclasses import dataclass, field

from uqfold.evaluation.calling import MOST_COMPARED
from uqfold.typing import FloatArray


@dataclass
class RowCount:
    """Rows that a model has been run on, for models that count.

    The evaluator runs a few rows of the first call with several rows, and of calls with many more,
    again alone, to see how the model is called. These repeats do not count as evaluations.

    Attributes
    ----------
    rows
        Rows so far, repeats left out.
    """

    rows: int = 0
    _last: frozenset[bytes] = frozenset()
    _repeats: int = field(default=0)

    def add(self, x: FloatArray) -> bool:
        """Count the rows X (n, d) of one call, and return whether they are evaluations."""
        if len(x) == 1 and self._repeats < MOST_COMPARED and x.tobytes() in self._last:
            self._repeats += 1
            return False
        if len(x) > 1:
            self._last, self._repeats = frozenset(row.tobytes() for row in x), 0
        else:
            self._last = frozenset()
        self.rows += len(x)
        return True
