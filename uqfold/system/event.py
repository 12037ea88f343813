"""The whole system as one event in standard-normal space, for simulation methods.

A system of n units over m missions is one limit state of d_shared + n m d_individual independent
standard-normal variables. A binomial number of missions adds one variable, so that the number
itself is part of the sample. What "fails" means for one mission is written here once, as a
decision (`mission_fails`) and as a continuous margin (`mission_margin`) of the same sign.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Worst:
    """The worst of each mission, or of all missions of a system: it decides every T and tau.

    Attributes
    ----------
    late
        Largest response; +inf fails every criterion, -inf none.
    apart
        Largest difference of two responses of a mission; +inf where one of them is infinite, which
        fails every tau, -inf where no response is known.
    """

    late: FloatArray
    apart: FloatArray

    @classmethod
    def of_missions(
        cls, y: FloatArray, *, missing_fails: bool, units: SystemUnits | None = None
    ) -> Worst:
        """Return the worst (...) of missions with the responses y (..., n); see `mission_fails`."""
        y = y if units is None else units.shifted(y)
        if units is not None and units.diagram is not None:
            late = _response(y, units, missing_fails)
            return cls(late, np.full_like(late, -np.inf))
        lowest, highest, missing = _extremes(y)
        with np.errstate(invalid="ignore", over="ignore"):
            # the difference of finite responses may overflow
            apart = np.minimum(highest - lowest, np.finfo(np.float64).max)
        apart = np.where(np.isinf(lowest) | np.isinf(highest), np.inf, apart)
        # NaN is left where every run of the mission failed
        late, apart = (np.where(np.isnan(one), -np.inf, one) for one in (highest, apart))
        return cls(np.where(missing, np.inf, late) if missing_fails else late, apart)

    def fails(self, threshold: float, tau: float | None) -> BoolArray:
        """Whether each mission or system fails under T and tau."""
        fails = (self.late > threshold) | (self.late == np.inf)
        if tau is not None:
            fails |= (self.apart > tau) | (self.apart == np.inf)
        return np.asarray(fails)

    def margin(self, threshold: float, tau: float | None) -> FloatArray:
        """How far beyond T or tau each mission or system is: > 0 exactly where it `fails`."""
        with np.errstate(invalid="ignore", over="ignore"):
            margin = np.where(np.isinf(self.late), self.late, self.late - threshold)
            if tau is not None:
                apart = np.where(np.isinf(self.apart), self.apart, self.apart - tau)
                margin = np.maximum(margin, apart)
        return margin


def mission_fails(
    y: FloatArray,
    threshold: float,
    tau: float | None,
    *,
    missing_fails: bool,
    units: SystemUnits | None = None,
) -> BoolArray:
    """Whether each mission of a system fails; in series Eqs. (22) and (37).

    A unit works when its response is at most T, and what that means for the system its structure
    says. In series a mission works when every response is at most T and, under a synchronization
    threshold, the largest and the smallest lie at most tau apart; equality works. A response of
    +inf always fails, whatever T is; under tau any infinite response fails (inf - inf is not
    agreement).

    Parameters
    ----------
    y
        Responses (..., n) of the n units of each mission; NaN marks a failed run.
    threshold
        T, in the unit of the response; +-inf are allowed.
    tau
        Synchronization threshold in the same unit, or None; for units in series only.
    missing_fails
        Whether a failed run counts as a unit that fails; otherwise as one that works, so that a
        series is judged by its other units alone, and works if there are none.
    units
        The units and their structure; None: in series.

    Returns
    -------
    BoolArray
        Shape (...).
    """
    return Worst.of_missions(y, missing_fails=missing_fails, units=units).fails(threshold, tau)


def mission_margin(
    y: FloatArray,
    threshold: float,
    tau: float | None,
    *,
    missing_fails: bool,
    units: SystemUnits | None = None,
) -> FloatArray:
    """Continuous margin of each mission: > 0 exactly where `mission_fails`.

    In series the margin is the larger of max t - T and (max t - min t) - tau; in any other
    structure t - T with the response t at which the system passes from working to failing. Its
    sign is that of the exact comparison, because the difference of two floats is zero only if
    they are equal.

    Parameters
    ----------
    y, threshold, tau, missing_fails, units
        As in `mission_fails`.

    Returns
    -------
    FloatArray
        Shape (...), in the unit of the response; +inf where an infinite response or a failed run
        fails the mission, -inf where nothing can fail it.
    """
    y = y if units is None else units.shifted(y)
    if units is not None and units.diagram is not None:
        late = _response(y, units, missing_fails)
        with np.errstate(invalid="ignore", over="ignore"):
            return np.where(np.isinf(late), late, late - threshold)
    lowest, highest, missing = _extremes(y)
    with np.errstate(invalid="ignore", over="ignore"):
        margin = np.where(np.isinf(highest), highest, highest - threshold)
        if tau is not None and tau < math.inf:
            margin = np.fmax(margin, (highest - lowest) - tau)
    if tau is not None:
        margin = np.where(np.isinf(lowest), np.inf, margin)
    # NaN is left only where every run of the mission failed
    margin = np.where(np.isnan(margin), -np.inf, margin)
    return np.where(missing, np.inf, margin) if missing_fails else margin


def _response(y: FloatArray, units: SystemUnits, missing_fails: bool) -> FloatArray:
    """Response of a system without tau, its failed runs as units that fail, or that work."""
    return units.response(np.where(np.isnan(y), np.inf if missing_fails else -np.inf, y))


def _extremes(y: FloatArray) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Smallest and largest response of each mission among the runs that did not fail."""
    return (
        np.asarray(np.fmin.reduce(y, axis=-1)),
        np.asarray(np.fmax.reduce(y, axis=-1)),
        np.asarray(np.isnan(y).any(axis=-1)),
    )


@dataclass(frozen=True)
class SystemEvent:
    """Failure of the whole system under one criterion, over independent standard-normal variables.

    Columns of u: the shared variables, then the individual ones mission by mission and unit by
    unit, then, for a binomial number of missions, the variable that decides how many are flown.

    Attributes
    ----------
    problem
        The system.
    criterion
        What "works" means.

    Raises
    ------
    ValueError
        If there is a tau and the structure is not a series.
    """

    problem: Problem
    criterion: Criterion

    def __post_init__(self) -> None:
        if self.criterion.tau is not None and self.units.diagram is not None:
            raise ValueError(f"{self.problem!r} has no system event under tau: give Series()")

    @cached_property
    def units(self) -> SystemUnits:
        """The units and their structure."""
        return SystemUnits.of(self.problem)

    @property
    def random_missions(self) -> bool:
        """Whether the number of missions is random."""
        return isinstance(self.criterion.missions, Binomial)

    @property
    def dimension(self) -> int:
        """Number of standard-normal variables."""
        kinds = self.problem.kinds
        individual = self.criterion.max_missions * self.problem.n_units * kinds.n_individual
        return kinds.n_shared + individual + int(self.random_missions)

    @property
    def max_evals_per_sample(self) -> int:
        """Most evaluations that one sample can cost: n for each mission that can occur."""
        return self.problem.n_units * self.criterion.max_missions

    def missions(self, u: FloatArray) -> IntArray:
        """Count the missions (N,) that each sample u (N, dimension) flies."""
        u = self._checked(u)
        if not self.random_missions:
            return np.full(u.shape[0], self.criterion.max_missions, dtype=np.int64)
        return np.searchsorted(self._mission_bounds, u[:, -1], side="left").astype(np.int64)

    def evals(self, u: FloatArray) -> IntArray:
        """Count the evaluations (N,) that `margin` spends on each sample u (N, dimension)."""
        return self.problem.n_units * self.missions(u)

    def margin(self, u: FloatArray, evaluate: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Continuous margin of each sample: > 0 exactly when the system fails.

        Parameters
        ----------
        u
            Standard-normal variables (N, dimension).
        evaluate
            Gives responses (k,) of inputs X (k, d); called once, with the missions that are flown.

        Returns
        -------
        FloatArray
            Largest margin over the missions (N,), in the unit of the response; -inf without a
            mission, NaN where a failed run leaves the outcome open.
        """
        low, high = self.margin_bounds(u, evaluate)
        return np.where((low > 0.0) | (low == high), low, np.nan)

    def margin_bounds(
        self, u: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Margins (N,) twice: failed runs ignored (low), and failed runs failing (high).

        The two agree where no run failed. Parameters as in `margin`.
        """
        count = self.missions(u)
        flown = np.arange(self.criterion.max_missions) < count[:, None]
        y = evaluate(self._inputs(u, flown)).reshape(-1, self.problem.n_units)
        bounds = []
        for missing_fails in (False, True):
            margin = np.full(flown.shape, -np.inf)
            margin[flown] = mission_margin(
                y,
                self.criterion.threshold,
                self.criterion.tau,
                missing_fails=missing_fails,
                units=self.units,
            )
            bounds.append(margin.max(axis=1))
        return bounds[0], bounds[1]

    def _inputs(self, u: FloatArray, flown: BoolArray) -> FloatArray:
        """Return the inputs X (k n, d) of the k missions that are flown, sample by sample."""
        inputs, units = self.problem.kinds, self.problem.n_units
        sample, mission = np.nonzero(flown)
        end = inputs.n_shared + flown.shape[1] * units * inputs.n_individual
        individual = u[:, inputs.n_shared : end].reshape(*flown.shape, units, inputs.n_individual)
        z = np.empty((sample.size, units, inputs.dimension))
        z[:, :, : inputs.n_shared] = u[sample, None, : inputs.n_shared]
        z[:, :, inputs.n_shared :] = individual[sample, mission]
        return inputs.rows(z).reshape(-1, inputs.columns)

    @cached_property
    def _mission_bounds(self) -> FloatArray:
        """Standard-normal quantiles (planned,) at which the binomial number of missions steps up.

        A bound in the upper half comes from the upper tail, where 1 - F would lose its digits.
        """
        from scipy.special import bdtr, bdtrc, ndtri

        missions = self.criterion.missions
        if not isinstance(missions, Binomial):
            raise TypeError(f"{missions} missions are not random")
        k = np.arange(missions.planned)
        below = bdtr(k, missions.planned, missions.p)
        above = bdtrc(k, missions.planned, missions.p)
        return np.asarray(np.where(below < above, ndtri(below), -ndtri(above)))

    def _checked(self, u: FloatArray) -> FloatArray:
        if u.ndim != 2 or u.shape[1] != self.dimension:
            raise ValueError(f"u has shape {u.shape}, expected (N, {self.dimension})")
        return u
