"""One answer without choosing a method."""

from dataclasses import replace

import numpy as np
import openturns as ot
import pytest

import uqfold
from uqfold.comparison import named_problem
from uqfold.methods import Automatic, Kriging, Solution, Task
from uqfold.methods.automatic import MethodTried

NORMALS = ot.Normal(2)


def courses(result: uqfold.ReliabilityResult) -> list[tuple[str, str]]:
    attempts: tuple[MethodTried, ...] = result.details.attempts
    return [(one.method.name, one.purpose) for one in attempts]


def linear(beta: float) -> uqfold.Problem:
    return uqfold.Problem.from_limit_state(
        lambda x: beta - x.sum(axis=1) / np.sqrt(2.0), NORMALS, name="plane"
    )


def test_a_smooth_problem_is_answered_by_a_surface_and_checked_on_the_model() -> None:
    """The check is made by runs that the surface has not seen, and they are told apart."""
    result = uqfold.estimate(linear(2.0), rng=1)
    row = result[0]
    assert courses(result) == [("kriging", "answer"), ("importance-sampling", "check")]
    assert row.status == "converged"
    assert row.pf == pytest.approx(0.0227501319, rel=1e-3)
    assert row.message.startswith("by kriging; importance-sampling found 0.02")
    attempts = result.details.attempts
    surface, check = (one.n_evals for one in attempts)
    assert 100 <= surface < 150
    assert surface + check == result.n_evals
    assert result.details.n_evals_of_checks == check <= 2000


def test_what_a_surface_doubts_is_simulated_where_the_surface_leaves_it_open() -> None:
    """Limit states with corners: the surface is a partner, not the answer."""
    problem = named_problem("rp57").problem()
    result = uqfold.estimate(problem, rng=1)
    assert problem.references is not None
    (right,) = problem.references
    assert courses(result) == [("kriging", "answer"), ("multifidelity-mc", "answer")]
    assert result[0].status == "converged"
    assert abs(result[0].pf - right.pf) < 4.0 * result[0].std_error < 0.25 * right.pf


def test_a_bare_step_is_doubtful_and_bounded() -> None:
    """No run says where it is: there is an upper bound, and nothing else."""
    problem = uqfold.Problem(lambda x: (x[:, 0] > 5.0) * 1.0, inputs=NORMALS, name="step")
    row = uqfold.estimate(problem, uqfold.criteria(0.5), rng=1)[0]
    assert row.status == "doubtful"
    assert not row.ci_high < 2.8665e-07


def test_a_surface_without_an_error_is_not_believed_against_runs_of_the_model() -> None:
    """It said 9e-3 of a corner that fails once in ten million runs."""
    problem = named_problem("genz-corner").problem()
    row = uqfold.estimate(problem, rng=1)[0]
    assert row.status == "doubtful"
    assert row.pf <= row.ci_high < 1e-3


def test_a_surface_that_the_model_contradicts_is_not_believed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A confident surface that is wrong by half is found out by its check."""
    plain = Kriging._solve

    def wrong(self: Kriging, task: Task) -> Solution:
        found = plain(self, task)
        half = [replace(one, pf=0.5 * one.pf, reliability=None) for one in found.estimates]
        ends = [replace(one, ci_low=0.99 * one.pf, ci_high=1.01 * one.pf) for one in half]
        return replace(found, estimates=ends)

    monkeypatch.setattr(Kriging, "_solve", wrong)
    row = uqfold.estimate(linear(1.0), rng=1)[0]
    assert row.status == "doubtful"
    assert "answers contradict each other" in row.message


def test_the_budget_is_kept_and_more_runs_are_asked_for() -> None:
    """A small budget leaves nothing for a check; the message says what it would take."""
    result = uqfold.estimate(linear(2.0), max_evals=300, rng=1)
    assert courses(result) == [("kriging", "answer")]
    assert 100 <= result.n_evals < 150
    rough = uqfold.Problem(lambda x: np.round(x.sum(axis=1)), inputs=NORMALS, name="rough")
    row = uqfold.estimate(rough, uqfold.criteria(3.5), max_evals=1200, rng=1)[0]
    assert row.n_evals <= 1200
    assert row.status == "doubtful"
    assert "runs would be enough" in row.message


def test_settings_are_checked() -> None:
    """As those of any method."""
    with pytest.raises(ValueError, match=r"target = -1\.0"):
        uqfold.estimate(linear(1.0), target=-1.0)
    with pytest.raises(ValueError, match="check_runs = -1"):
        Automatic(check_runs=-1)
