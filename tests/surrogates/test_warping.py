"""Transformations of strongly scaled responses: found where they help, and only there."""

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from scipy import special

from uqfold.inputs import normal
from uqfold.methods import Kriging, PolynomialChaos
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.task import Task
from uqfold.methods.warped import WarpedSurface, warp_for
from uqfold.problems import Problem, Unit
from uqfold.problems.criterion import Criterion, criteria
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.warping import Warp, find_warp
from uqfold.typing import FloatArray


def along(x: FloatArray) -> FloatArray:
    return np.asarray(x.sum(axis=1) / math.sqrt(x.shape[1]))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("power", [-1.0, 0.0, 1.0 / 6.0])
def test_a_transformation_and_its_inverse(side: float, power: float) -> None:
    warp = Warp(origin=-3.0, side=side, scale=2.0, power=power)
    y = -3.0 + side * np.geomspace(1e-3, 1e3, 50)
    np.testing.assert_allclose(warp.inverse(warp(y)), y, rtol=1e-9)
    assert (np.diff(warp(np.sort(y))) > 0.0).all()
    ends = np.array([-np.inf, np.inf, np.nan, -3.0])
    np.testing.assert_array_equal(warp(ends), [-np.inf, np.inf, np.nan, -side * np.inf])


@pytest.mark.parametrize(
    ("model", "power", "origin"),
    [
        (lambda s: np.exp(3.0 * s), 0.0, 0.0),
        (lambda s: 100.0 - np.exp(3.0 * s), 0.0, 100.0),
        (lambda s: 1.0 / (12.0 - s), -1.0, 0.0),
        (lambda s: (12.0 + s) ** 6, 1.0 / 6.0, 0.0),
    ],
    ids=["exponential", "with an offset", "reciprocal", "power"],
)
def test_it_is_found_from_the_runs(
    model: Callable[[FloatArray], FloatArray], power: float, origin: float
) -> None:
    u = space_filling_design(100, 3, np.random.default_rng(0), spread=2.0)
    warp = find_warp(u, model(along(u)))
    assert warp is not None
    assert (warp.power, warp.origin) == pytest.approx((power, origin), abs=1e-4)


@pytest.mark.parametrize(
    "model",
    [lambda s: s, lambda s: s + 0.1 * s**2, lambda s: s**2, np.abs, np.round, np.zeros_like],
    ids=["linear", "bent", "square", "kink", "steps", "constant"],
)
def test_other_responses_stay_as_they_are(model: Callable[[FloatArray], FloatArray]) -> None:
    u = space_filling_design(100, 3, np.random.default_rng(0), spread=2.0)
    assert find_warp(u, model(along(u))) is None


@pytest.mark.parametrize(
    "method", [PolynomialChaos(), Kriging(runs=40)], ids=lambda one: str(one.name)
)
def test_a_response_over_decades_is_answered_in_its_tail(method: Any) -> None:
    """Polynomials of exp(3 u) gave 0, those of its logarithm are exact."""
    problem = Problem(lambda x: np.exp(3.0 * along(x)), individual=[normal(0.0, 1.0)] * 3)
    pf = np.array([1e-3, 1e-5, 1e-7])
    found = method.estimate(problem, criteria(np.exp(-3.0 * special.ndtri(pf))), rng=0)
    assert [row.status for row in found] == ["converged"] * 3
    np.testing.assert_allclose([row.pf for row in found], pf, rtol=1e-3)
    surface = found.details.surface
    assert isinstance(surface, WarpedSurface)
    u = np.array([[0.5, -1.0, 2.0], [4.0, 4.0, 4.0]])
    np.testing.assert_allclose(surface.mean(u), problem.model(u), rtol=1e-2)
    drawn = surface.sample_paths(np.random.default_rng(0), 2)(u)
    np.testing.assert_allclose(drawn, np.broadcast_to(problem.model(u), (2, 2)), rtol=0.1)


def test_differences_of_responses_are_those_of_the_model() -> None:
    """Neither tau, nor offsets of units, nor a threshold beyond the origin is transformed."""
    u = space_filling_design(40, 2, np.random.default_rng(0))
    runs = DesignRuns(u, np.exp(2.0 * along(u)), 40)

    def warped(criterion: Criterion, **units: Any) -> bool:
        problem = Problem(along, individual=[normal(0.0, 1.0)] * 2, **units)
        return warp_for(Task(problem, (criterion,), 0, cast(Any, None)), runs) is not None

    assert warped(Criterion(100.0))
    assert warped(Criterion(math.inf), units=3)
    assert not warped(Criterion(-1.0))
    assert not warped(Criterion(100.0), units=[Unit(), Unit(offset=0.5)])
    assert not warped(Criterion(100.0, 1.0), units=2)
