"""What independence costs: by the library's own algebra, and by sampling the model itself."""

import math

import pytest

import uqfold
from uqfold.analysis import independence
from uqfold.problems import series

GRID = uqfold.criteria([-2, 0, 2], None, 1)


def test_difference_of_dependence_and_of_its_sample() -> None:
    found = independence(series(), [2, 20], GRID, draws=200)
    assert found["units"].tolist() == [2] * 3 + [20] * 3
    # sixteen responses per draw cannot judge twenty units
    assert found.loc[found["units"] == 20, "sampled_difference"].isna().all()
    two = found[found["units"] == 2]
    z = (two["sampled_difference"] - two["difference"]) / two["sampled_std_error"]
    assert z.abs().max() < 4.0
    # Jensen: what is shared can only help a series system
    assert (found["difference"] > 0.0).all()
    assert two["difference"].tolist() == pytest.approx((two["pf_independent"] - two["pf"]).tolist())


def test_four_units_are_what_the_method_says_of_the_problem() -> None:
    found = independence(series(), [4], GRID)
    expected = uqfold.methods.FFNISaddlepoint().estimate(series(), GRID, rng=0).pf
    assert found["pf"].tolist() == pytest.approx(expected.tolist(), rel=1e-12)
    assert found["sampled_responses"].isna().all()


def test_what_cannot_be_asked_is_refused() -> None:
    with pytest.raises(TypeError, match="method = mc: it gives no conditional distributions"):
        independence(series(), [2], GRID, uqfold.methods.MonteCarlo(systems=10))
    with pytest.raises(ValueError, match=r"units\[0\] = 0"):
        independence(series(), [0], GRID)
    with pytest.raises(ValueError, match="draws = 1"):
        independence(series(), [2], GRID, draws=1)
    binomial = uqfold.criteria(0, None, uqfold.Binomial(2, 0.5))
    assert math.isnan(independence(series(), [2], binomial, draws=4)["sampled_difference"][0])
