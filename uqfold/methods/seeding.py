"""Every source of randomness is reduced to one recorded integer seed."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from uqfold.checks import whole

LARGEST_SEED = 2**128 - 1
"""As large as the entropy that NumPy itself takes from the operating system."""

RandomSource: TypeAlias = int | np.random.SeedSequence | np.random.Generator | None


def reduced_seed(rng: RandomSource) -> int:
    """Reduce a seed, seed sequence or generator to the integer seed that gets recorded.

    An integer stands for itself. A generator is advanced by one draw, so that two estimates made
    with the same generator differ. None takes fresh entropy from the operating system.

    Raises
    ------
    ValueError
        If an integer seed is negative, or above 2**128 - 1.
    TypeError
        If `rng` is none of these.
    """
    if rng is None:
        rng = np.random.SeedSequence()
    if isinstance(rng, np.random.Generator):
        return int(rng.integers(0, 2**63))
    if isinstance(rng, np.random.SeedSequence):
        return int(rng.generate_state(1, np.uint64)[0] >> np.uint64(1))
    what = "SeedSequence, a Generator or a whole number"
    return whole("rng", rng, at_least=0, at_most=LARGEST_SEED, what=what)


def block_generator(seed: int, block: int) -> np.random.Generator:
    """Return the generator of one block of random work.

    Blocks have a fixed size and their own streams, so that the answer does not depend on how the
    blocks are spread over workers or restarts.
    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(block,)))
