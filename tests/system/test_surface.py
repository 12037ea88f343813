"""Integration over a cheap surface, with the true response as the surface."""

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import log_ndtr, ndtr, ndtri
from scipy.stats import chi2, ncx2

from uqfold.problems import four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.problems.structure import Parallel
from uqfold.system.conditional import SystemProbability, system_failures
from uqfold.system.decision_diagram import diagram
from uqfold.system.lines import FINITE, MISSING, NEVER
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem, reliability_indices
from uqfold.system.surface_layout import laid_out, laid_out_apart
from uqfold.system.surface_plan import plan_surface
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray, IntArray


def true_surface(problem: Problem) -> Surface:
    return lambda u: problem.model(problem.inputs.from_standard_normal(u))


def surface_failures(
    surface: Surface, dimension: int, n_shared: int, units: int, asked: Sequence[Criterion]
) -> list[SystemProbability]:
    return laid_out(surface, dimension, n_shared, units, asked).failures(surface, asked)


@pytest.mark.parametrize("build", [series, four_bar, lambda: four_bar("crossed")])
def test_examples_follow_their_references_down_to_1e_9(build) -> None:
    problem = build()
    assert problem.references is not None
    references = [r for r in problem.references if r.pf >= 1e-9][::7]
    inputs = problem.inputs
    found = surface_failures(
        true_surface(problem),
        inputs.dimension,
        inputs.n_shared,
        problem.n_units,
        [r.criterion for r in references],
    )
    # the grid holds rows with and without tau, fixed and binomial numbers of missions
    assert {r.criterion.tau is None for r in references} == {True, False}
    assert any(isinstance(r.criterion.missions, Binomial) for r in references)
    assert_allclose([f.pf for f in found], [r.pf for r in references], rtol=1e-3)


def test_several_failure_regions_are_found() -> None:
    def four_branches(u: FloatArray) -> FloatArray:
        a, b = u.T
        root = np.sqrt(2.0)
        arcs = 3.0 + 0.1 * (a - b) ** 2 - np.abs(a + b) / root
        return -np.minimum(arcs, 7.0 / root - np.abs(a - b))

    p = np.linspace(-9.0, 9.0, 20_001)
    density = np.exp(-0.5 * p**2) / np.exp(-0.5 * p**2).sum()
    exact = [
        density @ np.where(np.abs(p) > 3.5 + t / np.sqrt(2), 1.0, 2 * ndtr(-3 - 0.2 * p**2 - t))
        for t in (0.0, 1.0, 2.0)
    ]
    found = surface_failures(four_branches, 2, 0, 1, criteria([0.0, 1.0, 2.0]))
    assert_allclose([f.pf for f in found], exact, rtol=3e-3)


def test_failure_at_both_ends_and_all_around() -> None:
    def square(u: FloatArray) -> FloatArray:
        return (u**2).sum(axis=1)

    line = surface_failures(square, 1, 0, 1, criteria([1.0, 9.0, 25.0]))
    assert_allclose([f.pf for f in line], chi2.sf([1.0, 9.0, 25.0], 1), rtol=3e-4)
    plane = surface_failures(square, 2, 0, 1, criteria([1.0, 9.0, 25.0]))
    assert_allclose([f.pf for f in plane], chi2.sf([1.0, 9.0, 25.0], 2), rtol=2e-3)


@pytest.mark.parametrize("share", [0.3, 0.9, 0.99])
def test_strongly_shared_inputs(share: float) -> None:
    own = np.sqrt(1.0 - share**2)
    v = np.linspace(-9.0, 9.0, 40_001)
    density = np.exp(-0.5 * v**2) / np.exp(-0.5 * v**2).sum()
    thresholds = [0.0, 3.0, 6.0]
    exact = [
        density @ -np.expm1(4 * np.log1p(-np.minimum(ndtr(-(t - share * v) / own), 1 - 1e-16)))
        for t in thresholds
    ]
    found = surface_failures(
        lambda u: share * u[:, 0] + own * u[:, 1], 2, 1, 4, criteria(thresholds)
    )
    assert_allclose([f.pf for f in found], exact, rtol=1e-4)


def test_reliability_is_the_complement_and_both_are_computed() -> None:
    found = surface_failures(lambda u: u @ np.ones(3), 3, 1, 2, criteria([-12.0, 0.0, 12.0]))
    for one in found:
        assert one.pf + one.reliability == pytest.approx(1.0, abs=1e-12)
    assert 0.0 < found[0].reliability < 1e-9
    assert 0.0 < found[2].pf < 1e-9


def test_everything_shared_makes_units_and_missions_fail_together() -> None:
    asked = [Criterion(1.0), Criterion(1.0, 0.0, 5), Criterion(1.0, None, Binomial(3, 0.5))]
    found = surface_failures(lambda u: u[:, 0], 1, 1, 4, asked)
    assert_allclose([f.pf for f in found], ndtr(-1.0) * np.array([1.0, 1.0, 0.875]), rtol=1e-9)


def test_one_unit_in_one_mission_needs_no_shared_nodes() -> None:
    system = laid_out(lambda u: u.sum(axis=1), 3, 2, 1, criteria([3.0]))
    assert system.weights.size == 1


def test_a_constant_surface_is_a_step_at_its_value() -> None:
    value = 0.1 + 0.2
    below = float(np.nextafter(value, 0.0))
    found = surface_failures(
        lambda u: np.full(u.shape[0], value), 3, 1, 4, criteria([value, below], tau=[None, 0.0])
    )
    assert [f.pf for f in found] == [0.0, 1.0, 0.0, 1.0]


def test_noise_widens_the_distribution() -> None:
    system = laid_out(lambda u: u[:, 1], 2, 1, 3, criteria([4.0]))
    noisy = system.failures(lambda u: u[:, 1], criteria([4.0]), noise=0.5)[0]
    alone = float(ndtr(-4.0 / np.sqrt(1.25)))
    assert noisy.pf == pytest.approx(-np.expm1(3 * np.log1p(-alone)), rel=1e-3)


def test_infinite_and_missing_regions_have_their_probability() -> None:
    def outcomes(u: FloatArray) -> IntArray:
        far = u[:, 1] + 0.5 * u[:, 2]
        return np.select([far > 2.0, far < -2.0], [NEVER, MISSING], default=FINITE)

    def surface(u: FloatArray) -> FloatArray:
        # says nothing about where the holes are
        return 0.1 * u[:, 0] + u[:, 1]

    asked = criteria([1e3, -1e3], missions=[1, 2])
    system = laid_out(surface, 3, 1, 1, asked, complete=False)
    found = system.failures(surface, asked, outcomes)
    hole = float(ndtr(-2.0 / np.sqrt(1.25)))
    # borders are known to half the distance between points, 0.2 standard deviations
    assert found[0].pf_low == pytest.approx(hole, rel=0.25)
    assert found[0].pf_high == pytest.approx(2.0 * hole, rel=0.25)
    assert found[1].pf_low == pytest.approx(1.0 - hole, rel=0.01)
    assert found[1].pf_high == pytest.approx(1.0)
    assert found[2].pf_high == pytest.approx(1.0 - (1.0 - 2.0 * hole) ** 2, rel=0.25)


def test_a_surface_that_is_not_finite_is_refused() -> None:
    def broken(u: FloatArray) -> FloatArray:
        return np.where(u[:, 1] > 3.0, np.nan, u[:, 1])

    with pytest.raises(ValueError, match="not finite"):
        surface_failures(broken, 2, 0, 1, criteria([1.0]))


def test_scarce_points_are_admitted() -> None:
    def round_about(u: FloatArray) -> FloatArray:
        return (u**2).sum(axis=1)

    plan = plan_surface(round_about, 5, 0)
    rule = plan.rule(40_000)
    assert not rule.resolved
    assert rule.points.shape[0] <= 40_000
    found = system_failures(
        rule.responses(round_about(rule.points)), rule.weights, 1, criteria(9.0)
    )
    assert found[0].pf == pytest.approx(chi2.sf(9.0, 5), rel=0.2)


def test_changes_follow_other_surfaces() -> None:
    def surface(u: FloatArray) -> FloatArray:
        return 0.4 * u[:, 0] + u[:, 1] + 0.05 * u[:, 1] ** 2

    asked = criteria([2.0, 4.0], tau=[None, 3.0])
    system = laid_out(surface, 2, 1, 3, asked)
    shifts = np.array([0.0, 0.1, -0.1])
    found = system.changes(surface, lambda u: surface(u) + shifts[:, None], asked)
    assert found.shape == (3, 4)
    assert_allclose(found[0], 0.0, atol=1e-12)
    before = np.array([f.pf for f in system.failures(surface, asked)])
    after = np.array([f.pf for f in system.failures(lambda u: surface(u) + 0.1, asked)])
    assert_allclose(found[1], ndtri(before) - ndtri(after), rtol=0.05, atol=2e-3)


@pytest.mark.parametrize("shared", [0.5, 1.0, 3.0])
def test_many_responses_that_share_a_strong_cause(shared: float) -> None:
    """Failure of 40 responses is steep in the shared variable; known from a sum over it."""
    units, missions, std = 4, 10, 0.5 if shared == 3.0 else 1.0
    total = np.hypot(shared, std)
    asked = [Criterion(float(score * total), None, missions) for score in (0.5, 1.5, 3.0, 4.5)]
    found = surface_failures(
        lambda u: shared * u[:, 0] + std * u[:, 1], 2, 1, units, asked
    )  # fmt: skip
    v = np.linspace(-9.0, 9.0, 20_001)
    weights = np.exp(-0.5 * v**2) / np.exp(-0.5 * v**2).sum()
    for criterion, one in zip(asked, found, strict=True):
        unit = ndtr((shared * v - criterion.threshold) / std)
        exact = weights @ -np.expm1(units * missions * np.log1p(-np.minimum(unit, 1.0 - 1e-16)))
        assert abs(ndtri(one.pf) - ndtri(exact)) < 1e-6


def test_units_that_share_a_steep_input_are_told_within_the_stated_error() -> None:
    """Few shared nodes or few lines drawn were 20 % off, at a stated error of 2 to 8 %.

    Of a Gumbel input a that units share, and uniform c and b of their own: a c / 10 - b. Two more
    inputs are shared, without any influence.
    """

    def surface(u: FloatArray) -> FloatArray:
        a = 8.0 - np.log(-np.log1p(-ndtr(-u[:, 0])))
        b, c = 1.0 + 2.0 * ndtr(u[:, 3]), 8.0 + 4.0 * ndtr(u[:, 4])
        return np.asarray(a * c / 10.0 - b)

    x, w = np.polynomial.legendre.leggauss(400)
    a, of_a = 18.0 + 13.0 * x, 13.0 * w
    of_a = of_a * np.exp(-(a - 8.0) - np.exp(-(a - 8.0)))
    b = 2.0 + x
    limits = np.array([10.0])
    cells = np.clip((12.0 - 10.0 * (limits[:, None, None] + b) / a[:, None]) / 4.0, 0.0, 1.0)
    alone = cells @ (0.5 * w)
    exact = (1.0 - (1.0 - alone) ** 4) @ of_a
    asked = criteria(limits.tolist())
    system = laid_out(surface, 5, 3, 4, asked)
    responses = system.responses(surface)
    index = reliability_indices(system.failures_given(responses, asked))
    error = system.integration_errors(responses, asked)
    assert (np.abs(index + ndtri(exact)) <= 3.0 * error).all()
    assert (error < 0.02).all()


@pytest.mark.parametrize(("threshold", "honest"), [(6.0, True), (8.0, False)])
def test_shared_inputs_further_out_than_all_nodes_are_part_of_the_error(
    threshold: float, honest: bool
) -> None:
    """Three units in parallel fail where what they share is beyond 7.5 standard deviations."""
    own = math.sqrt(0.19)

    def surface(u: FloatArray) -> FloatArray:
        return np.asarray(0.9 * u[:, 0] + own * u[:, 1])

    system = laid_out(
        surface, 2, 1,
        SystemUnits(3, diagram(Parallel(), ("a", "b", "c"))), criteria(threshold),
    )  # fmt: skip
    responses = system.responses(surface)
    error = system.integration_errors(responses, criteria(threshold))[0]
    z = np.linspace(-9.0, 20.0, 20_001)
    failure = np.exp(3.0 * log_ndtr((0.9 * z - threshold) / own) - 0.5 * z**2)
    exact = -ndtri(np.trapezoid(failure, z) / math.sqrt(2.0 * math.pi))
    found = system.indices(surface, criteria(threshold))
    assert (error < 1e-2) == honest
    assert (abs(found[0] - exact) < 1e-3) == honest


@pytest.mark.parametrize(("inputs", "points"), [(20, 10_000), (40, 20_000)])
def test_what_lines_and_rays_do_not_contradict_has_a_known_error(inputs: int, points: int) -> None:
    """Curvature in 100 inputs: 0.8 % off, and doubted, where worse rules drawn at random were not.

    The sum of squares is a noncentral chi-square variable.
    """
    slope, curvature = inputs**-0.5, 0.1 * inputs**-0.5

    def bent(u: FloatArray) -> FloatArray:
        return np.asarray((slope * u + curvature * u**2).sum(axis=1))

    asked, centre = [Criterion(6.0)], inputs * (0.5 * slope / curvature) ** 2
    exact = -ndtri(ncx2.sf(6.0 / curvature + centre, inputs, centre))
    system = laid_out(bent, inputs, 0, 1, asked, points)
    responses = system.responses([bent])
    [found] = reliability_indices(system.failures_given(responses, asked))
    [error] = system.integration_errors(responses, asked)
    assert system.resolved
    assert system.rules[0].error > 3e-3
    assert abs(found - exact) < error < 0.02


def test_criteria_that_no_rule_resolves_are_laid_out_apart() -> None:
    """One far out made all beside it doubtful; what is resolved here follows from the index."""
    index = np.array([30.0, 3.0, -1.0, 2.5, -9.0, 7.9])
    laid: list[list[int]] = []

    def lay(rows: Sequence[int]) -> SurfaceSystem:
        laid.append(list(rows))
        resolved = bool((np.abs(index[laid[-1]]) < 8.0).all())
        return cast(SurfaceSystem, SimpleNamespace(resolved=resolved))

    def apart(count: int) -> list[tuple[list[int], bool]]:
        parts = laid_out_apart(lay, lambda _: index[:count], count)
        return [(rows, system.resolved) for rows, system in parts]

    assert apart(6) == [([1, 2, 3, 5], True), ([0, 4], False)]
    # the whole, the nearest one, and what halving tries
    assert len(laid) <= 2 + 3
    assert apart(1) == [([0], False)]
    index[2] = index[1] = index[3] = 8.5
    # where the nearest is not resolved either, the surface is at fault
    laid.clear()
    assert apart(4) == [([0, 1, 2, 3], False)]
    assert len(laid) == 2
    index[:4] = 1.0
    assert apart(4) == [([0, 1, 2, 3], True)]


def test_a_steep_rise_that_stations_step_over_is_a_stated_error() -> None:
    """Quadrature was 17 % off with 0.7 % stated: it was refined along other lines."""

    def rising(u: FloatArray) -> FloatArray:
        # as between the parts of a mixture of inputs
        return 0.5 * u[:, 0] + 3.5 * ndtr((u[:, 0] - 1.645) / 0.02) + u[:, 1]

    asked = [Criterion(6.0)]
    system = laid_out(rising, 2, 0, 1, asked)
    x = np.linspace(-9.0, 9.0, 180_001)
    mean = rising(np.column_stack([x, np.zeros(x.size)]))
    density = np.exp(-0.5 * x**2) / math.sqrt(2.0 * math.pi)
    exact = -ndtri(np.trapezoid(density * ndtr(mean - 6.0), x))
    responses = system.responses(rising)
    [found] = reliability_indices(system.failures_given(responses, asked))
    [error] = system.integration_errors(responses, asked)
    assert abs(found - exact) < 2.0 * error


@pytest.mark.parametrize(("radius", "distance"), [(0.1, (1.5, -0.3)), (0.2, (1.1, 1.1))])
def test_a_small_ball_that_refinement_steps_over_is_seen(
    radius: float, distance: tuple[float, float]
) -> None:
    """Half of pf was lost with 0.5 % stated: 33 lines, or five, went by on both sides."""

    def surface(u: FloatArray) -> FloatArray:
        away = np.hypot(u[:, 0] + distance[0], u[:, 1] + distance[1])
        return np.maximum(u[:, 0] - 3.0, radius - away)

    asked = [Criterion(0.0)]
    system = laid_out(surface, 2, 0, 1, asked)
    responses = system.responses(surface)
    found = system.failures_given(responses, asked)[0].pf
    exact = ndtr(-3.0) + ncx2.cdf(radius**2, 2, distance[0] ** 2 + distance[1] ** 2)
    apart = abs(ndtri(found) - ndtri(exact))
    assert apart < min(0.02, 3.0 * float(system.integration_errors(responses, asked)[0]))


def test_failure_all_around_is_integrated_within_the_stated_error() -> None:
    """Lines touch the circle: 0.32 % off, and 0.1 % stated."""

    def surface(u: FloatArray) -> FloatArray:
        return np.asarray((u**2).sum(axis=1))

    asked = [Criterion(16.0)]
    system = laid_out(surface, 2, 0, 1, asked)
    responses = system.responses(surface)
    apart = abs(ndtri(system.failures_given(responses, asked)[0].pf) - ndtri(math.exp(-8.0)))
    assert apart < 2.0 * float(system.integration_errors(responses, asked)[0])


@pytest.mark.parametrize("inputs", [10, 100])
def test_failure_all_around_far_out_is_told_by_rays_however_lines_contradict(inputs: int) -> None:
    """Lines saw a hundredth of pf = 1e-9, rays all of it: their distance was an error of both."""

    def surface(u: FloatArray) -> FloatArray:
        return np.asarray((u**2).sum(axis=1))

    asked = [Criterion(float(chi2.isf(1e-9, inputs)))]
    system = laid_out(surface, inputs, 0, 1, asked)
    responses = system.responses(surface)
    assert system.failures_given(responses, asked)[0].pf == pytest.approx(1e-9, rel=0.01)
    assert system.integration_errors(responses, asked)[0] < 1e-3
