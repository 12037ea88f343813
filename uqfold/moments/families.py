"""The conditional distributions that FFNI chooses among, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

from uqfold.moments.conditional import AtomicDistribution, ConditionalDistribution
from uqfold.moments.cubic_normal import cornish_fisher, cubic_normal
from uqfold.moments.cumulants import ResponseMoments
from uqfold.moments.generating import Cumulants
from uqfold.moments.maximum_entropy import maximum_entropy
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution

Fit: TypeAlias = Callable[[ResponseMoments], ConditionalDistribution | None]
"""Builds a distribution from the moments of a response, or has none with these."""


@dataclass(frozen=True)
class Family:
    """A way from the moments of a response to its distribution.

    Attributes
    ----------
    title
        What it is called in a sentence.
    fit
        Builds it.
    dense
        Whether it has a density to integrate, as a synchronization threshold needs.
    moments
        How many moments it uses; 0 for a response known to degree two.
    """

    title: str
    fit: Fit
    dense: bool = True
    moments: int = 4

    def always(self) -> Family:
        """Return the family with Pearson's distribution where it has none."""
        own = self.fit

        def fit(known: ResponseMoments) -> ConditionalDistribution:
            return own(known) or PearsonDistribution.from_moments(*known.four)

        return replace(self, fit=fit)

    def stands_in(self, distribution: ConditionalDistribution | None) -> bool:
        """Whether a distribution of `always` is Pearson's in the place of an own one."""
        if self.title == FAMILIES["pearson"].title:
            return False
        if isinstance(distribution, AtomicDistribution):
            return len(distribution.values) > 1
        return isinstance(distribution, PearsonDistribution)


def _six_cumulants(known: ResponseMoments) -> ConditionalDistribution:
    return SaddlepointDistribution(*known.four, Cumulants(known.higher_cumulants))


def _quadratic(known: ResponseMoments) -> ConditionalDistribution | None:
    if known.quadratic is None and known.std > 0.0:
        return None
    return SaddlepointDistribution(*known.four, known.quadratic)


FAMILIES = {
    "saddlepoint": Family(
        "the saddlepoint approximation",
        lambda known: SaddlepointDistribution(*known.four),
        dense=False,
    ),
    "saddlepoint-6": Family(
        "the saddlepoint approximation with six cumulants", _six_cumulants, dense=False, moments=6
    ),
    "saddlepoint-quadratic": Family(
        "the saddlepoint approximation of a response of degree two",
        _quadratic,
        dense=False,
        moments=0,
    ),
    "pearson": Family(
        "the Pearson distribution", lambda known: PearsonDistribution.from_moments(*known.four)
    ),
    "normal": Family(
        "the normal distribution",
        lambda known: NormalDistribution.from_moments(known.mean, known.std),
        moments=2,
    ),
    "maximum-entropy": Family("the distribution of largest entropy", maximum_entropy, moments=6),
    "cornish-fisher": Family(
        "the expansion of Cornish and Fisher", lambda known: cornish_fisher(*known.four)
    ),
    "cubic-normal": Family(
        "the cubic normal distribution", lambda known: cubic_normal(*known.four)
    ),
}
"""Name of a setting -> what it stands for."""
