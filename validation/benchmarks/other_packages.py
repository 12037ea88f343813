"""Algorithms of other packages as methods, so that a benchmark runs them beside ours.

    uqfold benchmark --method auto,validation/benchmarks/other_packages.py:methods

Each gets the event in standard-normal space, and calls the model through our evaluator, which
counts its runs and keeps its budget. Settings are the packages' own defaults but for what is said
at each. UQpy is not among them: its requirements (NumPy 1.26.4) exclude those of uqfold.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from typing import Any, ClassVar, Literal

import numpy as np
import openturns as ot

from uqfold.checks import keep, whole
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.methods import Estimate, ReliabilityMethod, Solution, Task
from uqfold.methods.openturns_stream import RandomStream
from uqfold.methods.task import attempt
from uqfold.problems.criterion import Criterion
from uqfold.system import SystemEvent
from uqfold.typing import FloatArray

Margin = Callable[[FloatArray], FloatArray]
"""u (n, d) -> margin of the system (n,), which fails above zero."""
NORMAL_95 = 1.959964
LONGEST_DIRECTION = 100
"""Runs that a direction may take; fewer left end directional sampling."""


class PeerMethod(ReliabilityMethod):
    """An algorithm of another package: a subclass answers one event."""

    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[Any] = "in all"

    def _solve(self, task: Task) -> Solution:
        return Solution([attempt(partial(self._answer, task, one)) for one in task.criteria])

    def _answer(self, task: Task, criterion: Criterion) -> Estimate:
        event = SystemEvent(task.problem, criterion)
        raised: list[BaseException] = []

        def margin(u: FloatArray) -> FloatArray:
            try:
                # failed runs count as failures, since no algorithm here knows any
                return event.margin_bounds(u, task.session.evaluate)[1]
            except BaseException as error:
                raised.append(error)
                raise

        try:
            estimate = self._of_event(margin, event.dimension, task)
        except Exception:
            if not raised:
                raise
        # packages make errors of their own of what a model raises, or go on without the run
        if raised:
            raise raised[0]
        return estimate

    def _of_event(self, margin: Margin, dimension: int, task: Task) -> Estimate:
        raise NotImplementedError


def sampled(pf: float, cov: float) -> Estimate:
    """Return an estimate by simulation with the normal interval of its coefficient of variation.

    A cov beyond 10 % is the `doubtful` of our base class.
    """
    if not pf > 0.0:
        return Estimate.without_answer("failed", "no failure was found")
    low, high = pf * max(0.0, 1.0 - NORMAL_95 * cov), min(1.0, pf * (1.0 + NORMAL_95 * cov))
    return Estimate(pf, std_error=cov * pf, ci_low=low, ci_high=high, ci_kind="normal, 95 %",
                    error_kind="sampling")  # fmt: skip


def sampled_by_openturns(algorithm: Any) -> Estimate:
    """Return what a simulation of OpenTURNS that has run says."""
    result = algorithm.getResult()
    return sampled(result.getProbabilityEstimate(), result.getCoefficientOfVariation())


class OfOpenTURNS(PeerMethod):
    """An algorithm of OpenTURNS: a subclass runs it on a threshold event."""

    def _of_event(self, margin: Margin, dimension: int, task: Task) -> Estimate:
        deferred, stream = DeferredInterrupt(), RandomStream(task.seed % 2**31)

        def heights(u: Any) -> FloatArray:
            with stream.put_aside(), deferred.let_in():
                # an infinite margin would end the searches for a gradient
                return np.clip(margin(np.array(u)), -1e100, 1e100)[:, None]

        with deferred:
            function = ot.PythonFunction(dimension, 1, func_sample=heights)
            inputs = ot.RandomVector(ot.JointDistribution([ot.Normal()] * dimension))
            response = ot.CompositeRandomVector(function, inputs)
            with stream.drawn_from():
                return self._run(ot.ThresholdEvent(response, ot.Greater(), 0.0), task)

    def _run(self, event: Any, task: Task) -> Estimate:
        raise NotImplementedError


@dataclass(frozen=True)
class DesignPointOfOpenTURNS(OfOpenTURNS):
    """FORM, or SORM after Breitung, from the origin by Abdo and Rackwitz."""

    name: ClassVar[str] = "OpenTURNS design point"
    order: Literal[1, 2] = 1

    def _run(self, event: Any, task: Task) -> Estimate:
        solver, start = ot.AbdoRackwitz(), [0.0] * event.getAntecedent().getDimension()
        solver.setStartingPoint(start)
        algorithm = (ot.FORM if self.order == 1 else ot.SORM)(solver, event)
        algorithm.run()
        result = algorithm.getResult()
        if self.order == 1:
            return Estimate(result.getEventProbability())
        return Estimate(result.getEventProbabilityBreitung())


@dataclass(frozen=True)
class LevelsOfOpenTURNS(OfOpenTURNS):
    """Subset simulation, or NAIS, with so many samples a level."""

    name: ClassVar[str] = "OpenTURNS levels"
    stochastic: ClassVar[bool] = True
    nais: bool = False
    samples: int = 1_000

    def __post_init__(self) -> None:
        keep(self, "samples", whole, at_least=10)

    def _run(self, event: Any, task: Task) -> Estimate:
        algorithm = ot.NAIS(event) if self.nais else ot.SubsetSampling(event)
        algorithm.setBlockSize(100)
        algorithm.setMaximumOuterSampling(self.samples // 100)
        algorithm.run()
        return sampled_by_openturns(algorithm)


@dataclass(frozen=True)
class DirectionsOfOpenTURNS(OfOpenTURNS):
    """Directional sampling, until the budget or a coefficient of variation of 10 % is reached."""

    name: ClassVar[str] = "OpenTURNS directional"
    stochastic: ClassVar[bool] = True

    def _run(self, event: Any, task: Task) -> Estimate:
        session = task.session

        def is_spent() -> bool:
            return session.max_evals is not None and session.remaining < LONGEST_DIRECTION

        algorithm = ot.DirectionalSampling(event)
        algorithm.setMaximumOuterSampling(100_000)
        # OpenTURNS does not keep the function alive
        algorithm.setStopCallback(is_spent)
        algorithm.run()
        return sampled_by_openturns(algorithm)


@dataclass(frozen=True)
class OfPySTRA(PeerMethod):
    """Subset simulation with so many samples a level, line sampling with so many lines, or FORM."""

    name: ClassVar[str] = "PySTRA"
    stochastic: ClassVar[bool] = True
    algorithm: Literal["SubsetSimulation", "LineSampling", "Form"] = "SubsetSimulation"
    samples: int = 1_000

    def _of_event(self, margin: Margin, dimension: int, task: Task) -> Estimate:
        import pystra

        def limit_state(**u: Any) -> FloatArray:
            columns = np.column_stack([np.atleast_1d(u[f"u{i}"]) for i in range(dimension)])
            return -margin(columns.astype(float))

        model, options = pystra.StochasticModel(), pystra.AnalysisOptions()
        for i in range(dimension):
            model.addVariable(pystra.Normal(f"u{i}", 0.0, 1.0))
        options.setPrintOutput(False)
        options.setSamples(self.samples)
        before = np.random.get_state()  # noqa: NPY002
        np.random.seed(task.seed % 2**32)  # noqa: NPY002
        try:
            run = getattr(pystra, self.algorithm)(
                stochastic_model=model, limit_state=pystra.LimitState(limit_state),
                analysis_options=options,
            )  # fmt: skip
            run.run()
        finally:
            np.random.set_state(before)  # noqa: NPY002
        if self.algorithm == "Form":
            return Estimate(float(np.squeeze(run.Pf)))
        return sampled(float(run.Pf), float(run.cov))


def methods() -> dict[str, ReliabilityMethod]:
    """Return label -> method of the packages that are installed."""
    found: dict[str, ReliabilityMethod] = {
        "OpenTURNS FORM": DesignPointOfOpenTURNS(),
        "OpenTURNS SORM": DesignPointOfOpenTURNS(order=2),
        "OpenTURNS subset": LevelsOfOpenTURNS(),
        "OpenTURNS NAIS": LevelsOfOpenTURNS(nais=True),
        "OpenTURNS directional": DirectionsOfOpenTURNS(),
    }
    if find_spec("pystra") is not None:
        found |= {
            "PySTRA FORM": OfPySTRA("Form"),
            "PySTRA subset": OfPySTRA(),
            "PySTRA line": OfPySTRA("LineSampling", 100),
        }
    return found
