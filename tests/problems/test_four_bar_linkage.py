"""Example 2: the loop closes, both branches, no assembly, references against simulation."""

import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.problems.system_simulation import z_scores
from uqfold.problems import four_bar
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.four_bar_linkage import THETA, Branch, RockerAngle

LIMIT = 4.5  # standard errors, for a dozen rows
MEANS = (53.0, 122.0, 66.5, 122.0)
BRANCHES = get_args(Branch)


def coupler_between_pins(phi: float, r_1: float, r_3: float, r_4: float) -> float:
    """Distance from the crank pin to the rocker pin: what the coupler has to span."""
    crank_pin = r_1 * np.array([math.cos(THETA), math.sin(THETA)])
    rocker_pin = [
        r_4 + r_3 * math.cos(math.radians(phi)),
        r_3 * math.sin(math.radians(phi)),
    ]
    return float(np.linalg.norm(rocker_pin - crank_pin))


length = st.floats(-8.0, 8.0)


@given(length, length, length, length)
def test_the_loop_closes_on_both_branches(a: float, b: float, c: float, d: float) -> None:
    x = np.array([MEANS]) + np.array([[a, b, c, d]])
    angles = [RockerAngle(branch)(x)[0] for branch in BRANCHES]
    for phi in angles:
        spanned = coupler_between_pins(phi, x[0, 0], x[0, 2], x[0, 3])
        assert spanned == pytest.approx(x[0, 1], rel=1e-12)
    # two different assemblies of the same rods
    assert abs(angles[0] - angles[1]) > 1.0


def test_mean_lengths_give_the_known_angles() -> None:
    x = np.array([MEANS])
    assert RockerAngle("open")(x)[0] == pytest.approx(99.0, abs=0.05)
    assert RockerAngle("crossed")(x)[0] == pytest.approx(-142.2, abs=0.05)


def test_the_second_linkage_as_printed_stands_elsewhere() -> None:
    # Table 4 as printed: a ground of 66.5 mm; why the problem does not use it
    x = np.array([[53.0, 122.0, 66.5, 66.5]])
    assert RockerAngle("open")(x)[0] == pytest.approx(46.5, abs=0.1)
    assert RockerAngle("crossed")(x)[0] == pytest.approx(-115.3, abs=0.1)


@pytest.mark.parametrize("branch", BRANCHES)
@pytest.mark.parametrize(
    "rods", [(53.0, 66.5, 66.5, 122.0), (53.0, 1.0, 66.5, 122.0), (53.0, 500.0, 66.5, 122.0)]
)
def test_rods_that_cannot_be_assembled_give_nan(branch: Branch, rods: tuple[float, ...]) -> None:
    # a failed run, without a warning, and its neighbours keep their values
    y = RockerAngle(branch)(np.array([MEANS, rods, MEANS]))
    assert np.isnan(y[1])
    assert y[0] == y[2] == RockerAngle(branch)(np.array([MEANS]))[0]


@pytest.mark.parametrize("branch", BRANCHES)
def test_stretched_out_rods_are_the_last_to_assemble(branch: Branch) -> None:
    pin = np.array([53 * math.cos(THETA) - 122, 53 * math.sin(THETA)])
    furthest = 66.5 + math.hypot(*pin)
    x = np.array([[53.0, furthest * (1 - 1e-9), 66.5, 122.0], [53.0, furthest + 1e-6, 66.5, 122.0]])
    y = RockerAngle(branch)(x)
    assert not np.isnan(y[0])
    assert np.isnan(y[1])


def test_a_rocker_along_the_ground_has_an_infinite_tangent() -> None:
    # E + F = 0 at phi = 180 deg: the division by zero is no failed run
    r_1, r_3, r_4 = 3.0, 1.0, 5.0
    r_2 = coupler_between_pins(180.0, r_1, r_3, r_4)
    y = [RockerAngle(b)(np.array([[r_1, r_2, r_3, r_4]]))[0] for b in BRANCHES]
    assert not np.isnan(y).any()
    assert min(abs(abs(phi) - 180.0) for phi in y) < 1e-6


def test_rows_are_independent_and_the_argument_is_kept() -> None:
    x = np.random.default_rng(0).normal(MEANS, 1.0, (40, 4))
    before = x.copy()
    y = RockerAngle("open")(x)
    assert y.shape == (40,)
    assert y.dtype == np.float64
    np.testing.assert_array_equal(x, before)
    np.testing.assert_array_equal(y[::-1], RockerAngle("open")(x[::-1]))


def test_the_problem_is_that_of_table_4() -> None:
    problem = four_bar()
    assert problem.name == "four-bar"
    assert problem.n_units == 2
    assert problem.exchangeable
    assert problem.inputs.shared_names == ("R_1",)
    assert problem.inputs.individual_names == ("R_2", "R_3", "R_4")
    assert tuple(m.getMean()[0] for m in problem.inputs.marginals) == MEANS
    assert [m.getStandardDeviation()[0] for m in problem.inputs.marginals] == [1.0] * 4
    assert {m.getName() for m in problem.inputs.marginals} == {"Normal"}
    assert problem.inputs.independent
    assert problem.response_unit == "deg"
    assert problem.input_units == ("mm",) * 4


def test_branches_are_two_problems() -> None:
    crossed = four_bar("crossed")
    assert crossed.name == "four-bar-crossed"
    assert crossed.version != four_bar().version
    assert crossed.references is not None
    assert crossed.references.problem == "four-bar-crossed"


def test_an_unknown_branch_is_refused() -> None:
    with pytest.raises(ValueError, match="branch = 'upper': choose from 'open', 'crossed'"):
        four_bar("upper")  # type: ignore[arg-type]


@pytest.mark.parametrize(("branch", "low", "high"), [("open", 0.0, 0.01), ("crossed", 0.33, 0.36)])
def test_share_of_the_crank_in_the_variance(branch: Branch, low: float, high: float) -> None:
    problem = four_bar(branch)
    rng = np.random.default_rng(2)
    crank = rng.normal(53, 1, 200_000)
    pair = [
        problem.model(np.column_stack([crank, rng.normal(MEANS[1:], 1, (crank.size, 3))]))
        for _ in range(2)
    ]
    error = 1 / math.sqrt(crank.size)
    assert low - 4 * error < np.corrcoef(pair)[0, 1] < high + 4 * error


def grid(thresholds: tuple[float, float, float]) -> list[Criterion]:
    low, middle, high = thresholds
    return [
        Criterion(t, tau, m)
        for t, tau, m in [
            (low, None, 1),
            (middle, None, 1),
            (high, None, 1),
            (low, 2.0, 1),
            (middle, 3.0, 1),
            (high, 4.0, 1),
            (middle, None, 5),
            (high, 4.0, 5),
            (middle, None, Binomial(10, 0.7)),
            (high, 4.0, Binomial(10, 0.7)),
            (middle, 2.0, Binomial(2, 0.5)),
        ]
    ]


GRIDS = {"open": grid((99.5, 101.0, 102.0)), "crossed": grid((-142.0, -140.0, -139.0))}


@pytest.mark.parametrize("branch", BRANCHES)
def test_references_agree_with_simulation(branch: Branch) -> None:
    z = z_scores(four_bar(branch), GRIDS[branch], systems=100_000, seed=4_2)
    assert np.abs(z).max() < LIMIT


def test_the_agreement_would_not_survive_the_other_branch() -> None:
    problem = four_bar()
    turned = lambda x: RockerAngle("crossed")(x) + 99.02 + 142.207  # noqa: E731
    object.__setattr__(problem, "model", turned)
    z = z_scores(problem, GRIDS["open"], systems=100_000, seed=4_2)
    assert np.abs(z).max() > LIMIT
