"""Lines and rays drawn at random, where no product of rules resolves a surface."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import ndtr, ndtri
from scipy.stats import chi2, gamma

from uqfold.problems.criterion import criteria
from uqfold.system import drawn_rules
from uqfold.system.directions import DirectionMixture
from uqfold.system.lines import radial_mass, radial_reach
from uqfold.system.places import Places, failure_places
from uqfold.system.surface import reliability_indices
from uqfold.system.surface_layout import laid_out
from uqfold.typing import FloatArray

WANTED = np.array([1e-2, 1e-4, 1e-9])
FEW_POINTS = 100_000


def square(u: FloatArray) -> FloatArray:
    return np.asarray((u**2).sum(axis=1))


@pytest.mark.parametrize("d", [4, pytest.param(40, marks=pytest.mark.thorough)])
def test_failure_all_around_in_many_directions_is_known_to_one_percent(d: int) -> None:
    asked = criteria(chi2.isf(WANTED, d).tolist())
    system = laid_out(square, d, 0, 1, asked)
    responses = system.responses(square)
    found = system.failures_given(responses, asked)
    assert_allclose([one.pf for one in found], WANTED, rtol=1e-2)
    off = np.abs(reliability_indices(found) + ndtri(WANTED))
    assert (off <= 4.0 * system.integration_errors(responses, asked)).all()


def sharp(u: FloatArray) -> FloatArray:
    return np.asarray(u[:, 1] - 100.0 * u[:, 0] ** 4)


def sharp_pf(threshold: float) -> float:
    """By quadrature over the sharp variable."""
    x = np.linspace(-2.0, 2.0, 400_001)
    density = np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi)
    return float(np.trapezoid(density * ndtr(-(threshold + 100.0 * x**4)), x))


def test_a_sharp_feature_is_integrated_along_the_direction_that_leads_to_failure() -> None:
    """3.7 % off with lines along the steepest direction."""
    asked = criteria([2.5])
    [found] = laid_out(sharp, 2, 0, 1, asked).failures(sharp, asked)
    assert found.pf == pytest.approx(sharp_pf(2.5), rel=1e-4)


@pytest.mark.thorough
def test_stations_too_far_apart_for_a_sharp_feature_are_an_error() -> None:
    """Lines of 41 stations cannot follow a fourth power of 100: 40 % of pf, at a scatter of 3 %."""
    asked = criteria([2.5])
    system = laid_out(sharp, 5, 0, 1, asked)
    responses = system.responses(sharp)
    [found] = system.failures_given(responses, asked)
    off = abs(reliability_indices([found])[0] + ndtri(sharp_pf(2.5)))
    assert off <= 4.0 * system.integration_errors(responses, asked)[0]
    assert found.pf == pytest.approx(sharp_pf(2.5), rel=0.2)


@pytest.mark.parametrize("d", [8, pytest.param(40, marks=pytest.mark.thorough)])
def test_what_bends_in_many_directions_is_told_by_lines_at_adapted_places(d: int) -> None:
    """The sum of exponentials: at places drawn as the inputs are, errors are ten times as large."""
    wanted = np.array([1e-2, 1e-7])
    asked = criteria(gamma.isf(wanted, d).tolist())
    system = laid_out(exponentials, d, 0, 1, asked, FEW_POINTS)
    responses = system.responses(exponentials)
    index = reliability_indices(system.failures_given(responses, asked))
    error = system.integration_errors(responses, asked)
    assert (error > 2e-4).all()
    assert (error < 0.02).all()
    assert (np.abs(index + ndtri(wanted)) <= 4.0 * error).all()


def exponentials(u: FloatArray) -> FloatArray:
    return np.asarray(-np.log(ndtr(-u)).sum(axis=1))


def test_places_are_drawn_as_their_density_says() -> None:
    rng = np.random.default_rng(0)
    adapted = Places(np.array([[0.7, 0.0, -0.4]]), np.array([[1.5, 0.6, 2.0]]), np.ones(1))
    mixture = Places.of([(0.3, Places.unchanged(3)), (0.7, adapted)])
    drawn = mixture.draw(40_000, rng)
    inverse = np.exp(-mixture.log_density(drawn))
    for value, mean in ((np.ones(40_000), 1.0), (drawn[:, 0], 0.0), (drawn[:, 2] ** 2, 1.0)):
        weighted = inverse * value
        assert abs(weighted.mean() - mean) < 5.0 * weighted.std() / 200.0


def test_places_are_sought_on_both_sides_and_for_each_threshold() -> None:
    def failing(places: FloatArray) -> FloatArray:
        # far out at either end of the first variable; and beyond 4 in the second
        return np.array([ndtr(np.abs(places[:, 0]) - 5.0), ndtr(3.0 * (places[:, 1] - 4.0))])

    found = failure_places(failing, 2, np.random.default_rng(0))
    unchanged, ends, corner = zip(found.means, found.variances, strict=True)
    assert_allclose(unchanged, [[0.0, 0.0], [1.0, 1.0]])
    assert ends[1][0] > 5.0
    assert ends[1][1] < 2.0
    assert corner[0][1] == pytest.approx(4.0, abs=0.5)
    assert abs(corner[0][0]) < 0.5


def test_lines_and_rays_that_contradict_each_other_are_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def off(*_: object) -> Places:
        # lines at places that hold next to none of the failure, whose scatter does not show it
        return Places(np.full((1, 7), -1.0), np.full((1, 7), 0.2), np.ones(1))

    monkeypatch.setattr(drawn_rules, "places_of_failure", off)
    asked = criteria(gamma.isf([1e-5], 8).tolist())
    drawn = laid_out(exponentials, 8, 0, 1, asked, FEW_POINTS)
    responses = drawn.responses(exponentials)
    [found] = drawn.failures_given(responses, asked)
    gap = abs(reliability_indices([found])[0] + ndtri(1e-5))
    assert gap <= 4.0 * drawn.integration_errors(responses, asked)[0]


def test_several_failure_regions_off_the_axes_are_found_by_rays() -> None:
    """Four corners of a cube of five variables, far out; each holds a quarter of pf."""
    signs = np.array([[1, 1, 1, 1, 1], [1, -1, 1, -1, 1], [-1, 1, -1, -1, 1], [-1, -1, 1, 1, -1]])

    def corners(u: FloatArray) -> FloatArray:
        return np.asarray((u @ signs.T).max(axis=1) / np.sqrt(5.0))

    asked = criteria([4.5])
    system = laid_out(corners, 5, 0, 1, asked)
    responses = system.responses(corners)
    [found] = system.failures_given(responses, asked)
    [error] = system.integration_errors(responses, asked)
    # the regions overlap by less than 1e-4 of them
    assert abs(reliability_indices([found])[0] + ndtri(4.0 * ndtr(-4.5))) < 4.0 * error + 1e-3


@pytest.mark.parametrize("d", [2, 3, 10, 60])
def test_a_mixture_of_directions_draws_what_its_density_says(d: int) -> None:
    rng = np.random.default_rng(0)
    means = rng.standard_normal((3, d))
    means /= np.linalg.norm(means, axis=1, keepdims=True)
    narrow = DirectionMixture(means, np.array([0.5, 2.0, 1.0]) * d, np.array([0.5, 0.3, 0.2]))
    mixture = DirectionMixture.of([(0.3, DirectionMixture.uniform(d)), (0.7, narrow)])
    # the density has mean one over the sphere, and its inverse over its own draws
    uniform = rng.standard_normal((40_000, d))
    uniform /= np.linalg.norm(uniform, axis=1, keepdims=True)
    density = np.exp(mixture.log_density(uniform))
    assert abs(density.mean() - 1.0) < 5.0 * density.std() / 200.0
    drawn = mixture.draw(40_000, rng)
    assert_allclose(np.linalg.norm(drawn, axis=1), 1.0, rtol=1e-9)
    inverse = np.exp(-mixture.log_density(drawn))
    projected = inverse * (drawn @ means[0]) ** 2
    assert abs(projected.mean() - 1.0 / d) < 5.0 * projected.std() / 200.0


def test_a_fit_finds_the_directions_of_two_clusters() -> None:
    rng = np.random.default_rng(1)
    ends = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    true = DirectionMixture(ends, np.array([60.0, 60.0]), np.array([0.7, 0.3]))
    directions = true.draw(4000, rng)
    found = DirectionMixture.fitted(directions, np.ones(4000), 2, rng)
    order = np.argsort(-found.shares)
    assert_allclose(found.means[order], ends, atol=0.02)
    assert_allclose(found.shares[order], [0.7, 0.3], atol=0.03)
    assert_allclose(found.concentrations, 60.0, rtol=0.15)


@pytest.mark.parametrize("d", [1, 2, 7, 100])
def test_radii_have_the_chi_distribution_in_both_tails(d: int) -> None:
    edges = np.array([0.0, 0.1, 1.0, np.sqrt(d), np.sqrt(d) + 5.0, np.inf])
    exact = chi2.sf(edges[:-1] ** 2, d) - chi2.sf(edges[1:] ** 2, d)
    found = radial_mass(d, edges[:-1], edges[1:])
    assert_allclose(found[-2:], exact[-2:], rtol=1e-9)
    assert found.sum() == pytest.approx(1.0, abs=1e-12)
    assert chi2.sf(radial_reach(d) ** 2, d) == pytest.approx(1e-17, rel=1e-6)
