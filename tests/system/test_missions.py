from fractions import Fraction
from math import comb

import numpy as np
import pytest

from uqfold.problems.criterion import Binomial, Missions
from uqfold.system.missions import over_missions


def exact(p: Fraction, missions: Missions) -> tuple[float, float]:
    """Failure and success over missions by the sum of Eq. (30), in rational arithmetic."""
    if isinstance(missions, Binomial):
        n, r = missions.planned, Fraction(missions.p)
        works = sum(comb(n, k) * r**k * (1 - r) ** (n - k) * (1 - p) ** k for k in range(n + 1))
    else:
        works = (1 - p) ** missions
    return float(1 - works), float(works)


@pytest.mark.parametrize("missions", [1, 2, 50, Binomial(10, 0.7), Binomial(3, 1.0)], ids=str)
@pytest.mark.parametrize("p", ["0", "1e-18", "1e-12", "1e-3", "0.5", "0.7", "1"])
def test_against_rational_arithmetic(p: str, missions: Missions) -> None:
    fails = Fraction(p)
    failure, success = over_missions(float(fails), float(1 - fails), missions)
    expected = exact(fails, missions)
    assert float(failure) == pytest.approx(expected[0], rel=1e-13, abs=0)
    assert float(success) == pytest.approx(expected[1], rel=1e-13, abs=0)


def test_a_tiny_success_probability_keeps_its_digits() -> None:
    """1 - p would be 0 here: success must come from the success of one mission."""
    failure, success = over_missions(1.0, 1e-20, 2)
    assert float(success) == pytest.approx(1e-40, rel=1e-12, abs=0)
    assert float(failure) == 1.0
    _, flown = over_missions(1.0, 1e-20, Binomial(2, 0.5))
    assert float(flown) == pytest.approx(0.25, rel=1e-14, abs=0)


def test_no_planned_flight_takes_place() -> None:
    failure, success = over_missions(np.array([0.3, 1.0]), np.array([0.7, 0.0]), Binomial(4, 0.0))
    np.testing.assert_array_equal(failure, 0.0)
    np.testing.assert_array_equal(success, 1.0)


def test_shape_is_kept() -> None:
    failure, success = over_missions(np.full((2, 3), 0.1), np.full((2, 3), 0.9), 2)
    assert failure.shape == success.shape == (2, 3)
    np.testing.assert_allclose(failure, 0.19, rtol=1e-14)


def test_at_least_one_mission() -> None:
    with pytest.raises(ValueError, match="missions = 0"):
        over_missions(0.1, 0.9, 0)
