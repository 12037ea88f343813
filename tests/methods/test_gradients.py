"""Gradients that a model offers: fewer runs, the same answer, counted apart, and never trusted."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import openturns as ot
import pytest

import uqfold
from uqfold.inputs import normal
from uqfold.methods import SORM, MonteCarlo, OpenTURNSFORM

INPUTS = {f"x{i}": normal(1.0, 0.2) for i in range(20)}


def _load(x: Any) -> Any:
    return x.sum(axis=1) + 0.01 * (x**2).sum(axis=1)


def _slopes(x: Any) -> Any:
    return 1.0 + 0.02 * x


def _problem(gradient: Callable[[Any], Any] | None, **options: Any) -> uqfold.Problem:
    return uqfold.Problem(_load, individual=INPUTS, gradient=gradient, **options)


@pytest.mark.parametrize("method", [OpenTURNSFORM(), SORM()], ids=lambda one: one.name)
def test_fewer_runs_and_the_same_answer_in_twenty_inputs(method: Any) -> None:
    calls: list[int] = []
    inputs = {f"x{i}": ot.LogNormalMuSigma(1.0, 0.2).getDistribution() for i in range(20)}

    def slopes(x: Any) -> Any:
        calls.append(len(x))
        return _slopes(x)

    without = method.estimate(uqfold.Problem(_load, individual=inputs), 24.0)
    given = method.estimate(uqfold.Problem(_load, individual=inputs, gradient=slopes), 24.0)
    assert given.pf == pytest.approx(without.pf, rel=1e-3)
    assert given[0].status == without[0].status
    assert given.n_evals < 0.65 * without.n_evals
    assert given.n_gradients == sum(calls) > 0
    assert without.n_gradients == 0
    assert f"{given.n_gradients} gradients" in str(given)
    assert "gradients" not in str(without)


def _wrong_sign(x: Any) -> Any:
    return _slopes(x) * np.where(np.arange(x.shape[1]) == 3, -1.0, 1.0)


def _raises(x: Any) -> Any:
    raise ArithmeticError("no slope today")


@pytest.mark.parametrize(
    ("gradient", "message"),
    [
        (_wrong_sign, "the gradient says -0.2.* per standard deviation of x3, differences 0.2"),
        (lambda x: 1.2 * _slopes(x), "the gradient says"),
        (lambda x: _slopes(x)[0], r"has shape \(20,\) for inputs of \(1, 20\)"),
        (_raises, "the gradient raised ArithmeticError: no slope today"),
        (lambda x: sys.exit(3), "the gradient raised SystemExit"),
        (np.zeros_like, "the gradient says 0 per standard deviation"),
        (
            lambda x: _slopes(x) if (x == 1.0).all() else -_slopes(x),
            "the gradient says -0.2.*, differences 0.2",
        ),
    ],
    ids=["sign", "factor", "shape", "raises", "exits", "zero", "right once"],
)
def test_a_wrong_gradient_is_told_and_not_used(gradient: Any, message: str) -> None:
    right = SORM().estimate(_problem(None), 24.0)[0]
    row = SORM().estimate(_problem(gradient), 24.0)[0]
    assert right.status == "converged"
    assert row.status == "doubtful"
    assert row.pf == pytest.approx(right.pf, rel=1e-9)
    assert re.search(message, row.message)


def test_where_it_is_not_a_number_differences_are_taken() -> None:
    plain = SORM().estimate(_problem(None), 24.0)
    for gradient in (
        lambda x: np.full(x.shape, np.nan),
        lambda x: np.ma.masked_array(-_slopes(x), mask=True),
        lambda x: (1.0 + 1.0j) * _slopes(x),
    ):
        holes = SORM().estimate(_problem(gradient), 24.0)
        assert holes.pf.tolist() == plain.pf.tolist()
        assert holes.n_evals == plain.n_evals
        assert holes.n_gradients > 0


def test_a_gradient_that_is_wrong_only_far_from_the_start_is_no_converged_answer() -> None:
    def late(x: Any) -> Any:
        return _slopes(x) * np.where(
            (x.sum(axis=1) > 21.0)[:, None] & (np.arange(20) < 5), 3.0, 1.0
        )

    right = SORM().estimate(_problem(None), 24.0)[0]
    row = SORM().estimate(_problem(late), 24.0, max_evals=1_000)[0]
    assert row.status != "converged" or row.pf == pytest.approx(right.pf, rel=0.1)


def test_the_chain_rule_goes_through_any_input_and_copula() -> None:
    copula = ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.6], [0.6, 1.0]]))
    joint = ot.JointDistribution([ot.LogNormal(0.0, 0.3), ot.Gumbel(0.5, 2.0)], copula)

    def strain(x: Any) -> Any:
        return x[:, 0] * x[:, 1]

    def slopes(x: Any) -> Any:
        return x[:, ::-1]

    without = SORM().estimate(uqfold.Problem(strain, inputs=joint), 12.0)[0]
    given = SORM().estimate(uqfold.Problem(strain, inputs=joint, gradient=slopes), 12.0)[0]
    assert "differences" not in given.message
    assert given.pf == pytest.approx(without.pf, rel=0.02)


def test_of_a_limit_state_it_is_that_of_g() -> None:
    def g(x: Any) -> Any:
        return 4.0 - x.sum(axis=1)

    problem = uqfold.Problem.from_limit_state(
        g, {"a": normal(0, 1), "b": normal(0, 1)}, gradient=lambda x: np.full(x.shape, -1.0)
    )
    row = SORM().estimate(problem)[0]
    assert row.status == "converged"
    assert re.fullmatch(r"\d+ gradients beside the runs", row.message)


def test_it_stays_with_the_problem_and_units_of_another_model_have_none() -> None:
    problem = _problem(_slopes)
    assert replace(problem, name="other").gradient is _slopes
    units = [uqfold.Unit(), uqfold.Unit(model=lambda x: 2.0 * _load(x))]
    both = _problem(_slopes, units=units)
    assert both.kinds.gradients == (_slopes, None)
    row = OpenTURNSFORM().estimate(both, 30.0)
    assert row.n_gradients > 0
    assert MonteCarlo().estimate(problem, 24.0, max_evals=100, rng=1).n_gradients == 0
    with pytest.raises(TypeError, match="gradient = 3: give a function"):
        _problem(3)  # type: ignore[arg-type]


def test_it_serves_runs_that_are_made_elsewhere() -> None:
    problem = uqfold.Problem(None, individual=INPUTS, gradient=_slopes)
    session = OpenTURNSFORM().start(problem, 24.0, rng=1)
    while not session.done:
        session.tell(x := session.ask(), _load(x))
    told = session.result()
    ran = OpenTURNSFORM().estimate(_problem(_slopes), 24.0, rng=1)
    assert told.pf.tolist() == ran.pf.tolist()
    assert told.n_gradients == ran.n_gradients > 0
