"""Full-factorial products of one-dimensional quadrature rules (FFNI, Eq. 31)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from uqfold.typing import FloatArray


def tensor_grid(rules: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Product of 1-D rules: every combination of their nodes.

    Parameters
    ----------
    rules
        One pair (nodes (q_i,), weights (q_i,)) per variable.

    Returns
    -------
    points : array (n, d)
        n = q_1 q_2 ... q_d rows; the first variable changes slowest. Without rules: one empty
        row, so that a problem without shared inputs needs no special case.
    weights : array (n,)
        Products of the 1-D weights.

    Raises
    ------
    ValueError
        If a rule is not a pair of equally long, non-empty vectors.
    """
    points = np.empty((1, 0))
    weights = np.ones(1)
    for position, (nodes, rule_weights) in enumerate(rules):
        x = np.asarray(nodes, dtype=float)
        w = np.asarray(rule_weights, dtype=float)
        if x.ndim != 1 or x.shape != w.shape or x.size == 0:
            raise ValueError(
                f"rule {position} has nodes of shape {x.shape} and weights of shape {w.shape}; "
                "give two vectors of one length, at least 1"
            )
        points = np.hstack([np.repeat(points, x.size, axis=0), np.tile(x, len(points))[:, None]])
        weights = np.repeat(weights, x.size) * np.tile(w, weights.size)
    return points, weights
