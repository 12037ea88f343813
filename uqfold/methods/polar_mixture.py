"""Densities over standard-normal space made of directions and distances, to draw rare events from.

A component draws its direction from a von Mises-Fisher law and its distance from the origin from a
Nakagami law, independent of each other. In many dimensions, where nearly all of the standard normal
law lies at about the same distance, that leaves weights finite which a shifted normal law spoils.

References
----------
Papaioannou I., Geyer S., Straub D. Improved cross entropy-based importance sampling with a
flexible mixture model. Reliability Engineering and System Safety 191 (2019) 106564.
Banerjee A., Dhillon I.S., Ghosh J., Sra S. Clustering on the unit hypersphere using von
Mises-Fisher distributions. Journal of Machine Learning Research 6 (2005) 1345-1382.
Wood A.T.A. Simulation of the von Mises Fisher distribution. Communications in Statistics -
Simulation and Computation 23 (1994) 157-164.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from uqfold.system.directions import around, far_apart, log_normaliser
from uqfold.typing import BoolArray, FloatArray

MOST_COMPONENTS = 10
EM_STEPS, SETTLED = 40, 1e-3
"""Steps at most; they end where one gains no more mean log-likelihood than this."""
FEWEST = 5
"""Points of one half at least."""
BETTER, MUCH_WORSE = 0.01, 0.25
"""One component more has to raise the mean log-likelihood of the other half by so much; where it
lowers it by so much, no more are tried."""
WIDER = 0.5
"""In few dimensions components are so much wider than what they are fitted to."""
MOST_ABOUT, WIDE, LONG = 4, 2.0, 4.0
"""Wide components: most of them, their largest concentration for each dimension, and by how many
times the variance of their distances is increased."""
MOST_ALIGNED = 0.999
"""Mean length of unit vectors at most, so that a component is never a single ray."""
ALL_AROUND = (0.55, 0.3, 0.15)
"""What is drawn everywhere: shares of the distances of the failures, of all distances that a region
of failure may have, and of the normal law."""
SHELLS, NEAREST, FARTHEST, OVERLAP = 5, 0.05, 0.05, 0.6
"""Shells of distances: how many; the probability beyond the nearest one, and, relative to pf,
beyond the farthest; and their standard deviation relative to the distance between two."""


class FitError(RuntimeError):
    """No density fits the points."""


@dataclass(frozen=True, eq=False)
class PolarMixture:
    """Mixture of K components over d >= 2 standard-normal variables.

    Attributes
    ----------
    shares
        Probabilities (K,).
    directions
        Mean directions (K, d), unit vectors.
    kappa
        Concentrations (K,) about them; zero: uniform over directions.
    shape, spread
        Nakagami parameters m and Omega (K,) of the distance; d/2 and d: standard normal.
    """

    shares: FloatArray
    directions: FloatArray
    kappa: FloatArray
    shape: FloatArray
    spread: FloatArray

    def draw(self, size: int, rng: np.random.Generator) -> FloatArray:
        """Draw points (size, d)."""
        which = rng.choice(self.shares.size, size, p=self.shares)
        distance = np.sqrt(rng.gamma(self.shape[which], self.spread[which] / self.shape[which]))
        u = np.empty((size, self.directions.shape[1]))
        for k in range(self.shares.size):
            own = np.nonzero(which == k)[0]
            u[own] = around(self.directions[k], float(self.kappa[k]), own.size, rng)
        return u * distance[:, None]

    def log_ratio(self, u: FloatArray) -> FloatArray:
        """Logarithm (n,) of density over that of the standard normal law at points u (n, d)."""
        from scipy.special import logsumexp

        return np.asarray(logsumexp(self._log_parts(u), axis=0))

    def _log_parts(self, u: FloatArray) -> FloatArray:
        """Logarithms (K, n) of share times density over that of the standard normal law."""
        from scipy.special import gammaln, xlogy

        d = u.shape[1]
        length = np.sqrt((u * u).sum(axis=1))
        aligned = self.directions @ (u / np.maximum(length, 1e-300)[:, None]).T
        m, omega, square = self.shape[:, None], self.spread[:, None], length**2
        # distances: Nakagami over chi, both without the factor 2 r
        nakagami = xlogy(m, m / omega) - gammaln(m) + xlogy(m - 1.0, square) - m * square / omega
        chi = -0.5 * d * math.log(2.0) - math.lgamma(0.5 * d)
        chi = chi + xlogy(0.5 * d - 1.0, square) - 0.5 * square
        logs = np.log(self.shares)[:, None] + nakagami - chi
        logs += log_normaliser(self.kappa, d)[:, None]
        return np.asarray(logs + self.kappa[:, None] * aligned)

    def joined(self, other: PolarMixture, share: float) -> PolarMixture:
        """Return a mixture of this one and a share of another."""
        return PolarMixture(
            np.concatenate([(1.0 - share) * self.shares, share * other.shares]),
            *(
                np.concatenate([getattr(self, name), getattr(other, name)])
                for name in ("directions", "kappa", "shape", "spread")
            ),
        )

    @classmethod
    def everywhere(cls, u: FloatArray, weights: FloatArray, pf: float) -> PolarMixture:
        """Return uniform directions with several distances, and the normal law.

        Those of points u (n, d) see what else fails as far out. Shells see regions farther out, and
        large ones nearer by, that may have some share of pf: with a probability beyond each shell
        that falls geometrically, a region at any distance is seen about as often as the best single
        distance would see it. The normal law keeps weights bounded.
        """
        d = u.shape[1]
        shape, spread = _distances((u * u).sum(axis=1), weights / weights.sum(), d)
        shells, wide = _shells(pf, d)
        shares = np.repeat(np.array(ALL_AROUND) / (1, SHELLS, 1), (1, SHELLS, 1))
        return cls(
            shares,
            np.eye(1, d).repeat(shares.size, axis=0),
            np.zeros(shares.size),
            np.concatenate([[shape], wide, [0.5 * d]]),
            np.concatenate([[spread], shells, [float(d)]]),
        )

    @classmethod
    def about(cls, u: FloatArray, weights: FloatArray, rng: np.random.Generator) -> PolarMixture:
        """Return wide components about weighted points u (n, d), however few they are."""
        d = u.shape[1]
        fitted = None
        for number in range(min(MOST_ABOUT, 1 + len(u) // FEWEST), 0, -1):
            fitted = fitted or _maximised(cls, u, weights, number, rng)
        fitted = _known(fitted)
        return replace(fitted, kappa=np.minimum(fitted.kappa, WIDE * d), shape=fitted.shape / LONG)

    @classmethod
    def fitted(
        cls, u: FloatArray, weights: FloatArray, second: BoolArray, rng: np.random.Generator
    ) -> PolarMixture:
        """Fit a mixture to weighted points, with as many components as they bear out.

        What they bear out, one half of them says of a fit to the other.

        Parameters
        ----------
        u, weights
            Points (n, d) and their weights (n,).
        second
            Which (n,) belong to the second half; no point has to do with one of the other half.
        rng
            Draws where the components begin.

        Raises
        ------
        FitError
            If the points are too few, or all alike.
        """
        halves = [second, ~second]
        if any(np.count_nonzero(half) < FEWEST for half in halves):
            raise FitError(f"{len(u)} failures are too few to fit a density to")
        best, highest = None, -math.inf
        for number in range(1, MOST_COMPONENTS + 1):
            gained = 0.0
            for half in halves:
                found = _maximised(cls, u[half], weights[half], number, rng)
                if found is None:
                    return _known(best)
                other = weights[~half] / weights[~half].sum()
                gained += 0.5 * float(other @ found.log_ratio(u[~half]))
            if gained < highest - MUCH_WORSE:
                break
            if gained > highest + BETTER:
                whole = _maximised(cls, u, weights, number, rng)
                if whole is not None:
                    best, highest = whole, gained
        return _known(best)


def _known(mixture: PolarMixture | None) -> PolarMixture:
    if mixture is None:
        raise FitError("no density fits the failures found")
    return mixture


def _maximised(
    cls: type[PolarMixture],
    u: FloatArray,
    weights: FloatArray,
    number: int,
    rng: np.random.Generator,
) -> PolarMixture | None:
    """Fit so many components by expectation and maximisation; None if one of them dies out."""
    d, weights = u.shape[1], weights / weights.sum()
    square = (u * u).sum(axis=1)
    unit = u / np.maximum(np.sqrt(square), 1e-300)[:, None]
    centres = far_apart(unit, weights, number, rng)
    near = np.eye(number)[(unit @ centres.T).argmax(axis=1)].T
    mixture, likely = None, -math.inf
    for _ in range(EM_STEPS if number > 1 else 1):
        mass = near * weights
        shares = mass.sum(axis=1)
        if np.any(shares < 1e-3):
            return None
        resultant = mass @ unit / shares[:, None]
        length = np.sqrt((resultant**2).sum(axis=1))
        directions = resultant / np.maximum(length, 1e-300)[:, None]
        length = np.minimum(length, MOST_ALIGNED)
        distances = [_distances(square, own / own.sum(), d) for own in mass]
        mixture = cls(
            shares / shares.sum(),
            directions,
            length * (d - length**2) / (1.0 - length**2) / (1.0 + WIDER / (d - 1.0)),
            np.array([shape for shape, _ in distances]),
            np.array([spread for _, spread in distances]),
        )
        logs = mixture._log_parts(u)
        largest = logs.max(axis=0)
        near = np.exp(logs - largest)
        total = near.sum(axis=0)
        near /= total
        reached = float(weights @ (largest + np.log(total)))
        if reached < likely + SETTLED:
            break
        likely = reached
    return mixture


def _shells(pf: float, d: int) -> tuple[FloatArray, FloatArray]:
    """Nakagami Omega and m of shells (SHELLS,) in d dimensions at all distances that matter."""
    from scipy.special import chdtri

    beyond = np.geomspace(NEAREST, min(FARTHEST * pf, 0.5 * NEAREST), SHELLS)
    distance = np.sqrt(chdtri(d, beyond))
    variance = (OVERLAP * (distance[-1] - distance[0]) / (SHELLS - 1)) ** 2
    spread = distance**2 + variance
    return spread, 0.25 * spread / variance


def _distances(square: FloatArray, weights: FloatArray, d: int) -> tuple[float, float]:
    """Nakagami m and Omega of squared distances (n,), by moments."""
    spread = float(weights @ square)
    variance = float(weights @ (square - spread) ** 2)
    return spread**2 / max(variance, 1e-3 * spread**2 / d), spread
