"""Design for a target: against systems whose design values are known; no solution; verification."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from uqfold import Problem
from uqfold.analysis import (
    design_input,
    design_threshold,
    design_thresholds,
    verify,
    verify_all,
)
from uqfold.analysis.design import Scan, crossing, located
from uqfold.inputs import normal
from uqfold.methods import FFNIPearson, Kriging, MonteCarlo, PolynomialChaos
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem(units=3, shared_std=0.7)
PROFILES = [(None, 1), (None, Binomial(4, 0.3)), (4.5, 1)]
TARGET = 5e-3
SIMULATION = MonteCarlo(systems=20_000)
KRIGING = Kriging(runs=40, kernel="gaussian", trend="linear")


def exact_threshold(tau: float | None, missions: int | Binomial) -> float:
    return float(
        brentq(lambda t: SYSTEM.pf(Criterion(t, tau, missions)) - TARGET, 11.0, 16.0, xtol=1e-10)
    )


@pytest.mark.parametrize("method", [KRIGING, PolynomialChaos(runs=40)], ids=lambda m: m.name)
def test_smallest_threshold_of_a_linear_system(method: Kriging | PolynomialChaos) -> None:
    designs = design_thresholds(
        SYSTEM.problem(), TARGET, (11.0, 16.0), PROFILES, method=method, points=33, rng=1
    )
    for design, profile in zip(designs, PROFILES, strict=True):
        assert design.status == "found"
        exact = exact_threshold(*profile)
        assert design.value == pytest.approx(exact, abs=2e-3)
        assert design.low <= exact <= design.high
        assert design.high - design.low < 0.02
        assert design.safe == design.high
        assert design.n_evals == 40


def test_interval_of_a_simulated_threshold_covers() -> None:
    exact = exact_threshold(None, 1)
    inside = 0
    for seed in range(20):
        design = design_threshold(
            SYSTEM.problem(), TARGET, (11.0, 16.0), method=MonteCarlo(systems=4_000), rng=seed
        )
        assert design.low < design.value < design.high
        inside += design.low <= exact <= design.high
    # 95 % nominal: 16 or fewer of 20 has a probability of 1.6 %
    assert inside >= 17


def test_a_wrong_target_is_not_covered() -> None:
    design = design_threshold(
        SYSTEM.problem(), 2.0 * TARGET, (11.0, 16.0), method=MonteCarlo(systems=40_000), rng=0
    )
    assert not design.low <= exact_threshold(None, 1) <= design.high


@pytest.mark.parametrize(
    "method",
    [
        pytest.param(KRIGING, marks=pytest.mark.thorough),
        FFNIPearson(nodes_shared=9, check=False),
    ],
    ids=lambda m: m.name,
)
def test_smallest_mean_of_an_input(method: Kriging | FFNIPearson) -> None:
    """W lowers the response: with V, U and the criterion given, its mean is known."""

    def response(x: FloatArray) -> FloatArray:
        return 10.0 + 0.7 * x[:, 0] + 0.6 * x[:, 1] - 0.8 * x[:, 2]

    problem = replace_response(SYSTEM.problem(), response)
    criterion = Criterion(12.0, missions=2)

    def excess(mean: float) -> float:
        return replace(SYSTEM, mean=10.0 - 0.8 * mean).pf(criterion) - TARGET

    exact = float(brentq(excess, -1.0, 6.0))
    design = design_input(
        problem, criterion, TARGET, "W", (1.0, 4.0), method=method, points=9, rng=1
    )
    assert design.status == ("found" if method.name == "kriging" else "unchecked")
    assert design.value == pytest.approx(exact, abs=5e-3)
    if method.name == "kriging":
        assert design.low <= exact <= design.high
        assert design.n_evals == 40
    else:
        assert math.isnan(design.low)
        assert design.n_evals == 9 * 9 * 5**2
    other = design_input(
        problem,
        criterion,
        TARGET,
        "U",
        (-5.0, -1.0),
        method=method,
        seek="largest",
        points=9,
        rng=1,
    )
    # U raises the response, 0.6 per unit
    assert other.value == pytest.approx(-exact * 0.8 / 0.6, abs=8e-3)
    assert math.isnan(other.low) or other.safe == other.low


def test_largest_standard_deviation_of_an_input() -> None:
    criterion = Criterion(13.0)

    def excess(std: float) -> float:
        return replace(SYSTEM, individual_std=math.hypot(0.6, 0.8 * std)).pf(criterion) - TARGET

    exact = float(brentq(excess, 0.1, 2.0))
    design = design_input(
        SYSTEM.problem(), criterion, TARGET, "W", (0.3, 0.9), moment="standard deviation",
        seek="largest", method=KRIGING, points=7, rng=1,
    )  # fmt: skip
    assert design.parameter == "standard deviation of W"
    assert design.value == pytest.approx(exact, abs=5e-3)


def replace_response(problem: Problem, response: object) -> Problem:
    return Problem(
        response,  # type: ignore[arg-type]
        shared={"V": normal(0.0, 1.0)},
        individual={"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)},
        units=problem.n_units,
    )


def test_no_solution_in_the_range() -> None:
    problem, method = SYSTEM.problem(), KRIGING
    for between, status in (((8.0, 9.0), "met nowhere"), ((15.0, 16.0), "met everywhere")):
        design = design_threshold(problem, TARGET, between, method=method, points=9, rng=1)
        assert design.status == status
        assert math.isnan(design.value)
        with pytest.raises(ValueError, match=f"no value to verify .{status}"):
            verify(design)
    # failures of synchronization alone exceed the target, whatever T is
    hopeless = design_threshold(
        problem, TARGET, (11.0, 20.0), tau=2.0, method=method, points=9, rng=1
    )
    assert hopeless.status == "met nowhere"


def test_verification_by_simulation_of_the_model() -> None:
    design = design_threshold(SYSTEM.problem(), TARGET, (11.0, 16.0), method=KRIGING, rng=1)
    right = verify(design, SIMULATION, rng=2)
    assert right.agrees
    assert right.ci_low < TARGET < right.ci_high
    assert right.meets == "undecided"
    assert verify(design, SIMULATION, value=design.value + 0.8, rng=2).meets == "yes"
    assert verify(design, SIMULATION, value=design.value - 0.8, rng=2).meets == "no"


def test_designs_of_one_problem_share_a_simulation() -> None:
    designs = design_thresholds(
        SYSTEM.problem(), TARGET, (11.0, 16.0), PROFILES[::2], method=KRIGING, points=17,
        rng=1,
    )  # fmt: skip
    places = [(design, value) for design in designs for value in (design.value, design.safe)]
    found = verify_all(places, MonteCarlo(systems=5_000), rng=2)
    assert [one.value for one in found] == [value for _, value in places]
    assert {one.n_evals for one in found} == {15_000}
    alone = verify(designs[1], MonteCarlo(systems=5_000), rng=2)
    assert (found[2].pf, found[2].ci_high) == (alone.pf, alone.ci_high)


def test_verification_finds_a_wrong_design() -> None:
    design = design_threshold(SYSTEM.problem(), TARGET, (11.0, 16.0), method=KRIGING, rng=1)
    scan = design.scan
    wrong = replace(
        design, scan=replace(scan, pf=scan.pf / 2, low=scan.low / 2, high=scan.high / 2)
    )
    assert not verify(wrong, SIMULATION, rng=2).agrees


def test_crossing_from_either_side() -> None:
    values = np.linspace(-3.0, 3.0, 13)
    pf = 0.5 - 0.5 * np.tanh(values)
    up = crossing(values, pf, 0.1, "smallest")
    assert up.value == pytest.approx(math.atanh(0.8), abs=0.02)
    down = crossing(values, pf[::-1], 0.1, "largest")
    assert down.value == pytest.approx(-up.value)
    assert down.cell == (12 - up.cell[1], 12 - up.cell[0])


def test_a_target_missed_again_further_on_is_said() -> None:
    values = np.arange(5.0)
    found = crossing(values, np.array([0.1, 0.001, 0.001, 0.1, 0.1]), 0.01, "smallest")
    assert found.status == "found"
    assert "missed again" in found.message
    other = crossing(values, np.array([0.001, 0.001, 0.1, 0.001, 0.001]), 0.01, "smallest")
    assert other.status == "met everywhere"
    assert "further inside it is not" in other.message


def test_doubts_next_to_the_value_count_and_others_do_not() -> None:
    values = np.arange(6.0)
    pf = np.array([0.5, 0.2, 0.05, 0.002, 0.001, math.nan])
    nothing = np.full(6, math.nan)
    notes = ["far away", "", "", "", "", "no answer"]
    found, low, _ = located(Scan(values, pf, nothing, nothing, tuple(notes)), 0.01, "smallest")
    assert found.status == "found"
    assert math.isnan(low)
    notes[2] = "few failures"
    found, _, _ = located(Scan(values, pf, nothing, nothing, tuple(notes)), 0.01, "smallest")
    assert (found.status, found.message) == ("doubtful", "few failures")
    found, _, _ = located(Scan(values, nothing, nothing, nothing, ("lost",) * 6), 0.01, "smallest")
    assert (found.status, found.message) == ("failed", "lost")


def test_a_moment_is_spelled_as_it_is() -> None:
    """ "Mean" was taken for the standard deviation, and nothing was found."""
    match = "moment = 'Mean': did you mean 'mean'\\? choose from"
    with pytest.raises(ValueError, match=match):
        design_input(
            SYSTEM.problem(), Criterion(12.0), 0.1, "U", (0.5, 1.0),
            moment="Mean",  # type: ignore[arg-type]
        )  # fmt: skip


def test_refusals() -> None:
    problem = SYSTEM.problem()
    with pytest.raises(ValueError, match="target_pf = 0"):
        design_threshold(problem, 0.0, (1.0, 2.0))
    with pytest.raises(ValueError, match="between = "):
        design_threshold(problem, 0.1, (2.0, 1.0))
    with pytest.raises(ValueError, match="input = 'k': choose from"):
        design_input(problem, Criterion(1.0), 0.1, "k", (0.0, 1.0))
    with pytest.raises(ValueError, match="standard deviation -1"):
        design_input(problem, Criterion(1.0), 0.1, "U", (-1.0, 1.0), moment="standard deviation")
    with pytest.raises(ValueError, match="points = 2"):
        design_threshold(problem, 0.1, (1.0, 2.0), points=2)
    with pytest.raises(ValueError, match="max_evals = 4: give at least a run for each of 5"):
        design_input(
            problem,
            Criterion(1.0),
            0.1,
            "U",
            (0.5, 1.0),
            method=MonteCarlo(),
            points=5,
            max_evals=4,
        )


def test_interval_between_the_values_follows_the_logarithm_of_pf() -> None:
    values = np.array([0.0, 1.0])
    pf = np.array([1e-1, 1e-5])
    scan = Scan(values, pf, pf / 2.0, pf * 2.0, ("", ""))
    assert scan.interval(0.5) == pytest.approx((5e-4, 2e-3))
    nothing = np.full(2, math.nan)
    assert Scan(values, pf, nothing, nothing, ("", "")).interval(0.5) == pytest.approx((1e-3, 1e-3))
