"""One answer without choosing a method."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import openturns as ot
import pytest
from scipy import stats
from scipy.special import ndtr

import uqfold
from uqfold.comparison import named_problem
from uqfold.evaluation import Evaluator
from uqfold.methods import Automatic, Kriging, ReliabilityMethod, Solution, Task
from uqfold.methods.automatic_check import SurfaceModel
from uqfold.methods.automatic_course import Course, MethodTried
from uqfold.methods.result import Estimate
from uqfold.typing import FloatArray

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
    assert courses(result) == [("kriging", "answer"), ("guided-sampling", "check")]
    assert row.status == "converged"
    assert row.pf == pytest.approx(0.0227501319, rel=1e-3)
    assert row.message.startswith("by kriging; guided-sampling found 0.02")
    attempts = result.details.attempts
    surface, check = (one.n_evals for one in attempts)
    assert 100 <= surface < 150
    assert surface + check == result.n_evals
    assert result.details.n_evals_of_checks == check <= 2000


@pytest.mark.thorough
def test_what_a_surface_doubts_is_simulated_where_the_surface_leaves_it_open() -> None:
    """Limit states with corners: the surface is a partner, not the answer."""
    problem = named_problem("rp57").problem()
    result = uqfold.estimate(problem, rng=1)
    assert problem.references is not None
    (right,) = problem.references
    names = [name for name, _ in courses(result)]
    assert names == ["kriging", "pce", "multifidelity-mc"]
    assert result[0].status == "converged"
    assert abs(result[0].pf - right.pf) < 4.0 * result[0].std_error < 0.25 * right.pf


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 1])
def test_a_region_that_the_surface_has_not_seen_is_found_or_doubted(seed: int) -> None:
    """Most failures lie in a small ball: a surface guided past it, to 13 % of pf, for sure."""

    def response(x: FloatArray) -> FloatArray:
        away = np.linalg.norm(x - np.array([-2.5, 0.0, 0.0]), axis=1)
        return np.asarray(np.maximum(x[:, 0] - 3.5, 0.5 - away))

    problem = uqfold.Problem(response, inputs=ot.Normal(3), name="plane and ball")
    exact = ndtr(-3.5) + stats.ncx2.cdf(0.5**2, 3, 2.5**2)
    row = uqfold.estimate(problem, uqfold.criteria(0.0), rng=seed)[0]
    assert row.status != "converged" or abs(row.pf - exact) < 4.0 * row.std_error < 0.3 * exact
    assert row.pf > 0.5 * exact


def test_a_rare_failure_is_seen_by_the_check() -> None:
    """The check of one in 3.5 million found "0 in 0 .. 0.002", and the row read as checked (F3)."""
    result = uqfold.estimate(linear(5.0), max_evals=400, rng=1)
    assert 300 <= result.n_evals <= 400
    check = result.details.attempts[-1]
    assert result[0].status == "converged"
    assert "not checked" not in result[0].message
    assert check.estimates[0].pf == pytest.approx(2.866516e-07, rel=0.25)
    assert check.estimates[0].std_error < 0.1 * check.estimates[0].pf


def test_what_no_run_is_left_to_check_is_not_called_checked() -> None:
    """An empty check is none; who asks for none gets the surface's own word (F3)."""
    result = uqfold.estimate(linear(5.0), max_evals=100, rng=1)
    assert courses(result) == [("kriging", "answer")]
    assert result[0].status == "unchecked"
    assert "not checked on the model" in result[0].message
    unasked = Automatic(check_runs=0).estimate(linear(5.0), max_evals=100, rng=1)[0]
    assert unasked.status == "converged"
    assert "not checked on the model" in unasked.message


def test_the_surface_of_a_system_is_checked_by_one_unit() -> None:
    """Twenty missions of four units cost eighty runs a sample, one unit costs one (F3)."""
    criteria = uqfold.criteria([2.0, 6.0], tau=[None, 4.0], missions=20)
    result = uqfold.estimate(uqfold.problems.series(), criteria, max_evals=600, rng=1)
    assert courses(result) == [("kriging", "answer"), ("guided-sampling", "check")]
    assert not any("not checked" in row.message for row in result)
    for row, criterion in zip(result, result.criteria, strict=True):
        assert row.status == "converged"
        assert ("one unit on the model fails" in row.message) == (criterion.tau is None)


def test_a_bare_step_is_doubtful_and_bounded() -> None:
    """No run says where it is: there is an upper bound, and nothing else."""
    problem = uqfold.Problem(lambda x: (x[:, 0] > 5.0) * 1.0, inputs=NORMALS, name="step")
    row = uqfold.estimate(problem, uqfold.criteria(0.5), rng=1)[0]
    assert row.status == "doubtful"
    assert not row.ci_high < 2.8665e-07


@pytest.mark.slow
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


def test_a_surface_of_a_system_that_the_model_contradicts_is_not_believed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Runs of one unit find out a surface that is wrong where failure begins."""
    told = SurfaceModel.__call__
    monkeypatch.setattr(SurfaceModel, "__call__", lambda self, x: told(self, x) - 0.25)
    criteria = uqfold.criteria(6.0, missions=20)
    row = uqfold.estimate(uqfold.problems.series(), criteria, max_evals=700, rng=1)[0]
    assert row.status == "doubtful"
    assert "answers contradict each other" in row.message


def test_one_run_bounds_pf() -> None:
    """One run is no surface, but it is a simulation (F8)."""
    row = uqfold.estimate(linear(2.0), max_evals=1, rng=1)[0]
    assert row.status == "doubtful"
    assert row.ci_low == 0.0
    assert row.ci_high == pytest.approx(0.95)
    assert row.n_evals == 1


def test_a_model_that_only_fails_is_run_no_longer_than_that_takes() -> None:
    """It is ``failed``, with what it said, after the first runs of two methods (F8)."""
    broken = uqfold.Problem(lambda x: np.full(len(x), np.nan), inputs=NORMALS, name="broken")
    row = uqfold.estimate(broken, uqfold.criteria(1.0), rng=1)[0]
    assert row.status == "failed"
    assert row.n_evals == row.n_failed < 300


@dataclass(frozen=True)
class _Says(ReliabilityMethod):
    """Says what it is told to."""

    name: ClassVar[str] = "parrot"
    said: Estimate | None = None

    def _solve(self, task: Task) -> Solution:
        assert self.said is not None
        return Solution([self.said] * len(task.criteria))


def best_of(*said: Estimate) -> Estimate:
    """Return what automatic choice makes of some answers to one criterion."""
    problem, criteria = linear(2.0), tuple(uqfold.criteria(0.0))
    session = Evaluator().open(problem, 10)
    course = Course(Task(problem, criteria, 1, session))
    for one in said:
        course.ask(_Says(one), [0], 5, "answer")
    return course.answer(0, 0.05, check_wanted=True)


BY_SURFACE = Estimate(1.37e-2, status="doubtful", message="predicts badly")


def test_a_doubtful_surface_is_not_believed_against_a_bound() -> None:
    """It said 1.37e-2 where no system of 2,300 had failed (F4)."""
    bound = Estimate(
        0.0, ci_low=0.0, ci_high=1.3e-3, ci_kind="clopper-pearson 95 % one-sided",
        error_kind="sampling", status="doubtful",
    )  # fmt: skip
    wide = replace(BY_SURFACE, std_error=2e-3, ci_low=9e-3, ci_high=2e-2, error_kind="surrogate")
    for surface in (BY_SURFACE, wide):
        row = best_of(surface, bound)
        assert (row.pf, row.ci_high, row.status) == (0.0, 1.3e-3, "doubtful")


def test_a_wide_simulation_does_not_replace_a_surface_within_its_interval() -> None:
    """The surface's number is told with the interval of the simulation (F5)."""
    wide = Estimate(
        4e-2, std_error=3e-2, ci_low=4e-3, ci_high=0.3, ci_kind="gamma 95 %",
        error_kind="sampling", status="doubtful", message="one sample makes 60 % of pf",
    )  # fmt: skip
    row = best_of(BY_SURFACE, wide)
    assert (row.pf, row.ci_low, row.ci_high) == (1.37e-2, 4e-3, 0.3)
    assert row.status == "doubtful"
    assert "runs would be enough" not in row.message
    assert "parrot found 0.04 +- 0.03, doubtful" in row.message
    # one that rests on a single sample lies too low, and is no bound for a surface
    low = replace(wide, pf=1e-9, std_error=8e-10, ci_low=1e-12, ci_high=4e-9)
    row = best_of(BY_SURFACE, low)
    assert (row.pf, row.ci_low, row.ci_high) == (1.37e-2, 1e-12, 1.37e-2)
    # what is doubted for other reasons than its width no number of runs makes good
    alone = best_of(wide)
    assert alone.pf == 4e-2
    assert "runs would be enough" not in alone.message
    assert "runs would be enough" in best_of(replace(wide, status="converged")).message
    narrow = replace(wide, std_error=4e-3, ci_low=3e-2, ci_high=5e-2)
    assert best_of(BY_SURFACE, narrow).pf == 4e-2


@pytest.mark.parametrize(
    ("found", "status"), [(1e-9, "converged"), (5.3e-10, "unchecked"), (1.5e-9, "unchecked")]
)
def test_a_check_in_doubt_that_differs_from_a_surface_has_not_confirmed_it(
    found: float, status: str
) -> None:
    """It said 5.3e-10 +- 0.9e-10, doubtful, of 1e-9, and the row read as checked."""
    surface = Estimate(
        1e-9, std_error=1e-12, ci_low=0.998e-9, ci_high=1.002e-9, error_kind="surrogate"
    )  # fmt: skip
    check = Estimate(
        found, std_error=8.5e-11, ci_low=found - 1.7e-10, ci_high=found + 1.7e-10,
        error_kind="sampling", status="doubtful", message="8 % of known failures",
    )  # fmt: skip
    row = best_of(surface, check)
    assert (row.pf, row.status) == (1e-9, status)
    assert ("not checked on the model" in row.message) == (status == "unchecked")


def test_settings_are_checked() -> None:
    """As those of any method."""
    with pytest.raises(ValueError, match=r"target = -1\.0"):
        uqfold.estimate(linear(1.0), target=-1.0)
    with pytest.raises(ValueError, match="check_runs = -1"):
        Automatic(check_runs=-1)


@pytest.mark.thorough
def test_what_kriging_doubts_is_put_to_polynomials() -> None:
    """Twenty inputs that are not normal; it was `doubtful` after 6,000 runs."""
    problem = named_problem("rp54").problem()
    result = uqfold.estimate(problem, rng=0)
    assert courses(result)[:2] == [("kriging", "answer"), ("pce", "answer")]
    assert result[0].status == "converged"
    assert problem.references is not None
    (right,) = problem.references
    assert abs(result[0].pf - right.pf) < 3.0 * result[0].std_error < 0.15 * right.pf
