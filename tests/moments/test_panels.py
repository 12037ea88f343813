import numpy as np
import pytest

from uqfold.moments import chebyshev
from uqfold.moments.panels import IntegrationError, integrals_up_to, integrate


def test_several_integrands_at_once() -> None:
    found = integrate(
        lambda x: np.stack([np.exp(-x), x**9, np.sqrt(x)]), np.array([0.0, 0.5, 2.0]), np.zeros(3)
    )
    expected = [1 - np.exp(-2), 2**10 / 10, 2**1.5 / 1.5]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("power", [-0.5, 0.1, 1.5])
def test_power_singularities_at_an_edge_are_resolved(power: float) -> None:
    found = integrate(lambda x: x[None] ** power, np.array([0.0, 1.0]), np.zeros(1), 1e-13)
    assert found[0] == pytest.approx(1 / (power + 1), rel=1e-9, abs=0)


def test_a_kink_inside_a_panel_is_found() -> None:
    found = integrate(lambda x: np.maximum(x - 0.3, 0.0)[None], np.array([0.0, 1.0]), np.zeros(1))
    assert found[0] == pytest.approx(0.245, rel=1e-11, abs=0)


def test_the_tolerance_counts_the_offset() -> None:
    """What is added to 1 needs few points; alone, the same integral needs more."""
    calls = []

    def spike(x: np.ndarray) -> np.ndarray:
        calls.append(x.size)
        return 1e-12 * np.exp(-(((x - 0.31) / 0.01) ** 2))[None]

    integrate(spike, np.array([0.0, 1.0]), np.ones(1))
    cheap = sum(calls)
    calls.clear()
    alone = integrate(spike, np.array([0.0, 1.0]), np.zeros(1))
    assert alone[0] == pytest.approx(1e-14 * np.sqrt(np.pi), rel=1e-11, abs=0)
    assert sum(calls) > 3 * cheap


def test_a_divergent_integral_is_refused() -> None:
    with pytest.raises(IntegrationError, match="60 bisections"):
        integrate(lambda x: 1 / x[None], np.array([0.0, 1.0]), np.zeros(1))


def test_empty_panels_do_not_count() -> None:
    found = integrate(lambda x: np.ones((1, x.size)), np.array([0.0, 1.0, 1.0, 3.0]), np.zeros(1))
    assert found[0] == pytest.approx(3.0, rel=1e-14, abs=0)
    assert integrate(lambda x: x[None], np.array([2.0, 2.0]), np.zeros(1))[0] == 0.0


def test_chebyshev_antiderivative() -> None:
    middle, half = np.array([0.5, 3.0]), np.array([0.5, 2.0])
    nodes = middle + half * chebyshev.NODES[:, None]
    sums = chebyshev.antiderivative(np.exp(nodes), half)
    np.testing.assert_allclose(
        chebyshev.at_right_edge(sums),
        np.e ** np.array([1, 5]) - np.e ** np.array([0, 1]),
        rtol=1e-14,
    )
    np.testing.assert_allclose(
        chebyshev.at_nodes(sums), np.exp(nodes) - np.exp(middle - half), rtol=1e-12
    )
    panel, x = np.array([0, 1, 1]), np.array([-1.0, 0.2, 1.0])
    expected = np.exp(middle[panel] + half[panel] * x) - np.exp((middle - half)[panel])
    np.testing.assert_allclose(chebyshev.evaluate(sums, panel, x), expected, rtol=1e-12, atol=1e-15)


def test_many_stops_share_the_panels_below_them() -> None:
    calls = []

    def integrand(x: np.ndarray) -> np.ndarray:
        calls.append(x.size)
        return np.stack([np.exp(-x), x**3])

    edges = np.linspace(0.0, 3.0, 31)
    stops = edges[[0, 5, 20, 20, 29]]
    found = integrals_up_to(integrand, edges, stops, np.zeros((2, 5)))
    np.testing.assert_allclose(found[0], -np.expm1(-stops), rtol=1e-13)
    np.testing.assert_allclose(found[1], stops**4 / 4, rtol=1e-13)
    assert sum(calls) == 29 * 15  # one rule each, and nothing beyond the last stop


def test_an_integrand_of_noise_is_refused_before_it_fills_the_memory() -> None:
    """tau of 1e-12 gave integrands of rounding noise, and panels without end."""
    largest = 0

    def noise(x: np.ndarray) -> np.ndarray:
        nonlocal largest
        largest = max(largest, x.size)
        return np.modf(1e9 * np.sin(1e6 * x))[0][None] ** 2

    with pytest.raises(IntegrationError, match="panels"):
        integrate(noise, np.linspace(0.0, 1.0, 1001), np.zeros(1))
    assert largest < 600_000
