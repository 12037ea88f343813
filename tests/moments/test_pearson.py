"""Every Pearson type against SciPy's distributions and against direct quadrature of its density."""

import itertools
import math
import time

import numpy as np
import pytest
from scipy import integrate, stats

from uqfold.moments.pearson import PearsonDistribution

LEVELS = np.array([1e-30, 1e-12, 1e-6, 1e-3, 0.1, 0.3])

CASES = {
    "I": stats.beta(2, 3),
    "I, J-shaped": stats.beta(0.5, 5),
    "I, U-shaped": stats.beta(0.3, 0.2),
    "I, nearly normal": stats.beta(80, 900),
    "II": stats.beta(3, 3),
    "II, uniform": stats.uniform(-1, 3),
    "II, U-shaped": stats.beta(0.05, 0.05),
    "III": stats.gamma(4),
    "III, J-shaped": stats.gamma(0.3),
    "III, exponential": stats.expon(),
    "III, nearly normal": stats.gamma(400),
    "V": stats.invgamma(6),
    "VI": stats.betaprime(3, 7),
    "VI, J-shaped": stats.betaprime(0.5, 5),
    "VII": stats.t(5),
    "VII, nearly normal": stats.t(300),
    "normal": stats.norm(3, 2),
}


def fitted(exact: stats.rv_continuous, sign: float = 1.0) -> PearsonDistribution:
    mean, variance, skewness, excess = (float(m) for m in exact.stats("mvsk"))
    found = PearsonDistribution.from_moments(
        sign * mean, math.sqrt(variance), sign * skewness, 3 + excess
    )
    assert isinstance(found, PearsonDistribution)
    return found


def test_points(exact: stats.rv_continuous) -> np.ndarray:
    """Quantiles down to 1e-30 on both sides, without those that round to an end, and the body."""
    with np.errstate(all="ignore"):
        y = np.concatenate([exact.ppf(LEVELS), [exact.median()], exact.isf(LEVELS[::-1])])
    y = np.concatenate([y, exact.mean() + exact.std() * np.linspace(-1.5, 1.5, 13)])
    low, high = exact.support()
    return np.unique(y[np.isfinite(y) & (y > low) & (y < high)])


test_points.__test__ = False  # type: ignore[attr-defined]


def rounding(exact: stats.rv_continuous, y: np.ndarray, probability: np.ndarray) -> np.ndarray:
    """Relative change of a tail when y moves by as much as rounding moves the fitted moments."""
    step = 2e-15 * (abs(exact.mean()) + 2 * exact.std() + np.abs(y))
    return step * exact.pdf(y) / probability


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["right", "mirrored"])
@pytest.mark.parametrize("name", CASES)
def test_tails_and_density_match_scipy(name: str, sign: float) -> None:
    exact, d = CASES[name], fitted(CASES[name], sign)
    y = test_points(exact)
    tails = {"cdf": exact.cdf(y), "sf": exact.sf(y)}
    found = {"cdf": d.cdf(sign * y), "sf": d.sf(sign * y)}
    if sign < 0:
        found = {"cdf": found["sf"], "sf": found["cdf"]}
    compared = 0
    for side, reference in tails.items():
        # Next to an end the float y itself does not say how far from the end it lies.
        allowed = 3e-12 + rounding(exact, y, reference)
        clear = allowed < 1e-6
        error = np.abs(found[side] / reference - 1)
        assert (error[clear] <= allowed[clear]).all(), (side, error[clear], allowed[clear])
        compared += int(clear.sum())
    assert compared >= y.size
    ends = np.array(exact.support())[:, None]
    body = (np.abs(y - ends) > 1e-3 * exact.std()).all(axis=0)
    body &= (tails["cdf"] > 1e-3) & (tails["sf"] > 1e-3)
    assert body.sum() >= 5
    np.testing.assert_allclose(d.pdf(sign * y[body]), exact.pdf(y[body]), rtol=1e-11)
    np.testing.assert_allclose(d.logpdf(sign * y[body]), exact.logpdf(y[body]), atol=1e-11)


@pytest.mark.parametrize("name", CASES)
def test_type_and_support(name: str) -> None:
    exact, d = CASES[name], fitted(CASES[name])
    assert d.type == name.split(",", maxsplit=1)[0]
    low, high = exact.support()
    scale = abs(exact.mean()) + exact.std()
    if d.type != "V":  # rounding of the moments tips it into IV, which has no end
        for found, expected in zip(d.support, (low, high), strict=True):
            if math.isinf(expected):
                assert found == expected or abs(found) > 1e6 * scale
            else:
                assert found == pytest.approx(expected, abs=1e-9 * scale)


@pytest.mark.parametrize("name", CASES)
def test_quantiles_invert_both_tails(name: str) -> None:
    exact, d = CASES[name], fitted(CASES[name])
    y = test_points(exact)
    y = y[(np.abs(y - np.array(exact.support())[:, None]) > 1e-6 * exact.std()).all(axis=0)]
    low = exact.cdf(y) <= 0.5
    tolerance = 1e-10 * (exact.std() + np.abs(y))
    assert (np.abs(d.ppf(d.cdf(y[low])) - y[low]) <= tolerance[low]).all()
    assert (np.abs(d.isf(d.sf(y[~low])) - y[~low]) <= tolerance[~low]).all()
    np.testing.assert_array_equal(d.ppf([0.0, 1.0]), d.support)
    np.testing.assert_array_equal(d.isf([1.0, 0.0]), d.support)


class TypeFour:
    """Closed form of type IV from its moments (Heinrich, CDF note 6820, 2004), by quadrature."""

    def __init__(self, skewness: float, kurtosis: float) -> None:
        b1 = skewness**2
        r = 6 * (kurtosis - b1 - 1) / (2 * kurtosis - 3 * b1 - 6)
        root = math.sqrt(16 * (r - 1) - b1 * (r - 2) ** 2)
        self.m = (r + 2) / 2
        self.nu = -r * (r - 2) * skewness / root
        self.a = root / 4
        self.shift = -(r - 2) * skewness / 4
        self.peak = self.log(self.shift - self.a * self.nu / (2 * self.m))
        self.total = self.integral(-math.inf, 0.0) + self.integral(0.0, math.inf)

    def log(self, z: float) -> float:
        u = (z - self.shift) / self.a
        return -self.m * math.log1p(u * u) - self.nu * math.atan(u)

    def density(self, z: float) -> float:
        return math.exp(self.log(z) - self.peak)

    def integral(self, low: float, high: float) -> float:
        if math.isinf(high):
            return self.integral(low, low + 2) + self.tail(low + 2, 1.0)
        if math.isinf(low):
            return self.integral(high - 2, high) + self.tail(high - 2, -1.0)
        return float(integrate.quad(self.density, low, high, epsabs=0, epsrel=1e-13)[0])

    def tail(self, start: float, sign: float) -> float:
        def inner(t: float) -> float:
            return self.density(start + sign * t / (1 - t)) / (1 - t) ** 2

        edges = np.linspace(0, 1, 21)
        return sum(
            float(integrate.quad(inner, a, b, epsabs=0, epsrel=1e-12, limit=400)[0])
            for a, b in itertools.pairwise(edges)
            if inner(0.5 * (a + b)) > 0
        )

    def sf(self, z: float) -> float:
        return self.integral(z, math.inf) / self.total


@pytest.mark.parametrize(
    ("skewness", "kurtosis", "exponent"),
    [
        (0.5, 4.0, 15.2),
        (0.05, 3.025, 287.529411764706),
        (0.10, 3.03, 406.0),
        (0.10, 3.0242, 658.804347826096),
        (-0.3, 3.3, 42.1818181818182),
        (1.0, 6.0, 10.0),
    ],
)
def test_type_four_against_quadrature_of_its_closed_form(
    skewness: float, kurtosis: float, exponent: float
) -> None:
    """Nearly normal ones with exponents of some hundred are the everyday case of the wing."""
    d, reference = PearsonDistribution(0, 1, skewness, kurtosis), TypeFour(skewness, kurtosis)
    assert d.type == "IV"
    assert 2 * reference.m == pytest.approx(exponent, rel=1e-10, abs=0)
    for z in (-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 5.0, 7.0):
        mirrored = TypeFour(-skewness, kurtosis)
        assert float(d.sf(z)) == pytest.approx(reference.sf(z), rel=3e-11, abs=0)
        assert float(d.cdf(z)) == pytest.approx(mirrored.sf(-z), rel=3e-11, abs=0)
        assert float(d.pdf(z)) == pytest.approx(
            reference.density(z) / reference.total, rel=1e-10, abs=0
        )


def test_sampling_follows_the_distribution() -> None:
    for name in ("I, U-shaped", "III", "VII"):
        d = fitted(CASES[name])
        draws = d.sample(np.random.default_rng(11), (500, 8))
        assert draws.shape == (500, 8)
        assert stats.kstest(draws.ravel(), d.cdf).pvalue > 1e-4
        # and the test can fail: shifted by a tenth of a standard deviation it does
        assert stats.kstest(draws.ravel() + 0.1 * d.std, d.cdf).pvalue < 1e-4


def test_nearly_normal_type_four_is_as_fast_as_others() -> None:
    # not by the clock of one machine
    y = np.linspace(-5, 5, 100)

    def seconds(skewness: float, kurtosis: float) -> float:
        found = []
        for _ in range(15):
            start = time.process_time()
            PearsonDistribution(0, 1, skewness, kurtosis).cdf(y)
            found.append(time.process_time() - start)
        return min(found)

    assert seconds(0.05, 3.02) < 10.0 * seconds(0.5, 4.5)
