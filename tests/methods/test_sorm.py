"""SORM: formulas of second order, several design points, errors that hold, importance factors."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

from uqfold.inputs import normal
from uqfold.methods import SORM, OpenTURNSFORM
from uqfold.methods.second_order import Formula, Paraboloid, union
from uqfold.problems import Problem
from uqfold.problems.catalogue import entry
from uqfold.problems.catalogue import problem as limit_state
from uqfold.problems.criterion import Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray, Model

METHOD = SORM()


def standard_normal(model: Model, dimension: int) -> Problem:
    return Problem(model, individual={f"u{i}": normal(0.0, 1.0) for i in range(dimension)})


def behind(beta: float, kappa: float) -> float:
    """Probability behind a parabola, by quadrature."""

    def value(v: float) -> float:
        return math.exp(-0.5 * v * v) * float(ndtr(-beta - 0.5 * kappa * v * v))

    return float(quad(value, -12.0, 12.0, epsabs=0.0, limit=400)[0]) / math.sqrt(2.0 * math.pi)


@pytest.mark.parametrize(
    ("beta", "kappa", "off"),
    [(4.0, 0.3, 0.03), (4.0, -0.15, 0.06), (2.0, 0.5, 0.07), (6.0, -0.1, 0.03), (3.0, 0.0, 1e-9)],
)
def test_formulas_against_quadrature(beta: float, kappa: float, off: float) -> None:
    """The integral is exact, the formulas are as near as they are known to be."""
    exact = behind(beta, kappa)
    bends = np.array([kappa])
    found = Paraboloid(np.eye(2)[0], beta, bends, bends, 0.0).probabilities()
    assert found.pop("paraboloid") == pytest.approx(exact, rel=1e-9)
    assert len(found) == 3
    for pf in found.values():
        assert pf == pytest.approx(exact, rel=off)
    assert abs(found["tvedt"] / exact - 1.0) <= 0.01


def test_planes_are_joined_by_the_multinormal_probability() -> None:
    betas, angle = [2.5, 2.0], 0.7
    towards = np.array([[1.0, 0.0], [math.cos(angle), math.sin(angle)]])

    def beyond_the_second(v: float) -> float:
        # where the first plane leaves the system working
        other = (betas[1] - v * math.cos(angle)) / math.sin(angle)
        return math.exp(-0.5 * v * v) * float(ndtr(-other))

    second = quad(beyond_the_second, -10.0, betas[0], epsabs=0.0)[0] / math.sqrt(2.0 * math.pi)
    exact = float(ndtr(-betas[0])) + second
    pf, left = union(betas, towards)
    assert (pf, left) == (pytest.approx(exact, rel=1e-6), 0.0)
    pf, left = union([3.0] * 3, np.eye(3))
    assert abs(pf + math.expm1(3.0 * math.log1p(-ndtr(-3.0)))) <= left < 0.01 * pf


def parabola(x: FloatArray) -> FloatArray:
    return np.asarray(x[:, 0] - 0.1 * x[:, 1] ** 2 + 0.05 * x[:, 2] ** 2)


@pytest.mark.parametrize("formula", ["paraboloid", "breitung", "hohenbichler-rackwitz", "tvedt"])
def test_curvature_is_answered_where_form_is_doubtful(formula: Formula) -> None:
    def exact(limit: float) -> float:
        def value(v: float) -> float:
            return math.exp(-0.5 * v * v) * behind(limit + 0.1 * v * v, -0.1)

        return float(quad(value, -10.0, 10.0, epsabs=0.0)[0]) / math.sqrt(2.0 * math.pi)

    problem, pf = standard_normal(parabola, 3), exact(3.5)
    plane = OpenTURNSFORM().estimate(problem, Criterion(3.5))[0]
    assert plane.status == "doubtful"
    result = SORM(formula=formula).estimate(problem, criteria([3.5, math.inf]))
    row, order = result[0], result.details.second_orders[0]
    assert row.status == "converged"
    assert abs(row.pf - pf) < 3.0 * row.std_error < 0.3 * pf
    assert row.pf == order.pf[formula]
    assert order.curvatures[0] == pytest.approx([-0.1, 0.2], abs=1e-6)
    assert (result[1].pf, result[1].status) == (0.0, "doubtful")


def test_a_median_that_fails_is_answered_from_its_other_side() -> None:
    row = METHOD.estimate(standard_normal(lambda x: -parabola(x), 3), Criterion(-2.5))[0]
    other = METHOD.estimate(standard_normal(parabola, 3), Criterion(2.5))[0]
    assert row.reliability == pytest.approx(other.pf, rel=1e-6)
    assert row.pf == 1.0 - row.reliability


@pytest.mark.parametrize("name", ["linear-and-convex", "two-sided-parabola", "concave-domain"])
def test_several_design_points_are_joined(name: str) -> None:
    """FORM sees one of them and is doubtful."""
    problem, pf = limit_state(name), entry(name).pf
    assert OpenTURNSFORM().estimate(problem)[0].status == "doubtful"
    result = METHOD.estimate(problem)
    assert result.details.second_orders[0].distances.size == 2
    assert result[0].status == "converged"
    assert abs(result[0].pf - pf) < 3.0 * result[0].std_error < 0.3 * pf


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_point_between_two_nearer_ones_counts_nothing(side: float) -> None:
    """The gradient leads to the origin there as well: what lies behind it was counted twice."""

    def cup(kappa: float) -> Problem:
        return standard_normal(lambda x: side * (x[:, 0] + 0.5 * kappa * x[:, 1] ** 2 - 4.5), 2)

    result = METHOD.estimate(cup(1.2), Criterion(0.0))
    row, exact = result[0], behind(4.5, -1.2)
    assert row.status == "converged"
    small = row.pf if side > 0.0 else row.reliability
    assert abs(small - exact) < 3.0 * row.std_error < 0.3 * exact
    assert result.details.second_orders[0].distances == pytest.approx([2.607] * 2, abs=0.01)
    # the only point found has nearer ones beside it
    row = METHOD.estimate(cup(0.24), Criterion(0.0))[0]
    assert row.status == "doubtful"
    assert "nearer beside" in row.message


def test_what_is_no_paraboloid_is_in_the_error() -> None:
    """A cubic beside the point; a domain that ends behind it is not believed."""
    row, pf = METHOD.estimate(limit_state("gayton-hat"))[0], entry("gayton-hat").pf
    assert 0.02 * pf < abs(row.pf - pf) < 3.0 * row.std_error
    slice_ = standard_normal(lambda x: 3.3 - np.abs(x[:, 0] - 3.1), 2)
    row = METHOD.estimate(slice_, Criterion(3.0))[0]
    assert row.status == "doubtful"


def test_importance_factors_have_names() -> None:
    inputs = {"load": normal(10.0, 3.0), "strength": normal(40.0, 4.0)}
    problem = Problem(lambda x: x[:, 0] - x[:, 1], individual=inputs)
    for method in (OpenTURNSFORM(), METHOD):
        point = method.estimate(problem, Criterion(0.0)).details.design_points[0]
        assert list(point.importance_by_name) == ["strength", "load"]
        assert point.importance_by_name == pytest.approx({"strength": 0.64, "load": 0.36})


def test_systems_and_small_budgets() -> None:
    system, asked = LinearNormalSystem(units=3), Criterion(13.0, missions=2)
    row = METHOD.estimate(system.problem(), asked)[0]
    assert row.status == "converged"
    assert row.pf == pytest.approx(system.pf(asked), rel=1e-6)
    one, asked = LinearNormalSystem(units=1).problem(), criteria([12.0, 13.0])
    for budget in (5, 30, 100, 200):
        rows = METHOD.estimate(one, asked, max_evals=budget)
        assert rows.n_evals <= budget
        assert "converged" not in [row.status for row in rows]


def test_what_no_run_brings_to_its_limit_always_fails() -> None:
    """The plane that an unfinished search left gave 0.5, under a message that said otherwise."""
    problem = standard_normal(lambda x: 3.0 + x[:, 0] ** 2, 2)
    row = SORM().estimate(problem, criteria(2.0), rng=1)[0]
    assert (row.pf, row.status) == (1.0, "doubtful")
    assert "taken for one that always fails" in row.message
