"""OpenTURNS' simulation called directly, and the same systems through uqfold's interface.

The direct runs use OpenTURNS alone: the maximum of several responses over one shared and several
individual inputs is written out as one symbolic function of all of them.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import openturns as ot

from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work

UNITS = 3
STANDARD_ERRORS = 4.0
QUESTIONS = {
    "threshold": (2.6, None, 1),
    "threshold, two missions": (2.6, None, 2),
    "threshold and tau": (2.6, 2.0, 1),
    "rare": (3.2, None, 1),
}
"""Name -> threshold, tau, missions."""


def response(x: FloatArray) -> FloatArray:
    """Response (n,) of one unit: columns are the shared and the individual input."""
    return np.asarray(0.6 * x[:, 0] + np.sqrt(x[:, 1]))


SHARED, OWN = ot.Normal(0.5, 0.4), ot.WeibullMin(2.0, 1.5, 0.0)


def direct(threshold: float, tau: float | None, missions: int, samples: int, seed: int) -> Any:
    """Simulate by OpenTURNS alone: estimate, samples, and its standard deviation."""
    names = ["v", *(f"e{i}_{k}" for k in range(missions) for i in range(UNITS))]
    margins = []
    for k in range(missions):
        times = [f"(0.6*v + sqrt(e{i}_{k}))" for i in range(UNITS)]
        largest = _nested("max", times)
        margins.append(f"({largest} - {threshold!r})")
        if tau is not None:
            margins.append(f"({largest} - {_nested('min', times)} - {tau!r})")
    function = ot.SymbolicFunction(names, [_nested("max", margins)])
    inputs = ot.JointDistribution([SHARED, *[OWN] * (UNITS * missions)])
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(function, ot.RandomVector(inputs)), ot.Greater(), 0.0
    )
    algorithm = ot.ProbabilitySimulationAlgorithm(event, ot.MonteCarloExperiment())
    algorithm.setBlockSize(1_000)
    algorithm.setMaximumOuterSampling(samples // 1_000)
    algorithm.setMaximumCoefficientOfVariation(0.0)
    ot.RandomGenerator.SetSeed(seed)
    algorithm.run()
    result = algorithm.getResult()
    return [result.getProbabilityEstimate(), result.getStandardDeviation()]


def _nested(function: str, words: list[str]) -> str:
    text = words[0]
    for word in words[1:]:
        text = f"{function}({text}, {word})"
    return text


def through_uqfold(question: str, samples: int, seed: int, fault: str | None) -> Any:
    """Give the estimate of `openturns-mc`, and its standard error."""
    threshold, tau, missions = QUESTIONS[question]
    shared, individual = {"v": SHARED}, {"e": OWN}
    problem = Problem(response, shared=shared, individual=individual, units=UNITS)
    if fault == "uncorrelated":
        problem = Problem(response, individual=shared | individual, units=UNITS)
    if fault == "one mission":
        missions = 1
    budget = samples * UNITS * missions
    method = OpenTURNSMonteCarlo(target_cov=1e-9)
    row = method.estimate(problem, Criterion(threshold, tau, missions), max_evals=budget, rng=seed)
    return [row[0].pf, row[0].std_error]


def measure(work: Work) -> Measurement:
    """Simulate 20,000, 100,000 or 2,000,000 systems on either side."""
    samples = work.pick(20_000, 100_000, 2_000_000)
    first, second = work.seeds
    found = work.parts(
        {f"{name}, direct": partial(direct, *asked, samples, first)
         for name, asked in QUESTIONS.items()}
        | {f"{name}, uqfold": partial(through_uqfold, name, samples, second, work.fault)
           for name in QUESTIONS}
    )  # fmt: skip
    rows, findings = [], []
    for name in QUESTIONS:
        (theirs, their_error), (ours, our_error) = (
            found[f"{name}, direct"],
            found[f"{name}, uqfold"],
        )
        z = (ours - theirs) / math.hypot(our_error, their_error)
        rows.append(
            {
                "question": name,
                "pf, OpenTURNS": theirs,
                "standard error, OpenTURNS": their_error,
                "pf, uqfold": ours,
                "standard error, uqfold": our_error,
                "difference (standard errors)": z,
            }
        )
        findings.append(
            Finding(f"{name}: difference", abs(z), STANDARD_ERRORS, "joint standard errors")
        )
        findings.append(
            Finding(f"{name}: ratio of standard errors, from 1", abs(our_error / their_error - 1.0),
                    0.1)
        )  # fmt: skip
    title = f"Simulation of {samples} systems by both"
    return Measurement(findings, [Table.of(title, rows)])
