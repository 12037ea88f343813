"""Kriging of the difference from a cheap partner, whose runs count apart."""

import math
from dataclasses import replace

import numpy as np
import pytest

from uqfold import Problem, Unit, criteria
from uqfold.inputs import normal
from uqfold.methods import Kriging
from uqfold.methods.result import CriterionResult
from uqfold.typing import FloatArray

THRESHOLD, EXACT = 4.5, 1.7769e-3
"""pf by sums over grids, which `python -m validation.benchmarks.multifidelity` prints."""


def waves(x: FloatArray) -> FloatArray:
    """What model and partner have in common, and 320 runs of the model do not learn."""
    return np.asarray(
        0.4 * np.sin(1.5 * x[:, 0] + x[:, 1]) + 0.3 * np.cos(1.2 * x[:, 1] - 1.5 * x[:, 2])
    )


def cheap(x: FloatArray) -> FloatArray:
    return np.asarray(0.8 * x[:, 0] + x[:, 1] + 0.6 * x[:, 2] + waves(x))


def dear(x: FloatArray) -> FloatArray:
    plain = 0.9 * x[:, 0] + 0.9 * x[:, 1] + 0.6 * x[:, 2] + 0.05 * x[:, 0] * x[:, 2]
    return np.asarray(plain + 1.1 * waves(x))


def useless(x: FloatArray) -> FloatArray:
    return np.asarray(np.sin(7.0 * x[:, 1]) + x[:, 2] ** 2)


def broken(x: FloatArray) -> FloatArray:
    return np.full(len(x), math.nan)


def problem(partner: object, **units: object) -> Problem:
    return Problem(
        dear,
        low_fidelity=partner,
        shared={"V": normal(0, 1)},
        individual={"U": normal(0, 1), "W": normal(0, 1)},
        **{"units": 3, **units},
    )


QUICK = Kriging(runs=30, kernel="gaussian", trend="quadratic")
WITH = Kriging(runs=30, kernel="gaussian", trend="quadratic", partner_runs=10)


@pytest.fixture(scope="module")
def plain() -> CriterionResult:
    """Without a partner."""
    return QUICK.estimate(problem(cheap), criteria(THRESHOLD), rng=1)[0]


def test_thirty_runs_and_a_partner_do_what_hundreds_do_not(plain: CriterionResult) -> None:
    """Without it 320 runs err by 0.7 % and are doubtful."""
    result = WITH.estimate(problem(cheap), criteria(THRESHOLD), rng=1)
    row = result[0]
    assert row.status == "converged"
    assert (row.n_evals, result.details.partner_evals) == (30, 300)
    assert abs(row.pf - EXACT) < 3.0 * row.std_error
    assert row.std_error < 0.05 * EXACT
    assert result.details.gain > 10.0
    assert plain.status == "doubtful"
    assert abs(plain.pf - EXACT) > 20.0 * abs(row.pf - EXACT)


def test_the_unit_of_the_partner_is_its_own() -> None:
    partner = problem(lambda x: 1e-300 * (cheap(x) - 0.3))  # zero at the origin
    row = WITH.estimate(partner, criteria(THRESHOLD), rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - EXACT) < 3.0 * row.std_error < 0.15 * EXACT


@pytest.mark.parametrize(
    ("partner", "said"),
    [
        (useless, "the partner is of no use: as if it had not been asked"),
        (lambda x: np.zeros(len(x)), "the partner is of no use"),
        (broken, "the partner gives no response where the model does"),
    ],
)
def test_a_useless_partner_costs_its_pilot_and_says_so(
    partner: object, said: str, plain: CriterionResult
) -> None:
    result = WITH.estimate(problem(partner), criteria(THRESHOLD), rng=1)
    assert result[0].pf == plain.pf
    assert said in result[0].message
    assert result.details.partner_evals <= 30
    assert math.isnan(result.details.gain)


@pytest.mark.thorough
def test_units_of_several_kinds_have_partners_of_their_own() -> None:
    def other(x: FloatArray) -> FloatArray:
        return np.asarray(0.5 * dear(x) + 0.3 * x[:, 1])

    units = [
        Unit(),
        Unit(other, [normal(0, 1), normal(0, 1)], low_fidelity=lambda x: 0.5 * cheap(x)),
    ]
    method = replace(WITH, runs=60)
    result = method.estimate(problem(cheap, units=units), criteria(4.0), rng=2)
    first, second = result.details, result.details.of_other_kinds[0]
    assert min(first.gain, second.gain) > 3.0
    assert result[0].message == "" or "partner" not in result[0].message
    assert first.partner_evals == 600


def test_what_a_partner_cannot_be_asked_for_is_refused() -> None:
    row = Kriging(partner_runs=5).estimate(problem(None), criteria(4.0), rng=1)[0]
    assert (row.status, row.n_evals) == ("unsupported", 0)
    assert "partner_runs = 5 needs a cheaper partner" in row.message
    with pytest.raises(ValueError, match="leave it out where a partner is asked"):
        Kriging(partner_runs=5, noise=0.1)
