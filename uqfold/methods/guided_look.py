"""Whether a density that follows the failures of a partner has missed others of the model.

A partner that has not seen a region of failure leads nobody there. So a short climb of subset
simulation goes where the response of the model leads; in few inputs points all around are run, too.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.methods.importance_search import ImportanceSearch, part_unseen
from uqfold.methods.rare_event import Running
from uqfold.methods.subset_climb import Rung, along, piloted
from uqfold.methods.weighted_sums import doubts_of_unseen
from uqfold.typing import BoolArray, FloatArray

MOST_SEEN, RARE, UNKNOWN = 10, 30.0, 0.25
"""Up to so many variables points all around say something. Where more than a quarter of what fails
elsewhere is so many times rarer among the samples than usual, the partner leads to a part of the
failures only."""
LEVEL_PROBABILITY, CLIMB, FEWEST_OF_CLIMB, PART_OF_CLIMB = 0.1, 200, 40, 20
"""Share of the samples of a climb that leads to the next level; its samples at each: most and
fewest, else one part in so many of the runs that are left. With more than `MOST_SEEN` variables
nothing else looks elsewhere: there may be more of them, and what they may have missed is a doubt.
"""


def beside(search: ImportanceSearch) -> Running[tuple[str, list[str]]]:
    """Climb to failures of the model itself, wherever they are, and let the density follow them.

    Return why the density is none to sample from, or nothing; and doubts where the climb has not
    seen where else the model fails.
    """
    asked, rng = search.asked, search.rng
    size, alone = search.affordable // PART_OF_CLIMB, asked.event.dimension > MOST_SEEN
    size = size if alone else min(CLIMB, size)
    if size < FEWEST_OF_CLIMB:
        return "", ["the runs are too few to look for failures elsewhere"]
    pilot = yield from piloted(asked, size, LEVEL_PROBABILITY, search.affordable // 3, rng)
    assert pilot.last is not None
    fails = np.flatnonzero(asked.fail(pilot.last.high)[0])
    if not fails.size:
        return "", [f"a climb has not come to failures: {pilot.note}"]
    limit = Rung(float(asked.limits[0]), pilot.levels[-1].sigma if pilot.levels else 1.0)
    u = yield from along(asked, pilot.last, fails, limit, size, rng, len(pilot.levels))
    if search.lost(search.with_two(u)).mean() > UNKNOWN:
        return "it knows nothing of failures elsewhere", []
    search.follow(u)
    unseen = part_unseen([int(LEVEL_PROBABILITY * size)] * (len(pilot.levels) + 1))
    return "", doubts_of_unseen(unseen) if alone else []


def all_around(u: FloatArray, size: int, rng: np.random.Generator) -> FloatArray:
    """Return points (size, d) in all directions, as far out as some of the points u (n, d)."""
    directions = rng.standard_normal((size, u.shape[1]))
    far = np.linalg.norm(u[rng.integers(len(u), size=size)], axis=1)
    directions *= (far / np.linalg.norm(directions, axis=1))[:, None]
    return directions


def share_lost(log_ratio: FloatArray, fails: BoolArray, size: int) -> float:
    """Return the share of failures all around that lie where hardly a sample of the density does.

    Parameters
    ----------
    log_ratio
        Logarithm of the density (n,) over that of the inputs.
    fails
        Which points (n,) fail.
    size
        How many of them, the first ones, come from the density.
    """
    usual, around = log_ratio[:size][fails[:size]], log_ratio[size:][fails[size:]]
    if not usual.size or not around.size:
        return float(around.size > 0)
    return float(np.mean(around < np.median(usual) - math.log(RARE)))
