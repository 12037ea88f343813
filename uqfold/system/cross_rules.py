"""Quadrature rules across lines: a ladder of ever finer ones, and products of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TypeAlias

import numpy as np

from uqfold.moments.quadrature import tensor_grid
from uqfold.typing import FloatArray

Rule: TypeAlias = tuple[FloatArray, FloatArray]
"""Nodes and weights."""

GAUSS = (1, 5, 9)
EQUAL_STEPS = (17, 33, 65, 129, 257, 513)
LADDER = (*GAUSS, *EQUAL_STEPS)
"""Sizes: first Gauss rules, then equal steps.

The sum over equal steps is spectrally accurate for smooth integrands wherever their peak lies,
also far out, where the nodes of a Gauss rule are few.
"""
SHARED_REACH = 7.5
"""Where equal steps end."""


@cache
def ladder_rule(level: int) -> Rule:
    """Rule of one rung of the ladder for the standard normal density."""
    size = LADDER[level]
    if size in GAUSS:
        return gauss_rule(size)
    nodes = np.linspace(-SHARED_REACH, SHARED_REACH, size)
    weights = np.exp(-0.5 * nodes**2)
    return nodes, weights / weights.sum()


@cache
def gauss_rule(size: int) -> Rule:
    """Gauss-Hermite rule for the standard normal density."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(size)
    return nodes, weights / weights.sum()


def product_rule(rules: Sequence[Rule]) -> Rule:
    """Product of one-dimensional rules, without the corners, which hold no probability."""
    nodes, weights = tensor_grid(rules)
    kept = weights > 1e-17 * weights.max()
    return nodes[kept], weights[kept] / weights[kept].sum()


def quasi_random_rule(dimension: int, size: int) -> Rule:
    """Standard-normal points of equal weight, from an additive sequence.

    References
    ----------
    Roberts M. The unreasonable effectiveness of quasirandom sequences (2018): the generalised
    golden ratio.
    """
    from scipy.special import ndtri

    ratio = 2.0
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (dimension + 1))
    steps = ratio ** -np.arange(1.0, dimension + 1)
    cube = (0.5 + np.outer(np.arange(1, size + 1), steps)) % 1.0
    return ndtri(np.clip(cube, 1e-12, 1.0 - 1e-12)), np.full(size, 1.0 / size)
