import math

import numpy as np
import pytest

import uqfold
from uqfold.evaluation import BudgetExceededError, Evaluator, FailedRunError
from uqfold.inputs import normal, product_inputs
from uqfold.methods.standard_space import (
    SEARCH_RADIUS,
    Linearisation,
    NoGradientError,
    StandardSpaceResponse,
)
from uqfold.typing import FloatArray


def response_of(
    model, d: int = 2, step: float = 0.1, allowed: int = 10**6
) -> StandardSpaceResponse:
    inputs = product_inputs(None, [normal(0.0, 1.0)] * d)
    return StandardSpaceResponse(inputs, Evaluator().session(model, d, None), step, allowed)


def plane(x: FloatArray) -> FloatArray:
    return 2.0 + 3.0 * x[:, 0] - 4.0 * x[:, 1]


class TestLinearisation:
    here = Linearisation(np.array([1.0, 0.5]), 3.0, np.array([3.0, -4.0]))

    def test_plane_through_the_threshold(self) -> None:
        # y = 2 + 3 u1 - 4 u2 = 12 has its foot at distance 2 along (0.6, -0.8)
        assert self.here.beta(12.0) == pytest.approx(2.0, rel=1e-15)
        assert self.here.beta(-8.0) == pytest.approx(-2.0, rel=1e-15)
        assert self.here.alpha == pytest.approx([0.6, -0.8])
        assert self.here.residual(12.0) == pytest.approx(math.hypot(1.0 - 1.2, 0.5 + 1.6))

    def test_enormous_threshold_does_not_overflow(self) -> None:
        assert self.here.beta(1e300) == pytest.approx(2e299)
        assert math.isfinite(self.here.residual(1e300))
        flat = Linearisation(np.zeros(1), 0.0, np.array([1e-20]))
        assert flat.residual(1e300) == math.inf


class TestResponse:
    def test_gradient_of_a_plane_is_exact_and_costs_2d_plus_1(self) -> None:
        response = response_of(plane)
        found = response.linearise(np.array([0.3, -0.2]))
        assert found.gradient == pytest.approx([3.0, -4.0], rel=1e-12)
        assert response.session.n_evals == 5

    def test_points_seen_before_cost_nothing(self) -> None:
        response = response_of(plane)
        first = response.linearise(np.zeros(2))
        again = response.linearise(np.array([-0.0, 0.0]))
        assert response.session.n_evals == 5
        assert first.y == again.y
        twice = response.values(np.array([[1.0, 1.0], [1.0, 1.0]]))
        assert response.session.n_evals == 6
        assert twice[0] == twice[1] == 1.0

    def test_central_differences_average_out_noise(self) -> None:
        # 2e-5 of noise on a slope of 1e-2: the error of the gradient stays below noise / step
        rng = np.random.default_rng(0)

        def noisy(x: FloatArray) -> FloatArray:
            return 0.5 + 1e-2 * x[:, 0] + rng.uniform(-2e-5, 2e-5, x.shape[0])

        found = response_of(noisy, step=0.2).linearise(np.zeros(2))
        assert found.gradient == pytest.approx([1e-2, 0.0], abs=1e-4)

    def test_budget_is_kept_and_nothing_half_run(self) -> None:
        response = response_of(plane, allowed=4)
        with pytest.raises(BudgetExceededError):
            response.linearise(np.zeros(2))
        assert response.session.n_evals == 0

    def test_failed_run_is_an_error(self) -> None:
        response = response_of(lambda x: np.where(x[:, 0] > 0.05, np.nan, 1.0))
        with pytest.raises(FailedRunError, match="returned NaN at x"):
            response.linearise(np.zeros(2))

    def test_response_is_frozen_beyond_the_search_radius(self) -> None:
        response = response_of(plane)
        far = np.array([[300.0, 400.0], [6.0, 8.0]])
        far[1] *= 1.0 + response.step / SEARCH_RADIUS
        y = response.values(far)
        assert y[0] == pytest.approx(y[1], rel=1e-12)

    def test_infinite_neighbour_makes_the_difference_one_sided(self) -> None:
        response = response_of(lambda x: np.where(x[:, 0] > 0.05, np.inf, plane(x)))
        assert response.linearise(np.zeros(2)).gradient == pytest.approx([3.0, -4.0])

    @pytest.mark.parametrize(
        ("model", "message"),
        [
            (lambda x: np.full(len(x), np.inf), "the response is inf at"),
            (lambda x: np.where(np.abs(x[:, 0]) > 0.05, np.inf, 1.0), "infinite on both sides"),
            (lambda x: np.ones(len(x)), "does not change"),
            (lambda x: x[:, 0] ** 2, "is stationary"),
        ],
    )
    def test_no_gradient_says_why(self, model, message: str) -> None:
        with pytest.raises(NoGradientError, match=message):
            response_of(model).linearise(np.zeros(2))

    def test_copula_between_shared_and_individual_passes_through(self) -> None:
        import openturns as ot

        correlation = ot.CorrelationMatrix(2)
        correlation[0, 1] = 0.6
        joint = ot.JointDistribution([ot.Normal(0, 1)] * 2, ot.NormalCopula(correlation))
        joint.setDescription(["V", "U"])
        problem = uqfold.Problem(lambda x: x[:, 0] + x[:, 1], inputs=joint, shared=["V"])
        session = Evaluator().session(problem.model, 2, None)
        found = StandardSpaceResponse(problem.inputs, session, 0.1, 100).linearise(np.zeros(2))
        # U = 0.6 V + 0.8 E
        assert found.gradient == pytest.approx([1.6, 0.8], rel=1e-9)
