"""Searches for design points by OpenTURNS' optimisers, checked, and begun anew where they fail."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal, TypeAlias

import numpy as np

from uqfold.evaluation import BudgetExceededError
from uqfold.inputs.engine import openturns
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.methods.design_point import LOOSE_RESIDUAL, Search, Start, common_start
from uqfold.methods.design_point_check import Surroundings
from uqfold.methods.design_point_scan import unexplained
from uqfold.methods.standard_space import (
    SEARCH_RADIUS,
    Linearisation,
    NoGradientError,
    StandardSpaceResponse,
)
from uqfold.methods.task import Task
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

Algorithm: TypeAlias = Literal["AbdoRackwitz", "SQP", "Cobyla"]

APART = 0.5
"""Design points nearer to each other than this (in standard deviations) are one."""

FURTHEST_MARGIN = 1e6
"""Margins are cut here (in standard deviations), so that no optimiser meets an infinity."""


@dataclass(frozen=True, eq=False)
class Searches:
    """Searches for design points.

    Attributes
    ----------
    responses, starts
        Of each kind of units, its response and where searches for it start.
    found
        The searches by kind of units and threshold.
    n_evals_start
        Runs before them.
    """

    responses: list[StandardSpaceResponse]
    starts: list[Start]
    found: dict[tuple[int, float], Search]
    n_evals_start: int

    @property
    def refuted(self) -> str:
        """Why gradients that the models offer were not used; empty where they were."""
        return "; ".join(dict.fromkeys(one.refuted for one in self.responses if one.refuted))


@dataclass(frozen=True)
class DesignPointSearch:
    """How design points are looked for; settings as in `OpenTURNSFORM`."""

    algorithms: tuple[Algorithm, ...]
    step: float
    tolerance: float
    max_iterations: int
    starts: int

    def searched(self, task: Task) -> Searches:
        """Look for the design points of all thresholds of a task, of each kind of units.

        Parameters
        ----------
        task
            Problem, criteria and session.

        Raises
        ------
        NoGradientError
            If the response is infinite at the origin, or does not change around it.
        """
        problem, session = task.problem, task.session
        units, kinds = SystemUnits.of(problem), problem.kinds
        responses = [
            StandardSpaceResponse(
                inputs,
                session,
                self.step,
                session.remaining,
                partial(kinds.rows_of, kind),
                None if kinds.gradients[kind] is None else partial(session.gradients, kind=kind),
            )
            for kind, inputs in enumerate(kinds.inputs)
        ]
        starts = [common_start(response) for response in responses]
        n_start = session.n_evals
        asked = [c.threshold for c in task.criteria if math.isfinite(c.threshold)]
        places = [
            (kind, threshold)
            for kind, start in enumerate(starts)
            for threshold in sorted(
                set(units.thresholds(asked, kind).ravel().tolist()),
                key=lambda t: (abs(t - start.y_origin), t),
            )
        ]
        found: dict[tuple[int, float], Search] = {}
        for i, (kind, threshold) in enumerate(places):
            response = responses[kind]
            response.allowed = session.n_evals + session.remaining // (len(places) - i)
            known = starts[kind].known
            found[kind, threshold] = self._search(response, threshold, known)
        return Searches(responses, starts, found, n_start)

    def _search(
        self, response: StandardSpaceResponse, threshold: float, known: tuple[Linearisation, ...]
    ) -> Search:
        """Look for the design point of one threshold, and check that it is the nearest."""
        nearest = min(known, key=lambda one: abs(threshold - one.y))
        search = Search(threshold, [(nearest, "")])
        before = response.session.n_evals
        try:
            response.session.check_deadline()
            if math.isfinite(search.error):
                search.look_far(response)
                ahead = nearest.beta(threshold) * nearest.alpha
                from_plane = math.hypot(*ahead) <= SEARCH_RADIUS
                self._walk(response, search, ahead if from_plane else nearest.u)
                if search.error <= self.tolerance:
                    search.look_around(response, self.tolerance)
                if search.rival is not None:
                    search = self._second(response, search, search.rival)
                if search.error <= self.tolerance and search.rival is None and self.starts > 1:
                    self._check(response, search)
            if self._astray(search) and response.doubts_gradient(search.trace[-1][0].u):
                search = self._search(response, threshold, known)
                search.n_evals = response.session.n_evals - before
                return search
            if search.error > LOOSE_RESIDUAL and not search.out_of_reach:
                search.look_everywhere(response)
        except BudgetExceededError as error:
            search.cut = str(error)
        search.n_evals = response.session.n_evals - before
        return search

    def _astray(self, search: Search) -> bool:
        """Whether a search ended where a wrong gradient may have led it."""
        beta, ahead = (one.beta(search.threshold) for one in (search.best, search.start))
        strange = search.rival is not None or search.several or beta * ahead < 0.0
        return not search.out_of_reach and (search.error > self.tolerance or strange)

    def _second(self, response: StandardSpaceResponse, first: Search, point: FloatArray) -> Search:
        """Search again from a point that is beyond the limit state; keep the nearer result."""
        try:
            second = Search(first.threshold, [(response.linearise(point), "")])
        except NoGradientError:
            return first
        self._walk(response, second, point)
        beta, other = (abs(s.best.beta(first.threshold)) for s in (first, second))
        if second.error > self.tolerance or other >= beta:
            return first
        # the first point separates two valleys of the limit state, or more
        second.several = True
        second.look_around(response, self.tolerance)
        return second

    def _check(self, response: StandardSpaceResponse, search: Search) -> None:
        """Look at the curvature, and search from further points for other design points."""
        around = Surroundings(response, search)
        look = around.second_look()
        for start in around.starts(self.starts - 1):
            point = around.fails_nearby(start)
            search.several |= point is not None
            self._other(response, search, start if point is None else point)
        others = [Surroundings(response, search.at(one)) for one, _ in search.others]
        elsewhere = look.elsewhere + unexplained([around, *others])
        search.look = replace(look, elsewhere=elsewhere)

    def _other(self, response: StandardSpaceResponse, search: Search, start: FloatArray) -> None:
        """Search from another start; note the design point found if it is a new one."""
        try:
            other = Search(search.threshold, [(response.linearise(start), "")])
        except NoGradientError:
            return
        self._run(self.algorithms[0], response, other, start)
        known = [search.best.u, *(one.u for one, _ in search.others)]
        apart = min(math.dist(other.best.u, u) for u in known)
        if other.error <= self.tolerance and apart > APART:
            factor = Surroundings(response, other).second_order()
            search.others.append((other.best, factor))

    def _walk(self, response: StandardSpaceResponse, search: Search, point: FloatArray) -> None:
        """Try algorithm after algorithm from `point` until one arrives."""
        for algorithm in self.algorithms:
            if search.out_of_reach or search.error <= self.tolerance:
                break
            self._run(algorithm, response, search, point)

    def _run(
        self,
        algorithm: Algorithm,
        response: StandardSpaceResponse,
        search: Search,
        point: FloatArray,
    ) -> None:
        """Run OpenTURNS' FORM once; every gradient on its way goes into the search's trace."""
        ot = openturns()
        start = search.start
        raised: list[BaseException] = []
        deferred = DeferredInterrupt()

        def margin(u: Any) -> list[list[float]]:
            y = response.values(_somewhere(u))
            g = np.clip((search.threshold - y) / start.slope, -FURTHEST_MARGIN, FURTHEST_MARGIN)
            return [[value] for value in g.tolist()]

        def gradient(u: Any) -> list[list[float]]:
            here = response.linearise(_somewhere(u))
            search.trace.append((here, algorithm))
            return [[-value] for value in (here.gradient / start.slope).tolist()]

        noted_margin = _noting(raised, deferred, margin)
        noted_gradient = _noting(raised, deferred, gradient)
        with deferred, silent(ot):
            function = ot.Function(
                ot.PythonFunction(
                    start.u.size, 1, func_sample=noted_margin, gradient=noted_gradient
                )
            )
            differences = ot.CenteredFiniteDifferenceHessian(self.step, function.getEvaluation())
            function.setHessian(differences)
            inputs = ot.RandomVector(ot.Normal(start.u.size))
            event = ot.ThresholdEvent(ot.CompositeRandomVector(function, inputs), ot.Less(), 0.0)
            solver = getattr(ot, algorithm)()
            solver.setStartingPoint(point.tolist())
            solver.setMaximumIterationNumber(self.max_iterations)
            solver.setMaximumCallsNumber(20 * self.max_iterations)
            solver.setCheckStatus(False)
            for kind in ("Absolute", "Relative", "Residual", "Constraint"):
                getattr(solver, f"setMaximum{kind}Error")(0.5 * self.tolerance)
            form = ot.FORM(solver, event)
            # OpenTURNS rejects its own point, or passes on what the response raised: in both cases
            # the trace tells how near the search came
            with suppress(RuntimeError, TypeError, NoGradientError):
                form.run()
                # an algorithm without gradients has taken none at its point
                noted_gradient(form.getResult().getStandardSpaceDesignPoint())
        fatal = [error for error in raised if not isinstance(error, NoGradientError)]
        if fatal:
            raise fatal[0]


def _somewhere(u: Any) -> FloatArray:
    """Return where OpenTURNS looks next, unless its step from a point without slope led nowhere.

    Raises
    ------
    NoGradientError
        If a coordinate is not finite.
    """
    found = np.array(u, dtype=float)
    if not np.isfinite(found).all():
        raise NoGradientError("the search left the space of its variables")
    return found


def _noting(
    raised: list[BaseException],
    deferred: DeferredInterrupt,
    function: Callable[[Any], list[list[float]]],
) -> Callable[[Any], list[list[float]]]:
    """Keep what `function`, or Ctrl-C, raises: OpenTURNS makes a RuntimeError of its own of it."""

    def noted(u: Any) -> list[list[float]]:
        try:
            with deferred.let_in():
                return function(u)
        except BaseException as error:
            raised.append(error)
            raise

    return noted


@contextmanager
def silent(ot: Any) -> Iterator[None]:
    """Keep OpenTURNS' own warnings off the terminal: the status says what they say."""
    flags = ot.Log.Flags()
    ot.Log.Show(ot.Log.NONE)
    try:
        yield
    finally:
        ot.Log.Show(flags)
