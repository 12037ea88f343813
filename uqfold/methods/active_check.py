"""Checks of active learning: evaluations that the surface has to foretell.

A surrogate that has missed a failure region, or trusts itself too much, gives answers that are
stable and wrong. So some runs are made that the surrogate has not been trained on, near the limits
that decide the answers, where no run has been yet, further out and all around, and it has to
foretell them within its own stated error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.methods.active_view import KindView
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.importance_cloud import WideProposal, resampled
from uqfold.typing import BoolArray, FloatArray

# A control run further from its prediction than this many stated standard deviations fails the
# check; so do all of them together when their root mean square exceeds the second number.
_FARTHEST_Z, _LARGEST_RMS = 2.5, 1.5
# Regions whose probability could reach this share of pf are worth looking into.
_SHARE = 0.02
_LOOKED_AT = 512
# A half-space beyond the outlying runs holds at most this share of the smallest pf. They contradict
# a surface that had put them on the other side of a threshold by so many standard deviations.
_BEYOND, _SURE_Z = 1e-3, 2.0
# Share of its foretold distance to a threshold within which an outlying run is much nearer to it,
# and stated errors from which that contradicts the surface.
_NEARER, _CONTRADICTED_Z = 0.5, 5.0
# The same of runs all around, where the surface is no extrapolation, and of their stated errors.
_NEARER_INSIDE, _INSIDE_Z = 0.9, 5.0


@dataclass(frozen=True, eq=False)
class Outlying:
    """Evaluations further out than the answers reach, against what the surrogate had foretold.

    Attributes
    ----------
    u, y
        Where they were made (m, d), in standard-normal space, and the responses (m,).
    mean, std
        What the surrogate had foretold, and its standard deviation (m,), noise included.
    """

    u: FloatArray
    y: FloatArray
    mean: FloatArray
    std: FloatArray

    @classmethod
    def of(cls, view: KindView, u: FloatArray, y: FloatArray) -> Outlying:
        """Keep responses y (m,) at u (m, d) beside the surrogate of a view."""
        mean, std = view.process.mean_and_std(u)
        return cls(u, y, mean, np.hypot(std, view.process.noise_std))

    def against(self, levels: FloatArray) -> BoolArray:
        """Which runs (m,) lie where the surrogate was sure that they do not, failed ones too.

        That is on the other side of one of the thresholds (L,), or on this side far nearer to it
        than the surrogate states, which then may have put its limit anywhere between. How far
        beyond a threshold a response lies does not matter to pf.
        """
        sure = np.abs(self.mean[:, None] - levels) > _SURE_Z * self.std[:, None]
        wrong = (self._wrong(levels) & sure) | self._nearer(levels, _CONTRADICTED_Z)
        return np.asarray(wrong.any(axis=1) | np.isnan(self.y))

    def missed(self, levels: FloatArray) -> BoolArray:
        """Which runs (m,) would teach where the thresholds (L,) are.

        They are against the surrogate, or lie on the other side although it was not sure, or nearer
        than it states.
        """
        wrong = self._wrong(levels) | self._nearer(levels, _FARTHEST_Z)
        return np.asarray(wrong.any(axis=1) | self.against(levels))

    def _nearer(self, levels: FloatArray, least: float) -> BoolArray:
        """Much nearer to a threshold than foretold, by at least so many stated errors."""
        surprising = np.abs(self.mean - self.y) > least * self.std
        return self._closer(levels, _NEARER) & surprising[:, None]

    def _closer(self, levels: FloatArray, share: float) -> BoolArray:
        """Nearer to a threshold than this share of the distance foretold."""
        foretold, found = self.mean[:, None] - levels, self.y[:, None] - levels
        return np.asarray(np.abs(found) < share * np.abs(foretold))

    def misled(self, levels: FloatArray, little: float) -> BoolArray:
        """Which of runs (m,) all around would teach something that changes the answers.

        They are missed by far more than stated and by more than a `little`, to the other side of
        one of the thresholds (L,) or towards it, or have failed.
        """
        missed = np.abs(self.mean - self.y) > np.maximum(_INSIDE_Z * self.std, little)
        wrong = (self._wrong(levels) | self._closer(levels, _NEARER_INSIDE)).any(axis=1)
        return np.asarray((missed & wrong) | np.isnan(self.y))

    def _wrong(self, levels: FloatArray) -> BoolArray:
        return np.asarray((self.mean[:, None] > levels) != (self.y[:, None] > levels))


@dataclass(frozen=True, eq=False)
class Check:
    """Evaluations kept out of the training set, against what the surrogate had foretold.

    Attributes
    ----------
    u
        Where they were made (m, d), in standard-normal space.
    residuals
        Response minus prediction (m,), NaN where the response is not finite.
    std
        Standard deviation (m,) that the surrogate states for it, noise included.
    passed
        Whether the surrogate's own error explains the residuals, or they are too small to matter,
        and nothing further out or all around speaks against it.
    outlying
        Runs further out, which the first check makes.
    misled
        Which of the runs (k,) all around it had foretold wrongly.
    around
        Runs all around.
    """

    u: FloatArray
    residuals: FloatArray
    std: FloatArray
    passed: bool
    outlying: Outlying
    misled: BoolArray
    around: Outlying

    @classmethod
    def of(
        cls,
        view: KindView,
        u: FloatArray,
        y: FloatArray,
        tolerance: float,
        outlying: Outlying,
        around: Outlying,
    ) -> Check:
        """Compare responses y (m,) at u (m, d) with the surrogate of a view.

        Parameters
        ----------
        view
            The surrogate of one kind of units, and how its surface moves the answers.
        u, y
            The runs.
        tolerance
            Change of a reliability index that does not matter.
        outlying
            Runs further out, none of them after the first check.
        around
            Runs all around.
        """
        levels, shift = view.answers.levels, float(view.shift.max())
        misled = around.misled(levels, tolerance / shift if shift > 0.0 else math.inf)
        mean, std = view.process.mean_and_std(u)
        std = np.hypot(std, view.process.noise_std)
        finite = np.isfinite(y)
        residuals = np.where(finite, y - mean, np.nan)
        if not finite.any():
            return cls(u, residuals, std, False, outlying, misled, around)
        z = np.abs(residuals / std)[finite]
        matters = np.abs(residuals[finite]) * shift > tolerance
        explained = z.max() <= _FARTHEST_Z and _rms(z) <= _LARGEST_RMS
        agreed = not (outlying.missed(levels).any() or misled.any())
        passed = bool(explained or not matters.any()) and agreed
        return cls(u, residuals, std, passed, outlying, misled, around)

    @property
    def overconfidence(self) -> float:
        """Root mean square of the residuals in units of their stated standard deviations."""
        z = (self.residuals / self.std)[np.isfinite(self.residuals)]
        return _rms(z) if z.size else 1.0


def error_factor(process: GaussianProcess, checks: Sequence[Check]) -> float:
    """By how many times its stated error a process misses what it has not learned, at least 1.

    That are the runs all around in its checks that had agreed with it: their root mean square, or
    half of the largest, which some fifty normal numbers would hardly make more than that.
    """
    u = [one.around.u[~one.misled] for one in checks]
    y = [one.around.y[~one.misled] for one in checks]
    if not sum(map(len, u)):
        return 1.0
    mean, std = process.mean_and_std(np.concatenate(u))
    z = np.abs(np.concatenate(y) - mean) / np.hypot(std, process.noise_std)
    z = z[np.isfinite(z)]
    return max(1.0, _rms(z), 0.5 * float(z.max())) if z.size else 1.0


def check_points(
    view: KindView, controls: int, outlying: int, around: int, rng: np.random.Generator
) -> FloatArray:
    """Choose the runs of a check: near the answers, further out (at most so many), all around."""
    return np.concatenate(
        [
            control_points(view, controls, rng),
            outlying_points(view, outlying),
            points_around(view, around, rng),
        ]
    )


def learnable(
    view: KindView,
    checks: list[Check],
    u: FloatArray,
    y: FloatArray,
    around: int,
    controls: int,
    tolerance: float,
) -> tuple[FloatArray, FloatArray]:
    """Add the check of one kind by runs (m, d), (m,); and return those that may be learned.

    The first `controls` are those near the answers, the last ones those all `around`. Those further
    out and all around that agree would teach nothing.
    """
    end = y.size - around
    further = Outlying.of(view, u[controls:end], y[controls:end])
    beside = Outlying.of(view, u[end:], y[end:])
    check = Check.of(view, u[:controls], y[:controls], tolerance, further, beside)
    checks.append(check)
    telling = [np.ones(controls, dtype=bool), further.missed(view.answers.levels), check.misled]
    kept = np.concatenate(telling)
    return u[kept], y[kept]


def control_points(view: KindView, count: int, rng: np.random.Generator) -> FloatArray:
    """Choose points (count, d) for a check.

    Two thirds are drawn near the limits, in proportion to their share in the answers; the others
    lie where no run has been yet.
    """
    far = count // 3
    # a steep part of a limit has little influence for each unit of the response, and errs by more
    uncertain = view.importance * view.process.std(view.u)
    share = view.importance / view.importance.sum() + uncertain / uncertain.sum()
    likely = rng.permutation(resampled(share, 20 * count, rng))
    # each point once, but the important ones, which come often, first
    first = np.sort(np.unique(likely, return_index=True)[1])[: count - far]
    near = view.u[likely[first]]
    known = np.concatenate([view.process.u, near])
    return np.concatenate([near, unvisited(view, known, count - near.shape[0], rng)])


def outlying_points(view: KindView, most: int) -> FloatArray:
    """Choose points (at most `most`, d) further out than the answers reach, for a check.

    One lies outwards of the most important point, the others on both sides along each input, in
    the order of their distance from all runs: steps, ends of a range and what breaks down mostly
    begin at a value of one input, which other runs need never come to.
    """
    d = view.answers.dimension
    length = _radius(view, _BEYOND)
    axes = length * np.concatenate([np.eye(d), -np.eye(d)])
    centre = view.u[int(np.argmax(view.importance))]
    onwards = centre * max(1.2, length / max(float(np.linalg.norm(centre)), 1e-3))
    distance = ((axes[:, None, :] - view.process.u[None, :, :]) ** 2).sum(axis=2).min(axis=1)
    return np.concatenate([onwards[None, :], axes[np.argsort(-distance, kind="stable")]])[:most]


def points_around(view: KindView, count: int, rng: np.random.Generator) -> FloatArray:
    """Choose points (count, d) all around for a check, evenly along each input, as a design does.

    Ridges and steps of one input are narrow only along that one: few points that lie evenly there
    meet what none of many runs at the limit would. Further out than matters there are none.
    """
    d = view.answers.dimension
    if count == 0:
        return np.empty((0, d))
    u = space_filling_design(count + 1, d, rng)[1:]
    length = np.sqrt((u**2).sum(axis=1))
    within = np.minimum(1.0, _radius(view, _SHARE) / np.maximum(length, 1e-300))
    return np.asarray(u * within[:, None])


def unvisited(
    view: KindView, known: FloatArray, count: int, rng: np.random.Generator
) -> FloatArray:
    """Choose points (count, d) far from all known ones, but not further out than matters.

    A failure region beyond the radius in use holds less than two percent of the smallest pf.
    """
    d = view.answers.dimension
    reach = _radius(view, _SHARE)
    wide = WideProposal(d).draw(np.clip(rng.random((_LOOKED_AT, d + 1)), 1e-12, 1.0 - 1e-12))
    length = np.sqrt((wide**2).sum(axis=1))
    wide *= np.minimum(1.0, reach / np.maximum(length, 1e-300))[:, None]
    chosen = np.empty((0, d))
    for _ in range(count):
        others = np.concatenate([known, chosen])
        distance = ((wide[:, None, :] - others[None, :, :]) ** 2).sum(axis=2).min(axis=1)
        chosen = np.concatenate([chosen, wide[[int(np.argmax(distance))]]])
    return chosen


def _radius(view: KindView, share: float) -> float:
    """Distance beyond which a half-space holds less than a share of the smallest pf."""
    from scipy.special import ndtri

    smallest = max(float(np.minimum(view.pf, 1.0 - view.pf).min()), 1e-9)
    return float(-ndtri(share * smallest))


def _rms(z: FloatArray) -> float:
    return math.sqrt(float(np.mean(z**2)))
