"""Structures of 20 units with a common cause: uqfold beside OpenTURNS and closed forms.

    python validation/benchmarks/structures.py    # some minutes; the table of docs/structures.md

Units fail if 0.6 V + 0.8 U_i > T. Exact answers are integrals over V of what p(V) makes of the
system, by adaptive quadrature. OpenTURNS writes a system as a union of intersections and answers
by its system FORM, which is exact in principle for linear units, or by its Monte Carlo; each of its
answers may take a minute of its own process.
"""

from __future__ import annotations

import math
import multiprocessing
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.special import ndtr
from scipy.stats import binom

import uqfold
from uqfold import Criterion, CutSets, KOutOfN, Parallel, Problem, Series, Structure
from uqfold.inputs import normal
from uqfold.system.decision_diagram import diagram

SHARED, OWN = 0.6, 0.8
SECONDS = 60.0
"""What each answer of OpenTURNS may take."""
SYSTEMS = 1_000_000
LINKS = ([0, 3], [1, 4], [0, 2, 4], [1, 2, 3])
"""Path sets of a bridge of five groups."""


@dataclass(frozen=True)
class Asked:
    """One structure, its threshold, pf given p, and its cut sets where there are few."""

    name: str
    units: int
    structure: Any
    threshold: float
    failure: Callable[[float], float]
    cuts: tuple[tuple[int, ...], ...] = ()

    @property
    def exact(self) -> float:
        """Integral over the common cause."""

        def integrand(v: float) -> float:
            p = float(ndtr((SHARED * v - self.threshold) / OWN))
            return self.failure(p) * math.exp(-0.5 * v * v) / math.sqrt(2.0 * math.pi)

        return float(quad(integrand, -9.0, 9.0, epsabs=0.0, epsrel=1e-11, limit=500)[0])

    def problem(self) -> Problem:
        """Return it as a problem."""
        return Problem(
            lambda x: SHARED * x[:, 0] + OWN * x[:, 1],
            shared={"V": normal(0, 1)},
            individual={"U": normal(0, 1)},
            units=self.units,
            structure=self.structure,
        )


def structures() -> Iterator[Asked]:
    """Yield what is asked."""
    for n in (4, 8, 20):
        every = tuple((i,) for i in range(n))
        yield Asked(
            "series", n, Series(), 4.0, lambda p, n=n: -math.expm1(n * math.log1p(-p)), every
        )
        yield Asked("parallel", n, Parallel(), 1.0, lambda p, n=n: p**n, (tuple(range(n)),))
    yield Asked("2 out of 4", 4, KOutOfN(2), 2.0, lambda p: binom.sf(2, 4, p),
                tuple(combinations(range(4), 3)))  # fmt: skip
    yield Asked("2 out of 20", 20, KOutOfN(2), 1.0, lambda p: binom.sf(18, 20, p))
    groups = [range(4 * g, 4 * g + 4) for g in range(5)]
    paths = ("&".join(f"u{i}" for group in path for i in groups[group]) for path in LINKS)

    def bridge(p: float) -> float:
        fails = np.full((5, 1), -math.expm1(4 * math.log1p(-p)))
        cuts = CutSets([[0, 1], [3, 4], [0, 2, 4], [1, 2, 3]])
        return float(diagram(cuts, tuple("abcde")).probabilities(fails, 1.0 - fails)[0][0])

    yield Asked("bridge of 5 groups", 20, Structure("|".join(paths)), 3.0, bridge)


def by_openturns(units: int, threshold: float, cuts: Any, how: str) -> float:
    """Return pf by OpenTURNS; in a process of its own, which may be ended."""
    import openturns as ot

    ot.RandomGenerator.SetSeed(1)
    inputs = ot.RandomVector(ot.Normal(units + 1))
    names = [f"x{i}" for i in range(units + 1)]
    events = [
        ot.ThresholdEvent(
            ot.CompositeRandomVector(
                ot.SymbolicFunction(names, [f"{SHARED} * x0 + {OWN} * x{i + 1}"]), inputs
            ),
            ot.Greater(),
            threshold,
        )
        for i in range(units)
    ]
    both = [ot.IntersectionEvent([events[i] for i in cut]) for cut in cuts]
    event = ot.UnionEvent(both) if len(both) > 1 else both[0]
    if how == "FORM":
        solver = ot.AbdoRackwitz()
        solver.setStartingPoint([0.1] * (units + 1))
        algorithm = ot.SystemFORM(solver, event)
        algorithm.run()
        return float(algorithm.getResult().getEventProbability())
    algorithm = ot.ProbabilitySimulationAlgorithm(event, ot.MonteCarloExperiment())
    algorithm.setMaximumOuterSampling(SYSTEMS // 10_000)
    algorithm.setBlockSize(10_000)
    algorithm.setMaximumCoefficientOfVariation(-1.0)
    algorithm.run()
    return float(algorithm.getResult().getProbabilityEstimate())


def limited(function: Callable[[], float]) -> float | str:
    """Return a value, or what kept it from being known within `SECONDS`."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        try:
            return pool.apply_async(function).get(SECONDS)
        except multiprocessing.TimeoutError:
            return f"> {SECONDS:g} s"
        except Exception as error:
            return type(error).__name__


def answers(asked: Asked) -> Iterator[tuple[str, Callable[[], float | str]]]:
    """Yield every way to the answer."""
    problem, criterion = asked.problem(), Criterion(asked.threshold)
    for name, method in (
        ("`openturns-form`", uqfold.methods.OpenTURNSFORM(starts=1)),
        ("`kriging`", uqfold.methods.Kriging()),
        ("`conditional-mc`", uqfold.methods.ConditionalMonteCarlo()),
    ):
        yield name, lambda method=method: method.estimate(problem, criterion, rng=1)[0].pf
    if asked.cuts:
        for how in ("FORM", "Monte Carlo"):
            run = partial(by_openturns, asked.units, asked.threshold, asked.cuts, how)
            yield f"OpenTURNS, {how}", partial(limited, run)


def main() -> None:
    """Print the table, and what the algebra alone takes."""
    print(
        "| system | exact pf | by | error | seconds |",
        "| --- | ---: | --- | ---: | ---: |",
        sep="\n",
    )
    for asked in structures():
        exact = asked.exact
        for name, answer in answers(asked):
            begun = time.perf_counter()
            pf = answer()
            taken = f"{time.perf_counter() - begun:.2g}"
            error = pf if isinstance(pf, str) else f"{abs(pf / exact - 1.0):.1e}"
            print(f"| {asked.name}, n = {asked.units} | {exact:.4g} | {name} | {error} | {taken} |")
    names = tuple(f"u{i}" for i in range(200))
    fails = np.random.default_rng(3).random((200, 64))
    begun = time.perf_counter()
    diagram(KOutOfN(100), names).probabilities(fails, 1.0 - fails)
    print(f"\n100 out of 200 units that differ, at 64 nodes: {time.perf_counter() - begun:.2g} s")


if __name__ == "__main__":
    main()
