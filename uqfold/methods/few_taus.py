"""Errors of answers to many synchronization thresholds, from those to a few of these.

Each threshold tau has order-statistics integrals of its own, and an error takes them for thirty
surfaces, an answer for one.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

MOST_TAUS = 6
"""Synchronization thresholds for which errors are integrated."""


def by_few_taus(
    criteria: Sequence[Criterion], errors: Callable[[Sequence[Criterion]], FloatArray]
) -> FloatArray:
    """Return errors (R, C) of criteria, the larger ones of both neighbours where taus are many.

    Parameters
    ----------
    criteria
        The criteria.
    errors
        Gives R errors of each of some criteria (R, len(criteria)).
    """
    taus = sorted({one.tau for one in criteria if one.tau is not None})
    if len(taus) <= MOST_TAUS:
        return errors(criteria)
    kept = [taus[i] for i in np.linspace(0, len(taus) - 1, MOST_TAUS).round().astype(int)]
    columns: dict[Criterion, int] = {}
    neighbours = []
    for one in criteria:
        around: list[float | None] = [None]
        if one.tau is not None:
            after = bisect_left(kept, one.tau)
            around = [kept[after if kept[after] == one.tau else after - 1], kept[after]]
        alike = [replace(one, tau=tau) for tau in (around[0], around[-1])]
        neighbours.append([columns.setdefault(other, len(columns)) for other in alike])
    found = errors(list(columns))
    size = np.mean(found**2, axis=0)
    first, last = np.array(neighbours).T
    return found[:, np.where(size[first] >= size[last], first, last)]
