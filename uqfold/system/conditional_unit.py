"""One unit's response as a mixture over conditional responses.

Given the shared inputs a unit follows one conditional response; if units were independent, each
would follow the marginal H-bar = E_v H, the mixture of all of them. Both are the same algebra.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.conditional import (
    AtCoordinate,
    ConditionalDistribution,
    IntegrableDistribution,
    integrable,
)
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.typing import BoolArray, FloatArray

Component: TypeAlias = tuple[float, IntegrableDistribution]
"""Weight and distribution."""

# A mixture of many components starts from about this many panels; adaptivity adds the rest.
_MOST_BREAKPOINTS = 400
# Share of a tail below which its change over tau is integrated where f changes by less than a half.
_FEW_DIGITS = 1e-3
_SMOOTH = 1.5
_LEGENDRE = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True)
class Measure:
    """Part of the unit's continuous probability that is integrated in one coordinate.

    Attributes
    ----------
    parts
        Components of one coordinate, with their weights: any number with bounded density, or a
        single other one.
    others
        The unit's remaining components, with theirs.
    """

    parts: Sequence[Component]
    others: Sequence[Component]

    @cached_property
    def breakpoints(self) -> FloatArray:
        """Panel edges in the coordinate of `at`."""
        points = np.unique(np.concatenate([part.breakpoints for _, part in self.parts]))
        if points.size <= _MOST_BREAKPOINTS:
            return points
        step = -(-points.size // _MOST_BREAKPOINTS)
        return np.unique(np.concatenate([points[::step], points[-1:]]))

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Integration coordinate of the response y."""
        return self.parts[0][1].coordinate(y)

    def at(self, x: FloatArray) -> AtCoordinate:
        """Response, density of this part, and tails of the whole unit at coordinates x."""
        share, part = self.parts[0]
        y, density, cdf, sf = part.at_coordinate(x)
        density, cdf, sf = share * density, share * cdf, share * sf
        for share, part in self.parts[1:]:
            density = density + share * part.pdf(y)
        for share, part in [*self.parts[1:], *self.others]:
            tails = part.tails(y)
            cdf, sf = cdf + share * tails[0], sf + share * tails[1]
        return AtCoordinate(y, density, cdf, sf)

    def spread(self, x: FloatArray, tau: float) -> Spread:
        """What the whole unit does below and within tau of the responses at coordinates x."""
        share, part = self.parts[0]
        y, density, cdf, sf = part.at_coordinate(x)
        density = share * density
        for other_share, other in self.parts[1:]:
            density = density + other_share * other.pdf(y)
        found = spread_of(part, y, tau, cdf, sf).scaled(share)
        for share, part in [*self.parts[1:], *self.others]:
            found = found.plus(spread_of(part, y, tau, *part.tails(y)).scaled(share))
        return found._replace(density=density)


class Spread(NamedTuple):
    """Probabilities around a response s, arrays of its shape.

    Attributes
    ----------
    density
        Probability per unit of the integration coordinate.
    cdf, sf
        Of a response up to s, and above s.
    below, within
        Of a response below s - tau, and from there up to s; each accurate where it is small.
    """

    density: FloatArray
    cdf: FloatArray
    sf: FloatArray
    below: FloatArray
    within: FloatArray

    def scaled(self, share: float) -> Spread:
        """Multiply by the share of a component."""
        return Spread(*(share * values for values in self))

    def plus(self, other: Spread) -> Spread:
        """Add another component."""
        return Spread(*(mine + others for mine, others in zip(self, other, strict=True)))


def spread_of(
    part: IntegrableDistribution, y: FloatArray, tau: float, cdf: FloatArray, sf: FloatArray
) -> Spread:
    """Probabilities of one component around responses y, where its tails are cdf and sf.

    A difference of tails keeps few digits where tau is tiny; there the density is integrated.
    """
    values, masses = part.atoms
    if values.size:
        near = np.zeros(y.shape)
        for value, mass in zip(values, masses, strict=True):
            near += np.where((value <= y) & (y - value <= tau), mass, 0.0)
        return Spread(np.zeros(y.shape), cdf, sf, np.maximum(cdf - near, 0.0), near)
    if tau == 0.0:
        return Spread(np.zeros(y.shape), cdf, sf, cdf, np.zeros(y.shape))
    earlier_cdf, earlier_sf = part.tails(y - tau)
    upper = earlier_cdf > 0.5
    within = np.maximum(np.where(upper, earlier_sf - sf, cdf - earlier_cdf), 0.0)
    few_digits = np.flatnonzero(within < _FEW_DIGITS * np.where(upper, earlier_sf, cdf))
    if few_digits.size:
        integrated, smooth = _integrated(part, y[few_digits], tau)
        within[few_digits[smooth]] = integrated[smooth]
    return Spread(np.zeros(y.shape), cdf, sf, earlier_cdf, within)


def _integrated(
    part: IntegrableDistribution, y: FloatArray, tau: float
) -> tuple[FloatArray, BoolArray]:
    """Probability of [y - tau, y] from the density, and where that hardly changes over tau."""
    low, high = part.support
    top = np.minimum(y, high)
    # tau as it is: y - tau is known to a rounding error of y only
    half = 0.5 * np.maximum(np.minimum(tau - (y - top), top - low), 0.0)
    density = np.stack([part.pdf(top + half * (node - 1.0)) for node in _LEGENDRE[0]])
    smooth = density.max(axis=0) <= _SMOOTH * density.min(axis=0)
    return np.asarray(half * (_LEGENDRE[1] @ density)), np.asarray(smooth)


class UnitResponse:
    """Mixture of conditional responses with weights that sum to 1.

    Attributes
    ----------
    p_finite, p_never, p_always, p_missing
        Total probabilities, see `ConditionalResponse`.
    """

    def __init__(self, responses: Sequence[ConditionalResponse], weights: FloatArray) -> None:
        self.p_never = float(sum(w * r.p_never for w, r in zip(weights, responses, strict=True)))
        self.p_always = float(sum(w * r.p_always for w, r in zip(weights, responses, strict=True)))
        self.p_missing = float(
            sum(w * r.p_missing for w, r in zip(weights, responses, strict=True))
        )
        finite = [
            (w * r.p_finite, r.distribution)
            for w, r in zip(weights, responses, strict=True)
            if r.distribution is not None and w * r.p_finite > 0
        ]
        self.p_finite = finite_mass = float(sum(share for share, _ in finite))
        whole = self.p_finite + self.p_never + self.p_always + self.p_missing
        # Sums of quadrature weights reach 1 only up to rounding.
        self.p_finite, self.p_never = self.p_finite / whole, self.p_never / whole
        self.p_always, self.p_missing = self.p_always / whole, self.p_missing / whole
        self._shares = [share / finite_mass for share, _ in finite]
        self._parts: list[ConditionalDistribution] = [part for _, part in finite]

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """(cdf, sf) of a finite response; (1, 0) everywhere if there is none."""
        y = np.asarray(y, dtype=float)
        if not self._parts:
            return np.ones(y.shape), np.zeros(y.shape)
        cdf, sf = np.zeros(y.shape), np.zeros(y.shape)
        for part, share in zip(self._parts, self._shares, strict=True):
            if integrable(part):
                part_cdf, part_sf = part.tails(y)
            else:
                part_cdf, part_sf = part.cdf(y), part.sf(y)
            cdf, sf = cdf + share * part_cdf, sf + share * part_sf
        return np.minimum(cdf, 1.0), np.minimum(sf, 1.0)

    @cached_property
    def _integrable(self) -> list[Component]:
        for part in self._parts:
            if not integrable(part):
                raise TypeError(
                    f"{type(part).__name__} has no density to integrate over, which a "
                    "synchronization threshold tau needs; use a Pearson or normal distribution"
                )
        parts = cast(list[IntegrableDistribution], self._parts)
        return list(zip(self._shares, parts, strict=True))

    @cached_property
    def measures(self) -> list[Measure]:
        """The continuous part, cut so that each piece has one coordinate."""
        everything = self._integrable
        continuous = [i for i, (_, part) in enumerate(everything) if part.breakpoints.size]
        smooth = [i for i in continuous if everything[i][1].bounded]
        groups = [[i] for i in continuous if not everything[i][1].bounded]
        if smooth:
            groups.append(smooth)
        return [
            Measure(
                [everything[i] for i in group],
                [component for i, component in enumerate(everything) if i not in group],
            )
            for group in groups
        ]

    @cached_property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """Values with probability > 0 and these probabilities, among finite responses."""
        values = np.concatenate([np.empty(0)] + [part.atoms[0] for _, part in self._integrable])
        masses = np.concatenate(
            [np.empty(0)] + [share * part.atoms[1] for share, part in self._integrable]
        )
        unique, inverse = np.unique(values, return_inverse=True)
        summed = np.zeros(unique.size)
        np.add.at(summed, inverse, masses)
        return unique, summed

    def spread(self, y: FloatArray, tau: float) -> Spread:
        """What a finite response does below and within tau of others y (N,)."""
        nothing = np.zeros(y.shape)
        found = Spread(nothing, nothing, nothing, nothing, nothing)
        for share, part in self._integrable:
            found = found.plus(spread_of(part, y, tau, *part.tails(y)).scaled(share))
        return found

    def around(
        self, y: FloatArray, atoms: BoolArray, tau: float
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Probability at responses y, below by more than tau, by tau or less, and above: (A,) each.

        Parameters
        ----------
        y
            Responses (A,), increasing.
        atoms
            Which of the own atoms (B,) each of them is: (A, B).
        tau
            Synchronization threshold.
        """
        values, masses = self.atoms
        # an atom that is equal to y but for rounding lies neither below nor above
        distance = np.where(atoms, 0.0, y[:, None] - values)
        mass, below, within, above = (
            some @ masses
            for some in (
                atoms,
                distance > tau,
                (distance > 0.0) & (distance <= tau),
                distance < 0.0,
            )
        )
        for share, part in self._integrable:
            if part.breakpoints.size:
                found = spread_of(part, y, tau, *part.tails(y)).scaled(share)
                below, within, above = below + found.below, within + found.within, above + found.sf
        return mass, below, within, above

    @cached_property
    def ends(self) -> FloatArray:
        """Finite ends of the components' supports, where tails have kinks."""
        ends = np.array([end for _, part in self._integrable for end in part.support])
        return np.unique(ends[np.isfinite(ends)])
