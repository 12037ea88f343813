"""Samples with exchanged columns, and the indices that their responses give (Saltelli et al. 2010).

References
----------
Saltelli A. et al. Variance based sensitivity analysis of model output. Design and estimator for the
total sensitivity index. Comput. Phys. Commun. 181 (2010) 259-270.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from uqfold.checks import refused, whole
from uqfold.evaluation import EvaluationSession
from uqfold.typing import FloatArray


def checked_samples(samples: int) -> int:
    """Return a power of two, at least 4.

    Raises
    ------
    ValueError, TypeError
        If it is none.
    """
    samples = whole("samples", samples, at_least=4, what="power of two")
    if samples & (samples - 1):
        raise refused("samples", samples, "give a power of two >= 4")
    return samples


def responses_with_variance(session: EvaluationSession, x: FloatArray) -> FloatArray:
    """Responses (n,) of rows X, all of them finite.

    Raises
    ------
    ValueError
        If one is infinite or a run failed.
    """
    y = session.evaluate(x)
    if not np.isfinite(y).all():
        bad = int((~np.isfinite(y)).sum())
        raise ValueError(
            f"{bad} of {y.size} responses are infinite or failed: the response has no "
            "variance to share out"
        )
    return y


def standard_pairs(
    size: int, dimension: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Two independent standard-normal samples A and B, each (size, dimension)."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    cube = qmc.Sobol(2 * dimension, rng=rng).random(size)
    both = ndtri(np.clip(cube, 1e-12, 1.0 - 1e-12))
    return both[:, :dimension], both[:, dimension:]


def frozen_rows(a: FloatArray, b: FloatArray, chosen: Sequence[tuple[int, ...]]) -> FloatArray:
    """Rows A, B, then A with each choice of columns taken from B."""
    mixed = []
    for columns in chosen:
        rows = a.copy()
        rows[:, columns] = b[:, columns]
        mixed.append(rows)
    return np.vstack([a, b, *mixed])


def saltelli(table: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Main and total index (k,) of each exchange, from responses (2 + k, n) to `frozen_rows`."""
    from scipy.stats import sobol_indices

    found = sobol_indices(
        func={"f_A": table[:1], "f_B": table[1:2], "f_AB": table[2:, None, :]}, n=table.shape[1]
    )
    return found.first_order.ravel(), found.total_order.ravel()
