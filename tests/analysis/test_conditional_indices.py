"""Sobol' indices of dependent inputs: plain ones name their variables, conditional ones have no
order."""

import itertools
from typing import Any

import numpy as np
import openturns as ot
import pytest

from uqfold import Problem
from uqfold.analysis import chaos_sobol, conditional_sobol, pick_freeze
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import normal
from uqfold.methods import PolynomialChaos
from uqfold.typing import FloatArray

COVARIANCE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.5], [0.0, 0.5, 1.0]])
SLOPES = np.array([1.0, -1.0, -1.0])
NAMES = "RDL"


def exact(slopes: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Main and total conditional indices of a linear function of normal inputs."""
    variance = slopes @ covariance @ slopes
    main = (covariance @ slopes) ** 2 / np.diag(covariance)
    total = slopes**2 / np.diag(np.linalg.inv(covariance))
    return main / variance, total / variance


def linear(
    slopes: FloatArray, covariance: FloatArray, names: str, order: Any = None, shared: Any = ()
) -> Problem:
    order = list(range(len(names))) if order is None else list(order)
    std = np.sqrt(np.diag(covariance))
    correlation = (covariance / np.outer(std, std))[np.ix_(order, order)]
    joint = ot.Normal([0.0] * len(order), std[order].tolist(), ot.CorrelationMatrix(correlation))
    joint.setDescription([names[i] for i in order])
    # the problem's model sees the shared inputs first
    columns = [*shared, *(names[i] for i in order if names[i] not in shared)]
    weights = np.array([slopes[names.index(name)] for name in columns])
    return Problem(lambda x: x @ weights, inputs=joint, shared=list(shared))


def by_input(found: Any, order: str) -> dict[str, Any]:
    return {row.input: row for row in found if row.order == order}


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))), ids=str)
def test_conditional_indices_do_not_depend_on_the_order_of_the_columns(order: Any) -> None:
    # R - D - L: D has 0.27 or 0.07 of Sobol' indices in one order or another
    found = conditional_sobol(linear(SLOPES, COVARIANCE, NAMES, order), 256, 8, rng=1)
    main, total = exact(SLOPES, COVARIANCE)
    for kind, right in (("main", main), ("total", total)):
        rows = by_input(found, kind)
        for i, name in enumerate(NAMES):
            # Student's 99.9 % quantile with 7 degrees of freedom is 5.4
            assert abs(rows[name].index - right[i]) < 5.4 * rows[name].std_error, (kind, name)
            assert 0.0 < rows[name].std_error < 0.04
    assert found.n_evals == 8 * 256 * (2 + 3 + 2 + 2)


def test_the_comparison_can_fail() -> None:
    found = conditional_sobol(linear(SLOPES, COVARIANCE, NAMES), 256, 8, rng=1)
    main, total = exact(SLOPES, np.eye(3))  # the dependence forgotten
    rows = by_input(found, "main")
    assert abs(rows["D"].index - main[1]) > 10.0 * rows["D"].std_error
    rows = by_input(found, "total")
    assert abs(rows["D"].index - total[1]) > 5.4 * rows["D"].std_error


def test_two_dependent_parts_and_shared_inputs_of_both() -> None:
    covariance = np.eye(6)
    for i, j, c in ((0, 2, 0.6), (0, 4, 0.3), (2, 4, -0.2), (1, 5, 0.7)):
        covariance[i, j] = covariance[j, i] = c
    covariance[3, 3] = 4.0
    slopes = np.array([1.0, 2.0, -1.0, 0.5, 0.3, -0.5])
    problem = linear(slopes, covariance, "abcdef", shared=["f", "c"])
    found = conditional_sobol(problem, 256, 8, rng=1)
    main, total = exact(slopes, covariance)
    for kind, right in (("main", main), ("total", total)):
        rows = by_input(found, kind)
        for i, name in enumerate("abcdef"):
            assert abs(rows[name].index - right[i]) < 5.4 * rows[name].std_error, (kind, name)
    together = by_input(found, "main")["all shared inputs"]
    both = [2, 5]
    explained = covariance[:, both] @ np.linalg.solve(
        covariance[np.ix_(both, both)], covariance[both] @ slopes
    )
    assert (
        abs(together.index - slopes @ explained / (slopes @ covariance @ slopes))
        < 5.4 * together.std_error
    )


def test_independent_inputs_have_the_numbers_of_pick_freeze() -> None:
    problem = Problem(
        lambda x: x[:, 0] * x[:, 1] + x[:, 2],
        shared={"v": normal(1, 1), "w": normal(0, 1)},
        individual={"a": normal(0, 1)},
    )
    conditional, plain = (
        [(row.input, row.order, row.index, row.std_error) for row in found]
        for found in (conditional_sobol(problem, 64, 4, rng=3), pick_freeze(problem, 64, 4, rng=3))
    )
    assert [row[:2] for row in conditional] == [row[:2] for row in plain]
    np.testing.assert_allclose(
        [row[2:] for row in conditional], [row[2:] for row in plain], rtol=1e-12
    )


def test_any_copula_is_turned_about() -> None:
    marginals = [ot.Uniform(0, 1), ot.Uniform(0, 1)]
    found = []
    for names in (["a", "b"], ["b", "a"]):
        joint = ot.JointDistribution(marginals, ot.ClaytonCopula(2.0))
        joint.setDescription(names)
        a = names.index("a")

        def model(x: FloatArray, a: int = a) -> FloatArray:
            return x[:, a] + 0.3 * x[:, 1 - a] ** 2

        problem = Problem(model, inputs=joint)
        found.append(conditional_sobol(problem, 256, 8, rng=1))
    for kind in ("main", "total"):
        first, second = (by_input(one, kind) for one in found)
        for name in "ab":
            error = np.hypot(first[name].std_error, second[name].std_error)
            assert abs(first[name].index - second[name].index) < 5.0 * error


@pytest.mark.parametrize("analysis", ["pick-freeze", "pce"])
def test_plain_indices_of_dependent_inputs_warn_and_name_their_variables(analysis: str) -> None:
    problem = linear(SLOPES, COVARIANCE, NAMES)
    with pytest.warns(UserWarning, match="those of the variables L given D of the Rosenblatt"):
        found = (
            pick_freeze(problem, 64, 4, rng=1)
            if analysis == "pick-freeze"
            else chaos_sobol(problem, PolynomialChaos(runs=30), rng=1)
        )
    assert list(by_input(found, "main")) == ["R", "D", "L given D"]
    assert list(by_input(found, "total")) == ["R", "D", "L given D"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"samples": 100}, "samples = 100: give a power of two"),
        ({"samples": 2}, "samples = 2"),
        ({"repetitions": 2}, "repetitions = 2"),
    ],
)
def test_wrong_arguments(arguments: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        conditional_sobol(linear(SLOPES, COVARIANCE, NAMES), **arguments)


def test_a_budget_pays_for_all_or_nothing() -> None:
    with pytest.raises(BudgetExceededError, match="18,432"):
        conditional_sobol(linear(SLOPES, COVARIANCE, NAMES), 256, 8, max_evals=18_431)


def test_responses_without_variance_are_refused() -> None:
    problem = Problem(lambda x: np.where(x[:, 0] > 1, np.inf, x[:, 0]), inputs=ot.Normal(2))
    with pytest.raises(ValueError, match="no variance to share out"):
        conditional_sobol(problem, 64, 4, rng=1)
