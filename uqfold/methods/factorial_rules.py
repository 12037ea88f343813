"""Moments of a polynomial through responses, at the nodes of a rule over the shared inputs.

The polynomial costs no runs, so that rules over it may be as fine as its degree asks: with positive
weights, so that the moments are those of a distribution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.inputs import JointInputs, normal
from uqfold.inputs.gauss import MAX_GAUSS_NODES, gauss_rule
from uqfold.methods.factorial_design import MAX_NUMBERS
from uqfold.methods.factorial_surface import FactorialSurface
from uqfold.moments.conditional import ConditionalDistribution
from uqfold.moments.cumulants import ResponseMoments, moments_from_rule
from uqfold.moments.families import Fit
from uqfold.moments.generating import QuadraticForm
from uqfold.moments.quadrature import tensor_grid
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

GaussRule: TypeAlias = tuple[FloatArray, FloatArray]

MOST_POINTS = 2_000_000
"""Values of the polynomial held at once."""
_FINE = 13
"""Nodes over an individual input that integrate fourth powers of polynomials of degree 6."""
_REACH, _FURTHER = 12.0, 0.01
"""How far equal steps go, in standard deviations, and how much further by each node more."""
_FEW_CARRY = 1.7
"""Largest weight of a rule, over that of a normal variable, from which few nodes carry it."""
_HERMITE = 7
"""Nodes over an individual input for the part of degree two."""


@dataclass(frozen=True, eq=False)
class OuterRule:
    """A rule over the shared inputs, and what the response is given each of its nodes.

    Attributes
    ----------
    places
        Nodes (K, d_shared), in the coordinates of the rule.
    weights
        Their weights (K,).
    moments
        Moments of the conditional response at each of them.
    """

    places: FloatArray
    weights: FloatArray
    moments: tuple[ResponseMoments, ...]

    def fitted(self, fit: Fit) -> list[ConditionalDistribution] | None:
        """Return a distribution at every node, or None if one node has none."""
        found = []
        for one in self.moments:
            check_time()
            found.append(fit(one))
        known = [one for one in found if one is not None]
        return known if len(known) == len(found) else None


@dataclass(frozen=True, eq=False)
class SurfaceMoments:
    """Takes moments of a polynomial.

    Attributes
    ----------
    inputs
        Inputs of the problem.
    surface
        The polynomial.
    least
        Nodes that an individual input has at least in its rule (q,).
    additive
        Whether the polynomial has no interactions of individual inputs: its cumulants are then
        sums, however many there are.
    quadratic
        Whether to find its part of degree two in standard normal inputs too.
    """

    inputs: JointInputs
    surface: FactorialSurface
    least: tuple[int, ...]
    additive: bool = False
    quadratic: bool = False

    def at(self, outer: Sequence[int], nodes: int | None = None) -> OuterRule:
        """Return the moments at the nodes of a product of Gauss rules over the shared inputs.

        Parameters
        ----------
        outer
            Nodes of each shared input; see `fine_rule`.
        nodes
            Size of the product for which memory is to be kept; None: that of `outer`.

        Raises
        ------
        ValueError
            If an individual input has no such rule, or there are too many of them for a product.
        """
        rules = [fine_rule(self.inputs, i, n) for i, n in enumerate(outer)]
        places, weights = tensor_grid(rules)
        shared = [nodes for nodes, _ in rules]
        size = weights.size if nodes is None else nodes
        moments = self._sums(shared, weights.size) if self.additive else self._product(shared, size)
        if self.quadratic and self.least:
            moments = self._with_quadratic(moments, shared)
        return OuterRule(places, weights, tuple(moments))

    def _product(self, shared: list[FloatArray], size: int) -> list[ResponseMoments]:
        """Moments by a product of rules over the individual inputs."""
        rules = self._individual(size)
        values = self.surface.on_grid([*shared, *(places for places, _ in rules)])
        rows = values.reshape(math.prod(places.size for places in shared), -1)
        found = moments_from_rule(rows, product_of_weights(rules))
        return [found.of(k) for k in range(len(found))]

    def _individual(self, size: int) -> list[GaussRule]:
        """Return rules over the individual inputs, as fine as memory and marginals allow."""

        def rules(counts: Sequence[int]) -> list[GaussRule]:
            first = self.inputs.n_shared
            return [rule_of(self.inputs, first + i, n) for i, n in enumerate(counts)]

        for n in range(_FINE, min(self.least, default=_FINE), -1):
            wanted = [max(n, count) for count in self.least]
            if size * math.prod(wanted) <= MOST_POINTS:
                try:
                    return rules(wanted)
                except ValueError:
                    continue
        if size * math.prod(self.least) > MAX_NUMBERS:
            raise ValueError(
                f"{len(self.least)} individual inputs are too many for a product of rules: give "
                "inner = DimensionReduction(variables=1)"
            )
        return rules(self.least)

    def _sums(self, shared: list[FloatArray], size: int) -> list[ResponseMoments]:
        """Moments from cumulants, which add up over independent parts."""
        n_shared, middle = len(shared), self.surface.middle
        mean = self.surface.on_grid([*shared, *middle[n_shared:, None]]).ravel()
        total = np.zeros((size, 5))
        centre = mean.copy()
        for i, least in enumerate(self.least):
            axis = n_shared + i
            places, weights = _finest(self.inputs, axis, least)
            grid = [*shared, *middle[n_shared:, None]]
            grid[axis] = places
            found = moments_from_rule(self.surface.on_grid(grid).reshape(size, -1), weights)
            mean = mean + (found.mean - centre)
            for k in range(size):
                one = found.of(k)
                powers = one.std ** np.arange(2.0, 7.0)
                total[k] += powers * np.array([1.0, *one.higher_cumulants])
        return [_from_cumulants(float(m), one) for m, one in zip(mean, total, strict=True)]

    def _with_quadratic(
        self, moments: list[ResponseMoments], shared: list[FloatArray]
    ) -> list[ResponseMoments]:
        """Add the part of degree two: the projection on Hermite polynomials."""
        q = len(self.least)
        n = _HERMITE
        while n > 3 and len(moments) * n**q > MOST_POINTS:
            n -= 1
        if len(moments) * n**q > MOST_POINTS:
            return moments
        u, weights = gauss_rule(normal(0.0, 1.0), n)
        grid = [u] * q
        if self.inputs.independent:
            grid = [column.from_normal(u) for column in self.inputs.columns[len(shared) :]]
        values = self.surface.on_grid([*shared, *grid]).reshape(len(moments), -1)
        points, product = tensor_grid([(u, weights)] * q)
        means = values @ product
        centred = (values - means[:, None]) * product
        linear = centred @ points
        # E y u_i u_j is twice the coefficient of the matrix, on the diagonal as beside it
        matrices = 0.5 * np.einsum("kp,pi,pj->kij", centred, points, points, optimize=True)
        return [
            replace(one, quadratic=QuadraticForm.of(matrix, line, one.std))
            for one, matrix, line in zip(moments, matrices, linear, strict=True)
        ]


def _from_cumulants(mean: float, cumulants: FloatArray) -> ResponseMoments:
    """Return moments from a mean and the cumulants of order two to six."""
    variance = float(cumulants[0])
    if not variance > 0.0:
        return ResponseMoments(mean, 0.0, 0.0, 3.0, 0.0, 15.0)
    std = math.sqrt(variance)
    third, fourth, fifth, sixth = (cumulants[1:] / std ** np.arange(3.0, 7.0)).tolist()
    kurtosis = fourth + 3.0
    return ResponseMoments(
        mean,
        std,
        third,
        kurtosis,
        fifth + 10.0 * third,
        sixth + 15.0 * kurtosis + 10.0 * third**2 - 30.0,
    )


def _finest(inputs: JointInputs, axis: int, least: int) -> GaussRule:
    """Return the finest rule of an input that moments of polynomials need and its marginal has."""
    for n in range(max(_FINE, least), least, -1):
        try:
            return rule_of(inputs, axis, n)
        except ValueError:
            continue
    return rule_of(inputs, axis, least)


def rules_of(inputs: JointInputs, counts: Sequence[int]) -> list[GaussRule]:
    """Return the Gauss rule of every input, in the coordinates in which the design is a product.

    These are the inputs themselves if they are independent, or else standard-normal variables.

    Raises
    ------
    ValueError
        If a marginal has no such rule.
    """
    return [rule_of(inputs, i, n) for i, n in enumerate(counts)]


def rule_of(inputs: JointInputs, i: int, n: int) -> GaussRule:
    """Return the rule of one input; see `rules_of`."""
    return inputs.gauss_rule(i, n) if inputs.independent else gauss_rule(normal(0.0, 1.0), n)


def fine_rule(inputs: JointInputs, i: int, n: int) -> GaussRule:
    """Return a rule of a shared input for a polynomial, which may be evaluated anywhere.

    It is the Gauss rule of the input, if there is one of so many nodes and the body of the input
    has its share of them. Moments of a lognormal input do not determine its distribution: its Gauss
    rules, as far as there are any, leave nearly all to a few nodes, however many there are. Then it
    is the rule of a standard normal variable, mapped to the input. Beyond `MAX_GAUSS_NODES` it is
    one of equal steps of that variable, which reaches the further the more nodes it has.
    """
    if n > MAX_GAUSS_NODES:
        reach = _REACH + _FURTHER * (n - MAX_GAUSS_NODES)
        u = np.linspace(-reach, reach, n)
        weights = np.exp(-0.5 * u**2)
        weights /= weights.sum()
    else:
        u, weights = gauss_rule(normal(0.0, 1.0), n)
        try:
            own = rule_of(inputs, i, n)
        except ValueError:
            own = None
        if own is not None and own[1].max() <= _FEW_CARRY * weights.max():
            return own
    return inputs.columns[i].from_normal(u) if inputs.independent else u, weights


def product_of_weights(rules: Sequence[GaussRule]) -> FloatArray:
    """Return the weights of a product of rules, the last one running fastest."""
    product = np.ones(1)
    for _, weights in rules:
        product = np.outer(product, weights).ravel()
    return product
