"""A surface fitted to the runs of one kind of units, and what is known of its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from uqfold.methods.design_runs import DesignRuns
from uqfold.surrogates.common_powers import with_common_powers
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.selection import MANY_INPUTS
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray, IntArray

DRAWS = 20
"""Surfaces drawn from a posterior to tell its spread."""
PARTS = 10
"""Parts of the runs that are left out in turn to tell what the answers hang on."""


class ResponseSurface(Protocol):
    """A fitted surface over standard-normal space."""

    def mean(self, u: FloatArray) -> FloatArray:
        """Best values (m,) at u (m, d)."""
        ...

    def sample_paths(self, rng: np.random.Generator, count: int) -> Surface:
        """Draw `count` plausible surfaces, as one function of u (m, d) with values (count, m)."""
        ...

    def leave_one_out(self) -> LeaveOneOut:
        """Return the residuals of cross-validation."""
        ...

    def without(self, groups: Sequence[IntArray]) -> Surface:
        """Return the surfaces, one for each group of runs, that the others alone would give."""
        ...


@dataclass(frozen=True, eq=False)
class Rival:
    """Another surface that the same runs allow.

    Attributes
    ----------
    mean
        Its values (m,) at u (m, d).
    share
        How much of the distance between its answers and those of the chosen surface counts as an
        error of the latter.
    """

    mean: Surface
    share: float

    @classmethod
    def by_prediction(cls, best: ResponseSurface, other: ResponseSurface) -> Rival:
        """A rival whose distance counts the less, the worse it predicts left-out runs."""
        own, others = best.leave_one_out().rms, other.leave_one_out().rms
        return cls(other.mean, min(1.0, own / others) if others > 0.0 else 1.0)


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Runs that a surface was not fitted to, against what it had foretold.

    Attributes
    ----------
    foretold
        Predictions (K,).
    errors
        Response minus prediction, and the standard deviation that the surface states for it.
    """

    foretold: FloatArray
    errors: LeaveOneOut


@dataclass(frozen=True, eq=False)
class FittedKind:
    """What is known of one kind of units.

    Attributes
    ----------
    surface
        Fitted to the finite responses of `runs`.
    runs
        The runs.
    noise
        Standard deviation of what the model does beside the surface, unit by unit.
    rivals
        Other surfaces that the runs allow; the distance of their answers is a part of the stated
        error.
    """

    surface: ResponseSurface
    runs: DesignRuns
    noise: float = 0.0
    rivals: Sequence[Rival] = ()

    @property
    def known(self) -> FloatArray:
        """The finite responses."""
        return self.runs.y[self.runs.finite]

    @property
    def validated(self) -> LeaveOneOut:
        """Residuals of cross-validation."""
        return self.surface.leave_one_out()

    def parts_left_out(self) -> Surface:
        """Return the surfaces (PARTS, m) of all runs but a tenth of them, one for each tenth."""
        count = self.known.size
        return self.surface.without([np.arange(first, count, PARTS) for first in range(PARTS)])

    def held_out(self, u: FloatArray, y: FloatArray, rng: np.random.Generator) -> HeldOut:
        """Compare further runs with what draws from the posterior, rivals and noise allow.

        Parameters
        ----------
        u, y
            Points (K, d), and finite responses (K,).
        rng
            Source of the draws.
        """
        foretold = self.surface.mean(u)
        variance = self.surface.sample_paths(rng, DRAWS)(u).var(axis=0, ddof=1) + self.noise**2
        if self.rivals:
            apart = [rival.share * (rival.mean(u) - foretold) for rival in self.rivals]
            variance += np.mean(np.square(apart), axis=0)
        return HeldOut(foretold, LeaveOneOut(y - foretold, np.sqrt(variance)))

    def with_common_powers(self) -> FittedKind:
        """Return the same with one more rival where there are many inputs."""
        if self.runs.u.shape[1] < MANY_INPUTS:
            return self
        fitted = self.runs.u[self.runs.finite], self.known
        common = with_common_powers(self.surface.mean, *fitted, self.validated.residuals)
        return replace(self, rivals=[*self.rivals, Rival(common, share=1.0)])
