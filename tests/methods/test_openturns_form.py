"""FORM against exact answers, and on the traps where FORM goes wrong without a word."""

import math
import re

import numpy as np
import openturns as ot
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.special import gammainccinv, log_ndtr, ndtr
from scipy.stats import beta as beta_law
from scipy.stats import chi

import uqfold
from uqfold import Binomial, Evaluator, criteria
from uqfold.inputs import normal
from uqfold.methods import SORM, ReliabilityMethod
from uqfold.methods.design_point import Search
from uqfold.methods.openturns_form import OpenTURNSFORM
from uqfold.methods.openturns_search import DesignPointSearch
from uqfold.methods.standard_space import Linearisation
from uqfold.testing.counting import RowCount
from uqfold.typing import FloatArray

MEAN, SHARED, INDIVIDUAL = 10.0, 0.6, 1.0
SIGMA = math.hypot(SHARED, INDIVIDUAL)
STANDARD = normal(0.0, 1.0)
FORM = OpenTURNSFORM()


class Counted:
    """Count the rows that a model sees."""

    def __init__(self, model) -> None:
        self.model, self.count = model, RowCount()

    @property
    def rows(self) -> int:
        return self.count.rows

    def __call__(self, x: FloatArray) -> FloatArray:
        self.count.add(x)
        return self.model(x)


def linear(x: FloatArray) -> FloatArray:
    return MEAN + SHARED * x[:, 0] + INDIVIDUAL * (0.6 * x[:, 1] + 0.8 * x[:, 2])


def linear_problem(units: int = 4, model=linear) -> uqfold.Problem:
    return uqfold.Problem(
        model, shared={"V": STANDARD}, individual={"U": STANDARD, "W": STANDARD}, units=units
    )


def limit_state(g, d: int = 2) -> uqfold.Problem:
    return uqfold.Problem.from_limit_state(g, {f"x{i}": STANDARD for i in range(d)})


def exact(threshold: float, units: int, missions: int | Binomial) -> float:
    """Integrate the failure probability over the shared input, without any complement."""

    def failure(v: float) -> float:
        log_q = units * log_ndtr((threshold - MEAN - SHARED * v) / INDIVIDUAL)
        if isinstance(missions, Binomial):
            fails = -math.expm1(missions.planned * math.log1p(missions.p * math.expm1(log_q)))
        else:
            fails = -math.expm1(missions * log_q)
        return fails * math.exp(-0.5 * v * v) / math.sqrt(2 * math.pi)

    parts = [quad(failure, a, a + 1, epsabs=0, epsrel=1e-11)[0] for a in range(-12, 12)]
    return math.fsum(parts)


class TestLinearNormal:
    @pytest.mark.parametrize("units", [1, 4])
    @pytest.mark.parametrize("missions", [1, 5, Binomial(6, 0.4)])
    def test_exact_from_the_body_to_the_tail(self, units: int, missions: int | Binomial) -> None:
        thresholds = [7.5, 9.0, 10.0, 11.0, 13.0, 15.0, 18.0]
        asked = criteria(thresholds, missions=missions)
        result = FORM.estimate(linear_problem(units), asked)
        expected = [exact(t, units, missions) for t in thresholds]
        assert expected[-1] < 1e-10
        assert result.pf == pytest.approx(expected, rel=1e-9)
        assert {row.status for row in result} == {"converged"}
        assert {row.error_kind for row in result} == {"surrogate"}
        least = np.minimum(result.pf, [row.reliability for row in result])
        assert all(row.std_error < 0.05 * small for row, small in zip(result, least, strict=True))

    def test_without_a_second_look_no_error_is_stated(self) -> None:
        """`starts` = 1 asks to skip the check: unchecked, and fewer runs."""
        checked = FORM.estimate(linear_problem(), criteria(13.0))
        row = OpenTURNSFORM(starts=1).estimate(linear_problem(), criteria(13.0))[0]
        assert (row.status, row.error_kind) == ("unchecked", "none")
        assert math.isnan(row.std_error)
        assert row.pf == checked.pf[0]
        assert row.n_evals < checked.n_evals

    def test_many_inputs_ask_for_few_more_runs(self) -> None:
        """A linear response is not asked for another search, nor for a matrix of curvatures."""
        weights = np.full(100, 0.1)
        row = FORM.estimate(limit_state(lambda x: 4.0 - x @ weights, 100))[0]
        assert row.status == "converged"
        assert row.pf == pytest.approx(ndtr(-4.0), rel=1e-9)
        assert row.n_evals < 22 * 100

    def test_beta_is_negative_where_the_origin_fails(self) -> None:
        details = FORM.estimate(linear_problem(), criteria([8.0, 12.0])).details
        low, high = details.design_points
        assert low.beta_hl == pytest.approx(-2.0 / SIGMA, rel=1e-12)
        assert high.beta_hl == pytest.approx(2.0 / SIGMA, rel=1e-12)
        # alpha points towards failure in both
        assert low.alpha == pytest.approx(high.alpha)
        assert high.alpha == pytest.approx(np.array([SHARED, 0.6, 0.8]) / SIGMA)
        assert high.u == pytest.approx(high.beta_hl * high.alpha, abs=1e-9)
        assert high.shared_fraction == pytest.approx(SHARED**2 / SIGMA**2)
        assert high.importance.sum() == pytest.approx(1.0)

    def test_reliability_is_no_complement_where_failure_is_certain(self) -> None:
        row = FORM.estimate(linear_problem(1), criteria(1.0))[0]
        assert row.reliability == pytest.approx(ndtr(-9.0 / SIGMA), rel=1e-9)
        assert row.beta == pytest.approx(-9.0 / SIGMA, rel=1e-9)

    def test_design_point_in_the_inputs_own_units(self) -> None:
        problem = uqfold.Problem(
            lambda x: x[:, 0] / 10.0 + x[:, 1], individual={"a": normal(50, 20), "b": normal(3, 1)}
        )
        point = FORM.estimate(problem, criteria(12.0)).details.design_points[0]
        assert point.x == pytest.approx(np.array([50, 3]) + np.array([20, 1]) * point.u)
        assert point.x[0] / 10.0 + point.x[1] == pytest.approx(12.0)

    def test_dependence_between_shared_and_individual_inputs(self) -> None:
        import openturns as ot

        correlation = ot.CorrelationMatrix(2)
        correlation[0, 1] = 0.6
        joint = ot.JointDistribution([ot.Normal(0, 1)] * 2, ot.NormalCopula(correlation))
        joint.setDescription(["U", "V"])
        problem = uqfold.Problem(lambda x: x[:, 0] + x[:, 1], inputs=joint, shared=["V"], units=3)
        # t = V + U = 1.6 V + 0.8 E
        expected = quad(
            lambda v: -math.expm1(3 * log_ndtr((5.0 - 1.6 * v) / 0.8))
            * math.exp(-0.5 * v * v)
            / math.sqrt(2 * math.pi),
            -12, 12, points=[0.0, 3.0], epsabs=0, epsrel=1e-10,
        )[0]  # fmt: skip
        assert FORM.estimate(problem, criteria(5.0)).pf[0] == pytest.approx(expected, rel=1e-8)

    def test_only_shared_inputs(self) -> None:
        problem = uqfold.Problem(lambda x: x[:, 0], shared={"V": STANDARD}, units=4)
        result = FORM.estimate(problem, criteria([2.0, 3.0], missions=3))
        assert result.pf == pytest.approx(ndtr([-2.0, -3.0]), rel=1e-9)


class TestCurvedLimitStates:
    def test_skewed_bounded_and_dependent_inputs_as_by_openturns_alone(self) -> None:
        """The cantilever beam of OpenTURNS, with its own distributions, event and search."""
        correlation = ot.CorrelationMatrix(4)
        correlation[2, 3] = -0.2
        copula = ot.NormalCopula(ot.NormalCopula.GetCorrelationFromSpearmanCorrelation(correlation))
        force = ot.LogNormalMuSigma(30.0, 4.0).getDistribution()
        marginals = (
            ot.Normal(3e4, 2e3),
            force,
            ot.Uniform(250.0, 260.0),
            ot.Beta(2.5, 4.0, 310, 450),
        )
        inputs = ot.JointDistribution(marginals, copula)
        inputs.setDescription(["E", "F", "L", "I"])
        g = ot.SymbolicFunction(["E", "F", "L", "I"], ["20 - F*L^3/(3*E*I)"])
        event = ot.ThresholdEvent(
            ot.CompositeRandomVector(g, ot.RandomVector(inputs)), ot.LessOrEqual(), 0.0
        )
        search = ot.AbdoRackwitz()
        search.setStartingPoint(inputs.getMean())
        direct = ot.FORM(search, event)
        direct.run()
        problem = uqfold.Problem.from_limit_state(lambda x: np.array(g(x))[:, 0], inputs)
        beta = direct.getResult().getHasoferReliabilityIndex()
        assert FORM.estimate(problem)[0].beta == pytest.approx(beta, abs=1e-3)
        inputs.setCopula(ot.IndependentCopula(4))
        independent = uqfold.Problem.from_limit_state(lambda x: np.array(g(x))[:, 0], inputs)
        assert abs(FORM.estimate(independent)[0].beta - beta) > 0.02

    @pytest.mark.parametrize(
        ("g", "status"),
        [
            (lambda x: 3 - x[:, 0] + 0.3 * x[:, 1] ** 2 - 0.5 * x[:, 1], "doubtful"),
            # fails on the other side too, a little farther out
            (lambda x: 2.5 - x[:, 0] - 0.1 * x[:, 1] + 0.05 * x[:, 0] ** 3, "doubtful"),
            (lambda x: 18 - np.exp(0.4 * x[:, 0] + 1.2) - np.exp(0.3 * x[:, 1] + 0.5), "converged"),
        ],
    )
    def test_beta_is_the_distance_of_the_nearest_failing_point(self, g, status: str) -> None:
        best = min(
            (
                minimize(
                    lambda u: u @ u, start, method="SLSQP", options={"ftol": 1e-13},
                    constraints={"type": "eq", "fun": lambda u: float(g(u[None, :])[0])},
                )
                for start in ([2.0, 0.5], [2.0, -0.5], [0.5, 2.0])
            ),
            key=lambda found: found.fun if found.success else math.inf,
        )  # fmt: skip
        result = FORM.estimate(limit_state(g))
        assert result[0].status == status
        point = result.details.design_points[0]
        # an error r of the point costs beta about r^2 / 2 times the curvature (below one here),
        # and the differences over 0.2 cost a few thousandths of the direction
        assert point.beta_hl == pytest.approx(math.sqrt(best.fun), abs=3e-3)
        assert result.pf[0] == pytest.approx(ndtr(-point.beta_hl), rel=1e-12)

    def test_smaller_tolerance_and_step_come_closer(self) -> None:
        def g(x: FloatArray) -> FloatArray:
            return 3 - x[:, 0] + 0.3 * x[:, 1] ** 2 - 0.5 * x[:, 1]

        # the nearest point of u1 = 3 + 0.3 u2^2 - 0.5 u2, from the stationarity of its distance
        roots = np.roots([0.18, -0.45, 3.05, -1.5])
        u2 = float(roots[np.abs(roots.imag) < 1e-9].real[0])
        nearest = math.hypot(3 + 0.3 * u2**2 - 0.5 * u2, u2)
        fine = OpenTURNSFORM(step=0.01, tolerance=1e-4)
        errors = [
            abs(m.estimate(limit_state(g)).details.design_points[0].beta_hl - nearest)
            for m in (FORM, fine)
        ]
        assert errors[0] < 1e-3
        assert errors[1] < 1e-8


def four_branch(x: FloatArray) -> FloatArray:
    a, b = x.T
    curve, root = 3 + 0.1 * (a - b) ** 2, math.sqrt(2)
    return np.min(
        [curve - (a + b) / root, curve + (a + b) / root, a - b + 7 / root, b - a + 7 / root], axis=0
    )


class TestTraps:
    """Where an unchecked FORM answers zero, or a wrong point without a word."""

    def test_zero_gradient_of_the_four_branch_function(self) -> None:
        result = FORM.estimate(limit_state(four_branch))
        assert result[0].status == "doubtful"
        assert "several design points" in result[0].message
        assert result.details.design_points[0].beta_hl == pytest.approx(3.0, abs=2e-3)

    def test_farthest_point_is_no_design_point(self) -> None:
        # (3, 0) is on the limit state and collinear, but (1, +-2) are nearer
        result = FORM.estimate(limit_state(lambda x: 3 - x[:, 0] - 0.5 * x[:, 1] ** 2))
        assert result[0].status == "doubtful"
        assert "several design points" in result[0].message
        assert result.details.design_points[0].beta_hl == pytest.approx(math.sqrt(5), abs=1e-3)

    def test_a_number_without_an_error_bar_is_not_called_converged(self) -> None:
        """FORM is wrong by two orders for a sum of exponentials, and curvature shows it."""
        ten = {f"x{i}": ot.Exponential(1.0) for i in range(10)}
        problem = uqfold.Problem(lambda x: x.sum(axis=1), individual=ten, units=1)
        row = FORM.estimate(problem, criteria(float(gammainccinv(10, 1e-7))))[0]
        assert row.pf < 1e-8
        assert (row.status, row.error_kind) == ("doubtful", "none")
        assert "curved" in row.message

    def test_equal_design_points_on_both_sides(self) -> None:
        result = FORM.estimate(limit_state(lambda x: 9 - x[:, 0] ** 2 - 0.001 * x[:, 0]))
        assert result[0].status == "doubtful"

    @pytest.mark.parametrize("shift", [0.0, 0.05, 0.2, 0.5])
    @pytest.mark.parametrize("threshold", [0.5, 1.5, 2.5])
    def test_half_of_pf_is_doubted(self, shift: float, threshold: float) -> None:
        """|a| has two design points, and FORM sees one: half of pf, or a little more."""
        problem = uqfold.Problem(
            lambda x: np.abs(x[:, 0] + shift), individual={"a": STANDARD, "b": STANDARD}
        )
        row = FORM.estimate(problem, criteria(threshold))[0]
        exact = ndtr(-threshold - shift) + ndtr(-threshold + shift)
        assert row.pf < 0.95 * exact
        assert row.status == "doubtful"

    def test_a_second_design_point_on_another_axis_is_doubted(self) -> None:
        problem = limit_state(lambda x: np.minimum(3.0 - x[:, 0], 3.2 - x[:, 1]))
        row = FORM.estimate(problem)[0]
        assert row.pf == pytest.approx(ndtr(-3.0), rel=1e-2)
        assert row.status == "doubtful"

    def test_limit_state_that_is_never_reached(self) -> None:
        def g(x: FloatArray) -> FloatArray:
            return 3 - x[:, 0] + 0.3 * x[:, 1] ** 2 + 0.1 * x[:, 0] ** 2 - 0.5 * x[:, 1]

        row = FORM.estimate(limit_state(g))[0]
        assert (row.pf, row.status) == (0.0, "doubtful")
        assert "on the other side of the threshold: taken for one that always works" in row.message

    def test_jump_to_infinity_has_no_design_point(self) -> None:
        def g(x: FloatArray) -> FloatArray:
            return np.where(x[:, 0] > 1, -np.inf, 5 - x[:, 0] - x[:, 1])

        result = FORM.estimate(limit_state(g))
        assert result[0].status == "failed"
        assert result.n_failed == 0

    @pytest.mark.parametrize("response", [1.0, np.inf])
    def test_a_response_that_is_always_the_same(self, response: float) -> None:
        problem = linear_problem(model=lambda x: np.full(len(x), response))
        for row in FORM.estimate(problem, criteria([0.5, 1.0, 2.0])):
            assert (row.pf, row.status) == (float(response > row.threshold), "doubtful")
            # the origin, and three places on both sides of the axes
            assert "no run out of 19, up to 10" in row.message

    def test_a_response_without_slope_that_jumps_further_out_fails(self) -> None:
        problem = linear_problem(model=lambda x: np.where(np.abs(x).max(axis=1) > 4.0, 3.0, 1.0))
        row = FORM.estimate(problem, criteria(2.0))[0]
        assert row.status == "failed"
        assert "the response has no gradient around the origin" in row.message

    def test_optimiser_that_settles_anywhere_is_not_believed(self, monkeypatch) -> None:
        # plant a point that OpenTURNS would hand back without a word
        def planted(self, algorithm, response, search: Search, point) -> None:
            wrong = response.linearise(np.array([0.1, 1.5, -1.0]))
            search.trace.append((wrong, algorithm))

        monkeypatch.setattr(DesignPointSearch, "_run", planted)
        curved = linear_problem(model=lambda x: linear(x) + 0.5 * x[:, 1] ** 2)
        row = FORM.estimate(curved, criteria(14.0))[0]
        assert row.status == "failed"

    def test_later_algorithms_get_their_turn(self) -> None:
        only = {}
        for algorithm in ("AbdoRackwitz", "SQP", "Cobyla"):
            method = OpenTURNSFORM(algorithms=(algorithm,))
            result = method.estimate(linear_problem(), criteria(13.0))
            assert result[0].status == "converged"
            point = result.details.design_points[0]
            assert point.algorithm == algorithm
            only[algorithm] = point.beta_hl
        assert list(only.values()) == pytest.approx([3.0 / SIGMA] * 3, rel=1e-9)

    def test_far_tail_and_infinite_thresholds(self) -> None:
        asked = criteria([-math.inf, -1e300, -1e5, 12.0, 1e5, 1e12, math.inf])
        result = FORM.estimate(linear_problem(), asked)
        assert result.pf[[0, 1, 2]].tolist() == [1.0] * 3
        assert result.pf[[4, 5, 6]].tolist() == [0.0] * 3
        assert [row.status for row in result] == ["doubtful"] * 3 + ["converged"] + ["doubtful"] * 3
        assert result.pf[3] == pytest.approx(exact(12.0, 4, 1), rel=1e-9)

    def test_tail_within_reach_has_a_number(self) -> None:
        result = FORM.estimate(linear_problem(1), criteria(MEAN + 9.9 * SIGMA))
        assert result[0].status == "converged"
        assert result.pf[0] == pytest.approx(ndtr(-9.9), rel=1e-9, abs=0.0)


class TestCost:
    asked = criteria([9.0, 11.0, 12.5, 14.0], missions=[1, 4])

    def test_runs_are_counted_and_shared_by_thresholds(self) -> None:
        model = Counted(linear)
        result = FORM.estimate(linear_problem(model=model), self.asked)
        assert result.n_evals == model.rows
        details = result.details
        assert details.n_evals_start == 7
        assert result.n_evals == 7 + sum(p.n_evals for p in details.design_points)
        # a linear response: per threshold two gradients and both looks; 100 runs are shared
        spent = [p.n_evals for p in details.design_points]
        assert sorted(spent)[2] <= 7 + 7 + 4 * 3 + 195 + 20 + 16
        assert max(spent) <= sorted(spent)[2] + 100

    @pytest.mark.parametrize("budget", [*range(1, 30), 40, 60, 80, 100])
    def test_budget_is_kept(self, budget: int) -> None:
        model = Counted(linear)
        result = FORM.estimate(linear_problem(model=model), self.asked, max_evals=budget)
        assert model.rows <= budget
        for row in result:
            if budget < 7:
                assert row.status == "failed"
            else:
                # the response is linear, so that even the first gradient tells it all
                assert row.status in {"converged", "budget_exhausted"}
                expected = exact(row.threshold, 4, int(row.missions))
                assert row.pf == pytest.approx(expected, rel=1e-9)

    def test_budget_that_ends_the_search_says_so(self) -> None:
        row = FORM.estimate(linear_problem(), criteria(12.5), max_evals=9)[0]
        assert row.status == "budget_exhausted"
        assert "from a design point" in row.message
        # found, but not looked around
        row = FORM.estimate(linear_problem(), criteria(12.5), max_evals=25)[0]
        assert row.status == "budget_exhausted"
        assert "not checked" in row.message

    @pytest.mark.parametrize(
        "model",
        [
            lambda x: np.abs(x[:, 0]),
            lambda x: np.abs(x[:, 0] + 0.3),
            lambda x: linear(x) - MEAN + 0.2 * x[:, 1] ** 2 + 0.1 * x[:, 0] * x[:, 2],
            lambda x: np.maximum(x[:, 0], x[:, 1]),
        ],
    )
    def test_a_row_is_the_same_alone_and_among_others(self, model) -> None:
        """Number, status and message depend on the row alone, whatever else is asked."""
        thresholds = [0.01, 0.8, 1.5, 2.0, 2.2, 3.5]
        together = FORM.estimate(linear_problem(model=model), criteria(thresholds))
        for threshold, among in zip(thresholds, together, strict=True):
            alone = FORM.estimate(linear_problem(model=model), criteria(threshold))[0]
            assert (alone.status, alone.message) == (among.status, among.message)
            assert alone.pf == among.pf or (math.isnan(alone.pf) and math.isnan(among.pf))


class TestConduct:
    def test_tau_is_unsupported_and_spoils_no_other(self) -> None:
        result = FORM.estimate(linear_problem(), criteria(12.0, tau=[None, 1.0]))
        assert [row.status for row in result] == ["converged", "unsupported"]
        assert "tau" in result[1].message

    def test_failed_run_ends_in_a_status(self) -> None:
        def lost(x: FloatArray) -> FloatArray:
            return np.where(x[:, 2] > 1.2, np.nan, linear(x))

        for row in FORM.estimate(linear_problem(model=lost), criteria([11.0, 14.0])):
            assert row.status == "failed"
            assert "returned NaN" in row.message
        counted = FORM.estimate(
            linear_problem(model=lost),
            criteria(10.5),
            evaluator=Evaluator(failed_runs="count-as-failure"),
        )
        assert counted.n_failed == 0 or counted[0].status == "doubtful"

    def test_interrupt_passes_through_openturns(self) -> None:
        calls = []

        def interrupted(x: FloatArray) -> FloatArray:
            calls.append(len(x))
            if len(calls) > 1:
                raise KeyboardInterrupt
            return linear(x)

        with pytest.raises(KeyboardInterrupt):
            FORM.estimate(linear_problem(model=interrupted), criteria(12.0))

    def test_openturns_is_left_as_it_was(self, capfd) -> None:
        import openturns as ot

        flags, state = ot.Log.Flags(), ot.RandomGenerator.GetState()
        FORM.estimate(limit_state(four_branch))
        FORM.estimate(limit_state(lambda x: 9.0 + x[:, 0] ** 2 + x[:, 1]))
        assert ot.Log.Flags() == flags
        assert list(ot.RandomGenerator.GetState().getBuffer()) == list(state.getBuffer())
        assert capfd.readouterr() == ("", "")

    @pytest.mark.parametrize(
        ("settings", "message"),
        [
            ({"step": 0.0}, "step = 0.0"),
            ({"tolerance": 0.5}, "tolerance = 0.5"),
            ({"max_iterations": 0}, "max_iterations = 0"),
            ({"starts": 0}, "starts = 0"),
            ({"algorithms": ()}, "at least one"),
            ({"algorithms": ("Newton",)}, "Newton"),
        ],
    )
    def test_settings_are_checked(self, settings: dict, message: str) -> None:
        with pytest.raises(ValueError, match=message):
            OpenTURNSFORM(**settings)


def test_a_point_is_judged_by_both_of_its_errors() -> None:
    on_plane_but_aside = Linearisation(np.array([1.0, 1.0]), 1.0, np.array([1.0, 0.0]))
    collinear_but_off = Linearisation(np.array([0.5, 0.0]), 0.5, np.array([1.0, 0.0]))
    right = Linearisation(np.array([1.0, 0.0]), 1.0, np.array([1.0, 0.0]))
    errors = [Search(1.0, [(p, "")]).error for p in (on_plane_but_aside, collinear_but_off, right)]
    assert errors == pytest.approx([1.0, 0.5, 0.0])


@pytest.mark.parametrize("curvature", [0.05, -0.1])
def test_curvature_that_matters_is_told_with_its_factor(curvature: float) -> None:
    """FORM was ``unchecked`` on a limit state whose curvature changes pf by a factor of two."""
    problem = uqfold.Problem(
        lambda x: x[:, 0] + curvature * (x[:, 1:] ** 2).sum(axis=1),
        individual=[STANDARD] * 6,
        names=list("abcdef"),
    )
    row = FORM.estimate(problem, criteria(4.0))[0]
    # over the radius r of the five curved directions
    exact = quad(lambda r: ndtr(curvature * r**2 - 4.0) * chi(5).pdf(r), 0.0, 12.0, epsabs=0.0)[0]
    assert row.status == "doubtful"
    assert "curved" in row.message
    second = float(re.findall(r"second order ([\d.e+-]+)", row.message)[0])
    assert second == pytest.approx(exact, rel=0.2)
    unchecked = OpenTURNSFORM(starts=1).estimate(problem, criteria(4.0))[0]
    factor = float(re.findall(r"probability times ([\d.e+-]+):", unchecked.message)[0])
    assert factor == pytest.approx(exact / row.pf, rel=0.2)


@pytest.mark.parametrize("curvature", [0.004, -0.004, 0.015])
def test_a_little_curvature_is_the_stated_error(curvature: float) -> None:
    """Second order within a tenth of FORM: converged, with their difference as the error."""
    problem = uqfold.Problem(
        lambda x: x[:, 0] + curvature * x[:, 1] ** 2 + 0.002 * x[:, 2] * x[:, 3],
        individual=[STANDARD] * 4,
        names=list("abcd"),
    )
    row = FORM.estimate(problem, criteria(3.5))[0]
    exact = quad(lambda u: ndtr(curvature * u**2 - 3.5) * chi(1).pdf(u), 0.0, 12.0, epsabs=0.0)[0]
    assert row.status == "converged"
    assert 0.5 < row.std_error / abs(exact - row.pf) < 2.0
    assert row.ci_low < exact < row.ci_high


def test_curvature_between_two_directions_is_seen() -> None:
    """u2 u3 is straight along both axes: a look along each of them alone sees a plane."""
    problem = limit_state(lambda x: 4.0 - x[:, 0] - 0.15 * x[:, 1] * x[:, 2], 3)
    row = FORM.estimate(problem)[0]
    assert row.status == "doubtful"
    assert "curved" in row.message
    many = limit_state(lambda x: 4.0 - x[:, 0] - 0.2 * x[:, 1] * x[:, 2], 12)
    assert FORM.estimate(many)[0].status == "doubtful"


def test_a_step_at_the_limit_state_is_doubted() -> None:
    """The differences see a slope where the response runs in steps of a twentieth."""
    problem = limit_state(lambda x: 3.0 - np.floor(20.0 * x[:, 0]) / 20.0)
    row = FORM.estimate(problem)[0]
    assert row.status != "converged" or abs(row.pf - ndtr(-3.05)) < 3.0 * row.std_error
    coarse = FORM.estimate(limit_state(lambda x: 3.01 - np.round(5.0 * x[:, 0]) / 5.0))[0]
    assert coarse.status != "converged"


@pytest.mark.parametrize(
    ("second", "status"), [((0.8, 0.6), "doubtful"), ((0.0, 0.0), "converged")]
)
def test_a_second_design_point_off_the_axes_is_named(second, status: str) -> None:
    """Found by a search from another start, and told with FORM's number and that of both."""
    direction = np.array([0.0, *second])
    problem = limit_state(lambda x: np.minimum(3.0 - x[:, 0], 3.1 - x @ direction), 3)
    row = FORM.estimate(problem)[0]
    assert row.status == status
    assert row.pf == pytest.approx(ndtr(-3.0), rel=1e-6)
    if status == "doubtful":
        both = float(re.findall(r"second order ([\d.e+-]+)", row.message)[0])
        assert both == pytest.approx(ndtr(-3.0) + ndtr(-3.1), rel=0.05)


def test_a_bend_between_all_directions_looked_at_is_seen() -> None:
    """Straight in every tangent direction, 15 percent more failures: only drawn points see it."""
    along, across = np.full(4, 0.5), np.array([1.0, 2.0, -2.0, -1.0]) / math.sqrt(10.0)
    problem = limit_state(lambda x: 3.0 - x @ along - np.maximum(0.0, x @ across - 1.8), 4)
    assert FORM.estimate(problem)[0].status == "doubtful"


@pytest.mark.parametrize(
    ("beta", "slope", "begins"),
    [(2.0, 1.0, 2.2), (2.0, 3.0, 2.6), (3.0, -3.0, 1.75), (4.0, 0.3, 1.9)],
)
@pytest.mark.parametrize("across", [(1.0, 0.0, 0.0), (0.6, 0.64, 0.48)])
def test_a_kink_further_out_than_curvature_is_seen(
    beta: float, slope: float, begins: float, across: tuple[float, float, float]
) -> None:
    """Failures beyond a kink were 2 to 10 percent of all, with an error of 0.5 percent stated."""
    problem = limit_state(
        lambda x: beta - x[:, 0] - slope * np.maximum(np.abs(x[:, 1:] @ across) - begins, 0.0), 4
    )
    row = FORM.estimate(problem)[0]
    v = np.linspace(-10.0, 10.0, 20_001)
    place = beta - slope * np.maximum(np.abs(v) - begins, 0.0)
    right = np.trapezoid(np.exp(-0.5 * v**2) / math.sqrt(2.0 * math.pi) * ndtr(-place), v)
    assert row.status == "doubtful" or abs(row.pf - right) < 3.0 * row.std_error


def test_a_band_that_ends_behind_the_design_point_is_doubted() -> None:
    """FORM believed all that lies beyond its plane, twice the band."""
    band = limit_state(lambda x: np.abs(x.sum(axis=1) / math.sqrt(5.0) - 3.2) - 0.1, 5)
    row = OpenTURNSFORM().estimate(band)[0]
    assert row.status == "doubtful"
    whole = limit_state(lambda x: 3.1 - x.sum(axis=1) / math.sqrt(5.0), 5)
    half = OpenTURNSFORM().estimate(whole)[0]
    assert half.status == "converged"


def test_the_target_decides_what_is_converged() -> None:
    """A tenth of the smaller probability was a constant beside the setting of all other methods."""
    bent = limit_state(lambda x: 3.0 - x[:, 0] - 0.1 * x[:, 1] ** 2)
    assert FORM.estimate(bent)[0].status == "doubtful"
    row = OpenTURNSFORM(target_cov=1.0).estimate(bent)[0]
    assert row.status == "converged"
    assert 0.1 * row.pf < row.std_error < row.pf
    straight = limit_state(lambda x: 3.0 - x[:, 0])
    assert FORM.estimate(straight)[0].status == "converged"
    assert OpenTURNSFORM(target_cov=1e-3).estimate(straight)[0].status == "doubtful"


def test_a_far_second_domain_is_part_of_the_stated_error() -> None:
    """Failure beyond 4 on another axis adds 2 percent, which no design point shows."""
    problem = limit_state(lambda x: np.where(x[:, 1] > 4.0, -np.inf, 3.0 - x[:, 0]))
    row = FORM.estimate(problem)[0]
    exact = ndtr(-3.0) + ndtr(-4.0)
    assert row.status == "converged"
    assert row.ci_low < exact < row.ci_high


def test_a_flat_limit_state_is_believed() -> None:
    problem = uqfold.Problem(
        lambda x: np.exp(0.1 * x.sum(axis=1)), individual=[STANDARD] * 4, names=list("abcd")
    )
    row = FORM.estimate(problem, criteria(math.exp(0.6)))[0]
    assert row.status == "converged"
    assert row.pf == pytest.approx(ndtr(-3.0), rel=1e-3)


@pytest.mark.parametrize(
    ("loading", "bend", "start", "threshold", "pf"),
    [
        # all units fail of one cause that is too rare to matter to a single one
        (0.0, 5.0, 4.0, 3.0, 1.1873e-6),
        # what they share does less than the plane says, beyond the design point of one
        (0.9, -3.0, 3.0, 2.0, 5.8038e-3),
        (0.9, 0.0, 0.0, 2.0, 6.5418e-3),
    ],
)
def test_the_plane_is_looked_at_where_units_in_parallel_fail_together(
    loading: float, bend: float, start: float, threshold: float, pf: float
) -> None:
    def shared(v: FloatArray) -> FloatArray:
        return loading * v + bend * np.maximum(v - start, 0.0)

    own = math.sqrt(1.0 - loading**2)
    problem = uqfold.Problem(
        lambda x: shared(x[:, 0]) + own * x[:, 1],
        shared={"V": STANDARD}, individual={"U": STANDARD}, units=3, structure=uqfold.Parallel(),
    )  # fmt: skip
    z = np.linspace(-9.0, 9.0, 9001)
    density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
    exact_pf = np.trapezoid(ndtr((shared(z) - threshold) / own) ** 3 * density, z)
    assert exact_pf == pytest.approx(pf, rel=1e-3)
    row = FORM.estimate(problem, uqfold.Criterion(threshold))[0]
    if bend == 0.0:
        assert row.status == "converged"
        assert row.pf == pytest.approx(exact_pf, rel=1e-6)
    else:
        assert row.status == "doubtful"
        assert "the system fails" in row.message


def test_a_search_that_leaves_its_space_is_no_failure() -> None:
    """OpenTURNS stepped to NaN near the bound of an input, and the row was `failed`."""

    def model(x: FloatArray) -> FloatArray:
        m = 0.25628371 * x[:, 0]
        own = 0.42194625 * (1.0 + 0.2 * np.tanh(m)) * x[:, 1]
        return np.asarray(m + 0.3 * m**2 / (1.0 + 0.1 * m**2) + own)

    problem = uqfold.Problem(
        model,
        shared={"V": beta_law(2.69511897, 2.55554326)},
        individual={"U": beta_law(1.54154595, 3.03295675)},
        units=[uqfold.Unit(offset=one) for one in (0.23171885, 0.0, -0.35939062, 0.0, 0.0)],
    )
    row = FORM.estimate(problem, criteria(0.89732724), rng=148)[0]
    assert row.status == "doubtful"
    assert 0.0 <= row.pf < 1e-3


@pytest.mark.parametrize("method", [FORM, SORM()], ids=["form", "sorm"])
def test_failures_before_the_design_point_are_seen(method: ReliabilityMethod) -> None:
    """On the ray to it; 97 % of pf was missing, `converged`."""

    def bump(x: FloatArray) -> FloatArray:
        a = x[:, 1] + 0.27
        return np.asarray(3.5333 - a - 1.7 * np.exp(-((1.7 * (a - 1.82)) ** 2)))

    row = method.estimate(limit_state(bump, 5))[0]
    assert row.status == "doubtful"
    assert "domain" in row.message


@pytest.mark.parametrize("method", [FORM, SORM()], ids=["form", "sorm"])
@pytest.mark.parametrize(("at", "width", "height"), [(2.0, 0.1, 2.0), (-1.5, 0.05, 3.0)])
@pytest.mark.parametrize("dimension", [2, 4])
def test_a_ridge_beside_the_design_point_is_seen(
    method: ReliabilityMethod, at: float, width: float, height: float, dimension: int
) -> None:
    """Narrow along one input: 47 to 89 % of pf were missing, `converged`."""
    row = method.estimate(
        limit_state(
            lambda x: 3.3 - x[:, 0] - height * np.exp(-(((x[:, -1] - at) / width) ** 2)), dimension
        )
    )[0]
    assert row.status == "doubtful"
