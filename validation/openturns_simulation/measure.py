"""OpenTURNS' simulation called directly, and the same systems through uqfold's interface.

The direct runs use OpenTURNS alone: the maximum of several responses over one shared and several
individual inputs is written out as one symbolic function of all of them.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial, reduce

import numpy as np
import openturns as ot
import pandas as pd

from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import Reference
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import answers

UNITS = 3
STANDARD_ERRORS = 4.0
RATIO = 0.1
"""Largest relative difference of the standard errors."""
QUESTIONS = {
    "threshold": Criterion(2.6),
    "threshold, two missions": Criterion(2.6, None, 2),
    "threshold and tau": Criterion(2.6, 2.0),
    "rare": Criterion(3.2),
}
SHARED, OWN = ot.Normal(0.5, 0.4), ot.WeibullMin(2.0, 1.5, 0.0)


def response(x: FloatArray) -> FloatArray:
    """Response (n,) of one unit: columns are the shared and the individual input."""
    return np.asarray(0.6 * x[:, 0] + np.sqrt(x[:, 1]))


def direct(criterion: Criterion, missions: int, samples: int, seed: int) -> Reference:
    """Simulate by OpenTURNS alone: its estimate, with its standard deviation."""

    def nested(function: str, words: list[str]) -> str:
        return reduce(lambda text, word: f"{function}({text}, {word})", words)

    names = ["v", *(f"e{i}_{k}" for k in range(missions) for i in range(UNITS))]
    margins = []
    for k in range(missions):
        times = [f"(0.6*v + sqrt(e{i}_{k}))" for i in range(UNITS)]
        largest = nested("max", times)
        margins.append(f"({largest} - {criterion.threshold!r})")
        if criterion.tau is not None:
            margins.append(f"({largest} - {nested('min', times)} - {criterion.tau!r})")
    function = ot.SymbolicFunction(names, [nested("max", margins)])
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
    return Reference(criterion, result.getProbabilityEstimate(), result.getStandardDeviation())


def compare(question: str, samples: int, seeds: tuple[int, ...], fault: str | None) -> pd.DataFrame:
    """Ask `openturns-mc`, with what OpenTURNS alone gives as the reference."""
    criterion = QUESTIONS[question]
    missions = criterion.missions
    assert isinstance(missions, int)
    known = direct(criterion, missions, samples, seeds[0])
    shared, individual = {"v": SHARED}, {"e": OWN}
    problem = Problem(response, shared=shared, individual=individual, units=UNITS)
    if fault == "uncorrelated":
        problem = Problem(response, individual=shared | individual, units=UNITS)
    if fault == "one mission":
        missions = 1
        known = replace(known, criterion=replace(criterion, missions=1))
    budget = samples * UNITS * missions
    method = OpenTURNSMonteCarlo(target_cov=1e-9)
    return answers(method, problem, [known], max_evals=budget, seed=seeds[1])


def measure(work: Work) -> Measurement:
    """Simulate 20,000, 100,000 or 2,000,000 systems on either side."""
    samples = work.pick(20_000, 100_000, 2_000_000)
    found = work.parts(
        {name: partial(compare, name, samples, work.seeds, work.fault) for name in QUESTIONS}
    )
    findings = []
    for name, rows in found.items():
        z, ratio = rows["z"].iloc[0], (rows["std_error"] / rows["known_error"]).iloc[0]
        findings += [
            Finding(f"{name}: difference", abs(z), STANDARD_ERRORS, "joint standard errors"),
            Finding(f"{name}: ratio of standard errors, from 1", abs(ratio - 1.0), RATIO),
        ]
    columns = {
        "question": "question", "known": "pf, OpenTURNS",
        "known_error": "standard error, OpenTURNS", "pf": "pf, uqfold",
        "std_error": "standard error, uqfold", "z": "difference (standard errors)",
    }  # fmt: skip
    rows = pd.concat(found, names=["question"]).reset_index("question")
    table = Table.of(
        f"Simulation of {samples} systems by both", rows[[*columns]].rename(columns=columns)
    )
    return Measurement(findings, [table])
