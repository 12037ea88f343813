"""How FFNI places runs over the individual inputs: products of Gauss nodes, each with a share.

Every choice is a sum of full-factorial designs, most of which leave inputs out at their mean. The
polynomials through their responses, added with these shares, stand for the response.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias

from uqfold.checks import keep, refused, whole
from uqfold.inputs.gauss import MAX_GAUSS_NODES
from uqfold.methods.factorial_design import Nodes, checked_nodes

Grids: TypeAlias = list[tuple[float, tuple[int, ...]]]
"""Shares, and nodes of each individual input; one node is the mean."""

MOST_GRIDS = 20_000


@dataclass(frozen=True)
class FullFactorial:
    """All combinations of Gauss nodes, the paper's choice: m^q runs for q inputs.

    Attributes
    ----------
    nodes
        Nodes per individual input, from 2 to 64: one number for all, or a tuple.
    """

    nodes: Nodes = 5

    def __post_init__(self) -> None:
        keep(self, "nodes", checked_nodes)

    def grids(self, q: int) -> Grids:
        """Return the one product for q inputs."""
        if not isinstance(self.nodes, int) and len(self.nodes) != q:
            raise refused("nodes", self.nodes, f"give {q} counts, one for each individual input")
        return [(1.0, (self.nodes,) * q if isinstance(self.nodes, int) else self.nodes)]


@dataclass(frozen=True)
class SparseGrid:
    """Smolyak's sum of products of rules with 1, 3, 5, ... nodes.

    Attributes
    ----------
    level
        Largest sum of the inputs' levels, where level l has 2 l + 1 nodes. Level 2 takes 5 nodes
        along each input and 3 x 3 for each pair.

    References
    ----------
    Smolyak S.A. Quadrature and interpolation formulas for tensor products of certain classes of
    functions. Soviet Mathematics Doklady 4 (1963) 240-243.
    """

    level: int = 2

    def __post_init__(self) -> None:
        keep(self, "level", whole, at_least=1, at_most=10)

    def grids(self, q: int) -> Grids:
        """Return the products of the combination technique for q inputs."""
        found = []
        for total in range(max(0, self.level - q + 1), self.level + 1):
            below = self.level - total
            share = (-1.0) ** below * math.comb(q - 1, below)
            found += [(share, tuple(2 * one + 1 for one in some)) for some in _levels(q, total)]
            _few(len(found))
        return found or [(1.0, ())]


@dataclass(frozen=True)
class DimensionReduction:
    """Sums of functions of a few inputs each, the others at their mean.

    Attributes
    ----------
    variables
        1: univariate, sums of functions of single inputs, m q + 1 runs or fewer. 2: bivariate, of
        pairs. Interactions of more inputs than that are taken for none.
    nodes
        Nodes per input, from 2 to 64.

    References
    ----------
    Rahman S., Xu H. A univariate dimension-reduction method for multi-dimensional integration in
    stochastic mechanics. Probabilistic Engineering Mechanics 19 (2004) 393-408.
    Xu H., Rahman S. A generalized dimension-reduction method for multidimensional integration in
    stochastic mechanics. International Journal for Numerical Methods in Engineering 61 (2004)
    1992-2019.
    """

    variables: int = 1
    nodes: int = 5

    def __post_init__(self) -> None:
        keep(self, "variables", whole, at_least=1, at_most=4)
        keep(self, "nodes", whole, at_least=2, at_most=MAX_GAUSS_NODES)

    def grids(self, q: int) -> Grids:
        """Return the products for q inputs: shares (-1)^i binomial(q - s + i - 1, i)."""
        most = min(self.variables, q)
        found = []
        for left_out in range(most + 1):
            share = (-1.0) ** left_out * _binomial(q - most + left_out - 1, left_out)
            if share == 0.0:
                continue
            for some in combinations(range(q), most - left_out):
                counts = tuple(self.nodes if i in some else 1 for i in range(q))
                found.append((share, counts))
                _few(len(found))
        return found


Inner: TypeAlias = FullFactorial | SparseGrid | DimensionReduction


def _binomial(n: int, k: int) -> float:
    return 1.0 if k == 0 else float(math.comb(n, k) if n >= 0 else 0)


def _levels(q: int, total: int) -> Iterator[tuple[int, ...]]:
    """Yield all tuples of q levels with a given sum."""
    if q == 0:
        return
    if q == 1:
        yield (total,)
        return
    for first in range(total, -1, -1):
        for rest in _levels(q - 1, total - first):
            yield (first, *rest)


def _few(grids: int) -> None:
    if grids > MOST_GRIDS:
        raise ValueError(
            f"more than {MOST_GRIDS} products of nodes for so many individual inputs: give a lower "
            "level, or DimensionReduction(variables=1)"
        )
