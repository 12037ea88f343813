"""The whole system as one event in standard-normal space, for simulation methods.

A system of units over m missions is one limit state of independent standard-normal variables: the
shared ones, and m times the individual ones of every unit. A binomial number of missions adds one
variable, so that the number itself is part of the sample. What "fails" means is written here once,
for every structure, as a decision and as a continuous margin of the same sign.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uqfold.checks import array, function, keep
from uqfold.checks import instance as checked
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
        lowest, highest = np.fmin.reduce(y, axis=-1), np.fmax.reduce(y, axis=-1)
        missing = np.isnan(y).any(axis=-1)
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
        """How far beyond T or tau each mission or system is: > 0 exactly where it `fails`.

        In series it is the larger of max t - T and (max t - min t) - tau; in any other structure
        t - T with the response t at which the system passes from working to failing. Its sign is
        that of the exact comparison, because the difference of two floats is zero only if they are
        equal; +inf where an infinite response or a failed run fails it, -inf where nothing can.
        """
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


def _response(y: FloatArray, units: SystemUnits, missing_fails: bool) -> FloatArray:
    """Response of a system without tau, its failed runs as units that fail, or that work."""
    return units.response(np.where(np.isnan(y), np.inf if missing_fails else -np.inf, y))


@dataclass(frozen=True)
class SystemEvent:
    """Failure of the whole system under one criterion, over independent standard-normal variables.

    Columns of u: the shared variables, then those of each unit's own inputs, mission by mission and
    unit by unit, then, for a binomial number of missions, the variable that decides how many are
    flown. The variables of one kind of units are those of its inputs, in their order.

    Attributes
    ----------
    problem
        The system.
    criterion
        What "works" means.

    Raises
    ------
    TypeError
        If they are not a Problem and a Criterion.
    ValueError
        If there is a tau and the structure is not a series.

    Examples
    --------
    >>> import numpy as np
    >>> from uqfold import Criterion
    >>> from uqfold.problems import series
    >>> problem = series()
    >>> event = SystemEvent(problem, Criterion(2.0, missions=3))
    >>> u = np.zeros((5, event.dimension))
    >>> event.margin(u, problem.model).shape
    (5,)
    """

    problem: Problem
    criterion: Criterion

    def __post_init__(self) -> None:
        keep(self, "problem", checked, Problem, "give a Problem")
        keep(self, "criterion", checked, Criterion, "give a Criterion")
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
        individual = self.criterion.max_missions * self._individual_in_mission
        return self.problem.kinds.n_shared + individual + int(self.random_missions)

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
            Gives responses (k,) of inputs X (k, d); called once, with all units of the missions
            that are flown. In a method it is ``task.session.evaluate``, which counts its rows.

        Returns
        -------
        FloatArray
            Largest margin over the missions (N,), in the unit of the response; +inf where an
            infinite response fails the system, -inf without a mission, NaN where a failed run
            leaves the outcome open.
        """
        low, high = self.margin_bounds(u, evaluate)
        return np.where((low > 0.0) | (low == high), low, np.nan)

    def margin_bounds(
        self, u: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Margins (N,) twice: failed runs as units that work (low), and as units that fail (high).

        The two agree where no run failed. Parameters as in `margin`.
        """
        function("evaluate", evaluate, "give a function of X (n, d)")
        return self.bounds_of(u, evaluate(self.rows(u)))

    def rows(self, u: FloatArray) -> FloatArray:
        """Return the inputs X (k, d) of all runs that the samples u (N, dimension) need.

        They go sample by sample, mission by mission and unit by unit, `evals` of them for each
        sample; with several kinds of units the last column says of which kind one is.
        """
        inputs = self.problem.kinds
        sample, mission = np.nonzero(self._flown(u))
        own = np.append(self._checked(u), np.zeros((len(u), 1)), axis=1)
        z = np.empty((sample.size, self.problem.n_units, inputs.dimension))
        z[:, :, : inputs.n_shared] = own[sample, None, : inputs.n_shared]
        z[:, :, inputs.n_shared :] = own[sample[:, None, None], self._columns[mission]]
        return inputs.rows(z).reshape(-1, inputs.columns)

    def bounds_of(self, u: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return `margin_bounds` of samples u from the responses y (k,) to their `rows`."""
        flown = self._flown(u)
        y = array("y", y, (int(flown.sum()) * self.problem.n_units,), finite=False)
        of_missions = y.reshape(-1, self.problem.n_units)
        bounds = []
        for missing_fails in (False, True):
            margin = np.full(flown.shape, -np.inf)
            margin[flown] = Worst.of_missions(
                of_missions, missing_fails=missing_fails, units=self.units
            ).margin(self.criterion.threshold, self.criterion.tau)
            bounds.append(margin.max(axis=1))
        return bounds[0], bounds[1]

    def _flown(self, u: FloatArray) -> BoolArray:
        """Which missions (N, missions) are flown."""
        return np.asarray(np.arange(self.criterion.max_missions) < self.missions(u)[:, None])

    @property
    def _individual_in_mission(self) -> int:
        """Variables of all units of one mission that they do not share."""
        kinds = self.problem.kinds
        if kinds.of_units is None:
            return self.problem.n_units * kinds.n_individual
        return sum(kinds.inputs[kind].n_individual for kind in kinds.of_units.tolist())

    @cached_property
    def _columns(self) -> IntArray:
        """Columns (missions, n, n_individual) of u with each unit's own variables.

        A unit with fewer of them than others is led to the column behind the last.
        """
        kinds, units = self.problem.kinds, self.problem.n_units
        of_units = np.zeros(units, dtype=np.int64) if kinds.of_units is None else kinds.of_units
        own = np.array([one.n_individual for one in kinds.inputs])[of_units, None]
        column = np.arange(kinds.n_individual)
        first = (kinds.n_shared + np.cumsum(own) - own.ravel())[:, None]
        mission = np.arange(self.criterion.max_missions)[:, None, None]
        columns = first + column + mission * self._individual_in_mission
        return np.where(column < own, columns, self.dimension)

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
        return array("u", u, ("N", self.dimension))
