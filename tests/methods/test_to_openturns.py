"""Answers of simulations as OpenTURNS has those of its own."""

import math

import openturns as ot
import pytest

import uqfold
from uqfold.methods import FFNIPearson, MonteCarlo

X = ot.RandomVector(ot.Normal(2))
SUM = ot.CompositeRandomVector(ot.SymbolicFunction(["a", "b"], ["a + b"]), X)
EVENT = ot.ThresholdEvent(SUM, ot.Greater(), 2.0)


def test_it_says_what_openturns_says_of_the_same_event() -> None:
    """The runs that the error stands for are those of both, and the event is the one given."""
    problem = uqfold.Problem.from_openturns(EVENT)
    result = MonteCarlo(systems=4_000).estimate(problem, rng=1)
    (made,) = result.to_openturns(EVENT)
    ot.RandomGenerator.SetSeed(1)
    own = ot.ProbabilitySimulationAlgorithm(EVENT, ot.MonteCarloExperiment())
    own.setMaximumOuterSampling(4_000)
    own.setMaximumCoefficientOfVariation(0.0)
    own.run()
    known = own.getResult()
    assert made.getOuterSampling() * made.getBlockSize() == result.n_evals == 4_000
    assert known.getOuterSampling() * known.getBlockSize() == 4_000
    spread = math.hypot(made.getStandardDeviation(), known.getStandardDeviation())
    assert abs(made.getProbabilityEstimate() - known.getProbabilityEstimate()) < 4.0 * spread
    ratio = made.getCoefficientOfVariation() / known.getCoefficientOfVariation()
    assert ratio == pytest.approx(1.0, abs=0.2)
    assert made.getEvent().getThreshold() == 2.0
    assert made.getTimeDuration() == result.seconds
    assert made.getName() == f"mc: {result[0].status}"


def test_a_row_for_each_criterion_and_why_there_is_none() -> None:
    problem = uqfold.problems.series()
    few = MonteCarlo(systems=200).estimate(problem, uqfold.criteria([2.0, 90.0]), rng=1)
    first, last = few.to_openturns()
    assert (first.getProbabilityEstimate(), last.getProbabilityEstimate()) == (few[0].pf, 0.0)
    assert last.getStandardDeviation() == pytest.approx(few[1].ci_high / 3.92, rel=1e-3)
    assert last.getName().startswith("mc: doubtful: no failures among 200 systems")
    with pytest.raises(ValueError, match=r"row 0 of ffni-pearson .*only answers of simulations"):
        FFNIPearson(check=False).estimate(problem, 2.0).to_openturns()
    with pytest.raises(TypeError, match="event = 3: give the openturns event"):
        few.to_openturns(3)
    with pytest.raises(ValueError, match="give the openturns event that the problem was made of"):
        few.to_openturns(ot.RandomVector(SUM))
