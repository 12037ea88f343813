"""A surface of a cheap partner from many of its runs, and one of what the model adds from few.

With the partner's response l(u), a factor r, and a process d(u) of its own,

    y(u) = r l(u) + d(u).

Every run of the model has one of the partner beside it, so that d is fitted to y - r l. r is the
coefficient of l as one more function of the trend of d, by generalised least squares,

    r = l' P y / l' P l,        var r = 1 / l' P l,

where P is the inverse of the covariance of d with its trend projected out. Another r would be met
by another d: it moves the surface by l minus what d's runs alone foretell of l.

References
----------
Kennedy M. C., O'Hagan A. Predicting the output from a complex computer code when fast
approximations are available. Biometrika 87 (2000) 1-13.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.typing import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class PartnerSurface:
    """The surface of a model as that of its partner and of the difference from it.

    Attributes
    ----------
    partner
        Process of the partner; its first n runs lie where those of the model do.
    difference
        Process of y - `factor` l at the n runs of the model.
    factor
        r.
    """

    partner: GaussianProcess
    difference: GaussianProcess
    factor: float

    @property
    def u(self) -> FloatArray:
        """Where the model was run (n, d)."""
        return self.difference.u

    @property
    def y(self) -> FloatArray:
        """Its responses (n,)."""
        return self.difference.y + self.factor * self._told.y

    @property
    def size(self) -> int:
        """Runs behind both processes, each of which costs a correlation at every point."""
        return self.partner.size + self.difference.size

    @property
    def noise_std(self) -> float:
        """Standard deviation of the noise, in the unit of the response."""
        return math.hypot(self.factor * self.partner.noise_std, self.difference.noise_std)

    @cached_property
    def _told(self) -> GaussianProcess:
        """What the process of the difference would make of the partner's responses."""
        return replace(self.difference, y=self.partner.y[: self.difference.size])

    @cached_property
    def _factor_std(self) -> float:
        return 1.0 / math.sqrt(self.difference.product(self._told.y, self._told.y))

    def mean(self, u: FloatArray) -> FloatArray:
        """Posterior mean (m,) at u (m, d)."""
        return self.factor * self.partner.mean(u) + self.difference.mean(u)

    def sample_paths(
        self, rng: np.random.Generator, count: int
    ) -> Callable[[FloatArray], FloatArray]:
        """Draw `count` plausible surfaces, as one function of u (m, d) with values (count, m)."""
        partners = self.partner.sample_paths(rng, count)
        differences = self.difference.sample_paths(rng, count)
        moved = self._factor_std * rng.standard_normal((count, 1))

        def paths(u: FloatArray) -> FloatArray:
            low = partners(u)
            own = self.factor * low + differences(u)
            return np.asarray(own + moved * (low - self._told.mean(u)))

        return paths

    def leave_one_out(self) -> LeaveOneOut:
        """Residuals where the run of the model and that of the partner beside it are left out."""
        n = self.difference.size
        low, own, told = (
            one.leave_one_out() for one in (self.partner, self.difference, self._told)
        )
        of_factor = self._factor_std * told.residuals
        variance = (self.factor * low.std[:n]) ** 2 + own.std**2 + of_factor**2
        return LeaveOneOut(self.factor * low.residuals[:n] + own.residuals, np.sqrt(variance))

    def without(self, groups: Sequence[IntArray]) -> Callable[[FloatArray], FloatArray]:
        """Return the surfaces that some runs of the model less would have given.

        The further runs of the partner are divided among the groups, and left out with them.
        """
        further = np.arange(self.difference.size, self.partner.size)
        both = [
            np.concatenate([some, further[place :: len(groups)]])
            for place, some in enumerate(groups)
        ]
        partners, differences = self.partner.without(both), self.difference.without(groups)
        return lambda u: np.asarray(self.factor * partners(u) + differences(u))


def factor_of(process: GaussianProcess, low: FloatArray, y: FloatArray) -> float:
    """Return r of the partner's responses (n,) in the model's (n,), for a process at these runs."""
    return process.product(low, y) / process.product(low, low)
