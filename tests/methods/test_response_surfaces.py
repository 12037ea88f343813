"""Kriging and polynomial chaos: accuracy, stated errors, budgets, hard responses."""

import numpy as np
import pytest
from scipy.special import ndtr

from uqfold.inputs import normal
from uqfold.methods import FFNIPearson, Kriging, PolynomialChaos, ReliabilityMethod
from uqfold.methods.kriging import MAX_RUNS
from uqfold.problems import four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.system.surface_layout import laid_out
from uqfold.testing.counting import RowCount
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import FloatArray

SURFACES = (Kriging(), PolynomialChaos())
ids = [method.name for method in SURFACES]


def errors(method: ReliabilityMethod, problem: Problem, seeds: range) -> FloatArray:
    """Relative errors (seeds, rows) at 100 runs over the default grid."""
    assert problem.default_criteria is not None
    assert problem.references is not None
    found = [problem.references.lookup(c) for c in problem.default_criteria]
    exact = np.array([r.pf for r in found if r is not None])
    answers = [method.estimate(problem, max_evals=100, rng=seed) for seed in seeds]
    assert all(a.n_evals == 100 and a[0].status == "converged" for a in answers)
    return np.array([a.pf / exact - 1.0 for a in answers])


@pytest.mark.parametrize("method", SURFACES, ids=ids)
@pytest.mark.parametrize("build", [series, pytest.param(four_bar, marks=pytest.mark.thorough)])
def test_a_hundred_runs_answer_the_examples(method: ReliabilityMethod, build) -> None:
    found = np.sqrt(np.mean(errors(method, build(), range(1)) ** 2, axis=0))
    # rows reach from 0.5 to 3e-7, with and without tau
    assert found.max() < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_intervals_hold_the_truth_about_as_often_as_they_say(method: ReliabilityMethod) -> None:
    """A response that 40 runs cannot pin down, so that the surface has an error worth stating."""

    def response(x: FloatArray) -> FloatArray:
        return np.exp(0.2 * x[:, 0] + 0.3 * x[:, 1]) + 0.3 * np.sin(0.7 * x[:, 2])

    inputs = {"V": normal(0.0, 1.0)}, {"A": normal(0.0, 1.0), "B": normal(0.0, 1.0)}
    problem = Problem(response, shared=inputs[0], individual=inputs[1], units=2)
    asked = criteria([1.5, 3.0])
    system = laid_out(response, 3, 1, 2, asked)
    exact = np.array([found.pf for found in system.failures(response, asked)])
    rows = [method.estimate(problem, asked, max_evals=40, rng=seed) for seed in range(10)]
    inside = np.array(
        [[r.ci_low <= e <= r.ci_high for r, e in zip(row, exact, strict=True)] for row in rows]
    )
    z = np.array(
        [[(r.pf - e) / r.std_error for r, e in zip(row, exact, strict=True)] for row in rows]
    )
    # ten surfaces: three standard errors of a share of 95 % are 21 %
    assert inside.mean() >= 0.74
    assert np.sqrt(np.mean(z**2)) < 2.0
    # and the error is not merely overstated
    assert np.sqrt(np.mean(z**2)) > 0.1


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_one_surface_answers_all_criteria(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem(units=3, shared_std=0.5)
    asked = criteria([10.5, 12.0, 14.0], tau=[None, 2.5], missions=[1, 3, Binomial(4, 0.6)])
    result = method.estimate(system.problem(), asked, rng=1)
    assert result.n_evals == 100
    for criterion, row in zip(asked, result, strict=True):
        assert row.pf == pytest.approx(system.pf(criterion), rel=1e-4)
        assert row.error_kind == "surrogate"
        assert row.ci_low < row.pf < row.ci_high


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_far_tail_is_a_number(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem(units=1)
    criterion = Criterion(10.0 + 6.0 * np.hypot(0.3, 1.0))
    found = method.estimate(system.problem(), criterion, rng=3)[0]
    assert found.pf == pytest.approx(9.865876e-10, rel=1e-3)


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_fewer_runs_than_asked_for_say_so(method: ReliabilityMethod) -> None:
    problem = LinearNormalSystem().problem()
    row = method.estimate(problem, Criterion(12.0), max_evals=40, rng=1)[0]
    assert row.status == "budget_exhausted"
    assert "40 of the 100 runs" in row.message
    row = method.estimate(problem, Criterion(12.0), max_evals=7, rng=1)[0]
    assert row.status == "failed"
    assert row.n_evals == 0
    assert "at least 8" in row.message


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_a_response_that_no_surface_follows_is_doubtful(method: ReliabilityMethod) -> None:
    def ragged(x: FloatArray) -> FloatArray:
        return np.sin(40.0 * x[:, 0]) + np.sin(50.0 * x[:, 1])

    inputs = {"A": normal(0.0, 1.0), "B": normal(0.0, 1.0)}
    row = method.estimate(Problem(ragged, individual=inputs), Criterion(1.0), rng=1)[0]
    assert row.status == "doubtful"
    assert "predicts runs left out only to" in row.message


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_infinite_responses_count_as_failures_and_are_doubted(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem()

    def never_in_a_corner(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.0, np.inf, system.response(x))

    problem = Problem(
        never_in_a_corner,
        shared={"V": normal(0.0, 1.0)},
        individual={"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)},
        units=3,
    )
    row = method.estimate(problem, Criterion(1e5), rng=2)[0]
    assert row.status == "doubtful"
    assert "are infinite" in row.message
    # P(U > 1) = 0.159 for each of three units; the border is known from 100 runs
    assert row.pf == pytest.approx(0.405, rel=0.25)


@pytest.mark.parametrize("method", SURFACES, ids=ids)
def test_small_noise_of_the_model_is_part_of_the_response(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem(units=1, shared_std=0.0001, individual_std=1.0)

    def rough(x: FloatArray) -> FloatArray:
        return system.response(x) + 0.02 * np.sin(1e6 * x[:, 1] + 2e6 * x[:, 2])

    inputs = {"U": normal(0.0, 1.0), "W": normal(0.0, 1.0)}
    problem = Problem(rough, shared={"V": normal(0.0, 1.0)}, individual=inputs)
    row = method.estimate(problem, Criterion(12.0), rng=2)[0]
    assert row.status == "converged"
    assert row.pf == pytest.approx(system.pf(Criterion(12.0)), rel=0.05)
    assert row.std_error > 1e-3 * row.pf


def test_kriging_learns_the_noise_of_the_model() -> None:
    def rough(x: FloatArray) -> FloatArray:
        return x.sum(axis=1) + 0.03 * np.sqrt(2.0) * np.sin(1e6 * x[:, 0] + 2e6 * x[:, 1])

    inputs = {"A": normal(0.0, 1.0), "B": normal(0.0, 1.0)}
    details = Kriging().estimate(Problem(rough, individual=inputs), Criterion(3.0), rng=1).details
    assert details.surface.noise_std == pytest.approx(0.03, rel=0.35)
    assert details.relative_error == pytest.approx(0.03 / details.surface.y.std(), rel=0.4)


def test_kriging_has_a_ceiling() -> None:
    row = Kriging(runs=MAX_RUNS + 1).estimate(series(), Criterion(0.0), max_evals=50)[0]
    assert row.status == "unsupported"
    assert f"at most {MAX_RUNS}" in row.message
    assert row.n_evals == 0


@pytest.mark.parametrize("trend", ["constant", "linear", "quadratic", "pce"])
@pytest.mark.parametrize("kernel", ["gaussian", "matern52"])
def test_kriging_with_each_trend_and_kernel(trend, kernel) -> None:
    method = Kriging(runs=60, trend=trend, kernel=kernel)
    row = method.estimate(four_bar(), Criterion(102.0), rng=1)[0]
    assert row.pf == pytest.approx(0.01472050623593, rel=0.02)


@pytest.mark.thorough
def test_expansion_on_the_nodes_of_ffni_makes_better_use_of_its_runs() -> None:
    problem, seen, count = four_bar(), [], RowCount()

    def watched(x: FloatArray) -> FloatArray:
        if count.add(x):
            seen.append(x)
        return problem.model(x)

    watched_problem = Problem(
        watched,
        shared={"R_1": normal(53.0, 1.0)},
        individual={
            name: normal(m, 1.0) for name, m in (("R_2", 122), ("R_3", 66.5), ("R_4", 122))
        },
        units=2,
    )
    asked = criteria([100.0, 102.0, 104.0], tau=[None, 5.0])
    method = PolynomialChaos(design="ffni")
    assert not method.stochastic
    ours = method.estimate(watched_problem, asked)
    theirs = FFNIPearson(check=False).estimate(watched_problem, asked)
    assert ours.n_evals == theirs.n_evals == 375
    assert np.array_equal(seen[0], seen[1])
    assert problem.references is not None
    references = [problem.references.lookup(c) for c in asked]
    exact = np.array([r.pf for r in references if r is not None])
    assert np.abs(ours.pf / exact - 1.0).max() < 1e-3
    assert np.abs(ours.pf / exact - 1.0).max() < np.abs(theirs.pf / exact - 1.0).max()
    for row, value in zip(ours, exact, strict=True):
        assert row.ci_low <= value <= row.ci_high


def test_dependent_inputs_take_the_nodes_of_standard_normal_space() -> None:
    import openturns as ot

    joint = ot.JointDistribution(
        [ot.Normal(0.0, 1.0), ot.LogNormal(0.0, 0.3, 0.0), ot.Normal(1.0, 0.5)],
        ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.5, 0.2], [0.5, 1.0, 0.0], [0.2, 0.0, 1.0]])),
    )
    joint.setDescription(["V", "A", "B"])

    def response(x: FloatArray) -> FloatArray:
        return x[:, 0] + 2.0 * np.log(x[:, 1]) + x[:, 2]

    problem = Problem(response, inputs=joint, shared=["V"], units=1)
    # linear in normal variables with this covariance
    variance = 1.0 + 0.36 + 0.25 + 2.0 * (0.5 * 0.6 + 0.2 * 0.5)
    exact = float(ndtr(-(4.0 - 1.0) / np.sqrt(variance)))
    for method in (Kriging(runs=40), PolynomialChaos(runs=40), PolynomialChaos(design="ffni")):
        row = method.estimate(problem, Criterion(4.0), rng=1)[0]
        assert row.pf == pytest.approx(exact, rel=1e-3)


def test_sobol_indices_come_with_the_expansion() -> None:
    details = PolynomialChaos().estimate(four_bar(), Criterion(102.0), rng=1).details
    # the crank and the rocker hardly matter on the open branch
    assert details.sobol_indices.total[[0, 2]].max() < 0.01
    assert details.sobol_indices.total[[1, 3]].sum() == pytest.approx(1.0, abs=0.01)
    assert details.relative_error < 1e-3


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Kriging(runs=0), "runs = 0"),
        (lambda: Kriging(trend="cubic"), "trend = 'cubic'"),  # type: ignore[arg-type]
        (lambda: Kriging(kernel="rbf"), "kernel = 'rbf'"),  # type: ignore[arg-type]
        (lambda: Kriging(noise=-1.0), "noise = -1.0"),
        (lambda: Kriging(spread=9.0), "spread = 9.0"),
        (lambda: PolynomialChaos(runs=-3), "runs = -3"),
        (lambda: PolynomialChaos(max_degree=0), "max_degree = 0"),
        (lambda: PolynomialChaos(design="grid"), "design = 'grid'"),  # type: ignore[arg-type]
        (
            lambda: PolynomialChaos(design="ffni", nodes_shared=1),
            "nodes_shared = 1: give a whole number from 2",
        ),
        (lambda: Kriging(spread=1e-300), r"spread = 1e-300: give a number in \[1, 6\]"),
        (lambda: PolynomialChaos(sparse=1), "sparse = 1"),  # type: ignore[arg-type]
    ],
)
def test_bad_settings_are_refused(build, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        build()


@pytest.mark.parametrize("method", [Kriging(), PolynomialChaos()], ids=lambda method: method.name)
def test_responses_that_are_all_equal_say_nothing_of_another_one(method: ReliabilityMethod) -> None:
    """A narrow band that no run has met: it was pf = 0, error 0, converged."""

    def g(x: FloatArray) -> FloatArray:
        return np.where(np.abs(x[:, 0] - 0.37) < 0.001, -1.0, 1.0)

    problem = Problem.from_limit_state(g, {"a": normal(0.0, 1.0), "b": normal(0.0, 1.0)})
    for criterion in (problem.default_criteria, criteria(2.0)):
        row = method.estimate(problem, criterion, rng=1)[0]
        assert row.status == "doubtful"
        assert "all runs gave the same response" in row.message
        assert np.isnan(row.std_error)
        assert np.isnan(row.ci_high)


@pytest.mark.parametrize("method", SURFACES, ids=ids)
@pytest.mark.parametrize(
    ("margin", "d", "pf"),
    [
        # closed forms: chi-square, and quadrature over the sharp variable
        pytest.param(
            lambda x: 31.827_628_001_262_32 - (x**2).sum(axis=1),
            8,
            1e-4,
            id="all around in eight inputs",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            lambda x: 2.5 - x[:, 1] + 100.0 * x[:, 0] ** 4,
            2,
            1.068_661_487e-3,
            id="a sharp feature",
        ),
    ],
)
def test_integration_over_a_right_surface_errs_by_no_more_than_stated(
    method: ReliabilityMethod, margin, d: int, pf: float
) -> None:
    problem = Problem.from_limit_state(margin, {f"x{i}": normal(0.0, 1.0) for i in range(d)})
    row = method.estimate(problem, rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - pf) <= 3.0 * row.std_error
    assert row.pf == pytest.approx(pf, rel=5e-3)


@pytest.mark.slow
def test_a_far_threshold_leaves_the_surfaces_rows_beside_it_alone() -> None:
    """No rule resolves 20 units at 37 deviations: it made every row beside it doubtful."""
    problem = LinearNormalSystem(units=20, mean=0.0, shared_std=0.6, individual_std=0.8).problem()
    method = PolynomialChaos(runs=20)
    alone = method.estimate(problem, criteria(2.5), rng=1)[0]
    far, beside = method.estimate(problem, criteria([30.0, 2.5]), rng=1)
    assert (alone.status, beside.status, far.status) == ("converged", "converged", "doubtful")
    assert "too abruptly" in far.message
    assert (beside.pf, beside.std_error) == (alone.pf, alone.std_error)
