"""Example 1: the response as printed, the problem's facts, references against simulation."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.problems.system_simulation import z_scores
from uqfold.problems import series
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.reference import load_references
from uqfold.problems.series_system import series_response

LIMIT = 4.5  # standard errors, for a dozen rows


def printed(x1: float, x2: float, x3: float) -> float:
    return math.exp(0.1 * x1 + 0.2) - math.exp(0.2 * x2 + x3) - 4 * (x1 + 1.5 * x2 - 1) ** 3 + 18


@pytest.mark.parametrize(
    "x", [(1.0, 1.2, 0.5), (0.0, 0.0, 0.0), (1.1, 1.35, 0.2), (-2.0, 3.0, -1.0)]
)
def test_response_is_the_printed_one(x: tuple[float, float, float]) -> None:
    assert series_response(np.array([x]))[0] == pytest.approx(printed(*x), rel=1e-14)


def test_response_at_a_point_worked_by_hand() -> None:
    # X = 0: exp(0.2) - 1 - 4 (-1)^3 + 18
    assert series_response(np.zeros((1, 3)))[0] == pytest.approx(math.exp(0.2) + 21, rel=1e-15)


def test_rows_are_independent_and_the_argument_is_kept() -> None:
    x = np.random.default_rng(0).normal(1, 0.2, (50, 3))
    before = x.copy()
    y = series_response(x)
    assert y.shape == (50,)
    assert y.dtype == np.float64
    np.testing.assert_array_equal(x, before)
    np.testing.assert_array_equal(y[::-1], series_response(x[::-1]))
    assert series_response(np.empty((0, 3))).shape == (0,)


def test_the_problem_is_that_of_table_2() -> None:
    problem = series()
    assert problem.name == "series"
    assert problem.n_units == 4
    assert problem.exchangeable
    assert problem.inputs.shared_names == ("X1",)
    assert problem.inputs.individual_names == ("X2", "X3")
    assert [m.getMean()[0] for m in problem.inputs.marginals] == [1.0, 1.2, 0.5]
    assert [m.getStandardDeviation()[0] for m in problem.inputs.marginals] == [0.05, 0.05, 0.1]
    assert {m.getName() for m in problem.inputs.marginals} == {"Normal"}
    assert problem.inputs.independent


def test_references_have_the_known_magnitudes() -> None:
    references = series().references
    for threshold, pf in ((0.0, 0.1), (4.0, 1.3e-3), (6.0, 4e-5), (8.0, 3e-7)):
        row = references.lookup(Criterion(threshold))
        assert row.pf == pytest.approx(pf, rel=0.1)


CRITERIA = [
    Criterion(t, tau, m)
    for t, tau, m in [
        (-3.0, None, 1),
        (0.0, None, 1),
        (2.0, None, 1),
        (-1.0, 12.0, 1),
        (2.0, 12.0, 1),
        (4.0, 14.0, 1),
        (1.0, None, 5),
        (2.0, 14.0, 5),
        (0.0, None, Binomial(10, 0.7)),
        (2.0, 12.0, Binomial(10, 0.7)),
        (2.0, 12.0, Binomial(4, 0.5)),
    ]
]


def test_references_agree_with_simulation() -> None:
    assert np.abs(z_scores(series(), CRITERIA, systems=100_000, seed=4_1)).max() < LIMIT


def test_the_agreement_would_not_survive_another_response() -> None:
    problem = series()
    wrong = lambda x: series_response(x) + 0.1  # noqa: E731
    shifted = type(problem)(
        wrong,
        inputs=problem.inputs.distribution,
        shared=["X1"],
        units=4,
        names=["X1", "X2", "X3"],
        references=load_references("series"),
    )
    assert np.abs(z_scores(shifted, CRITERIA, systems=100_000, seed=4_1)).max() > LIMIT


def test_a_wrong_reference_is_caught() -> None:
    problem = series()
    table = problem.references
    entries = {c: replace(row, pf=0.8 * row.pf) for c, row in table.entries.items()}
    object.__setattr__(problem, "references", replace(table, entries=entries))
    assert np.abs(z_scores(problem, CRITERIA, systems=100_000, seed=4_1)).max() > LIMIT
