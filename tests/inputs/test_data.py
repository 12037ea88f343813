"""Inputs of which there are measured values."""

import math
import pickle
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.special import ndtr

from uqfold import Problem
from uqfold.inputs import JointInputs, from_data, product_inputs
from uqfold.methods import MonteCarlo

RNG = np.random.default_rng(1)
SYMMETRIC, SKEWED = RNG.normal(2.0, 0.1, 200), RNG.exponential(size=200)
U = np.linspace(-6.0, 6.0, 13)


def only(distribution: Any) -> JointInputs:
    return product_inputs(None, {"x": distribution})


def test_smoothed_values_keep_mean_and_variance_and_nearly_the_steps() -> None:
    """Beyond the values they fall off as a kernel does; both ways agree, also when pickled."""
    inputs = only(from_data(SYMMETRIC))
    assert str(inputs.columns[0]) == "from_data(200 values)"
    assert inputs.means[0] == pytest.approx(SYMMETRIC.mean(), rel=1e-6)
    assert inputs.standard_deviations[0] == pytest.approx(SYMMETRIC.std(ddof=1), rel=1e-5)
    x = inputs.from_standard_normal(U[:, None])
    np.testing.assert_allclose(inputs.to_standard_normal(x)[:, 0], U, atol=1e-6)
    steps = (np.arange(200) + 0.5) / 200
    found = ndtr(inputs.to_standard_normal(np.sort(SYMMETRIC)[:, None])[:, 0])
    assert np.abs(found - steps).max() < 0.05
    assert SYMMETRIC.max() < x[-1, 0] < SYMMETRIC.max() + 0.25
    again = pickle.loads(pickle.dumps(inputs))
    np.testing.assert_array_equal(again.from_standard_normal(U[:, None]), x)
    row = MonteCarlo(systems=4000).estimate(
        Problem(lambda x: x[:, 0], individual={"x": from_data(SYMMETRIC)}), 2.1, rng=1
    )[0]
    assert abs(row.pf - np.mean(SYMMETRIC > 2.1)) < 0.04


def test_a_bound_is_kept_and_costs_little() -> None:
    inputs = only(from_data(SKEWED, bounds=(0.0, math.inf)))
    x = inputs.from_standard_normal(U[:, None])
    assert (x > 0.0).all()
    np.testing.assert_allclose(inputs.to_standard_normal(x)[:, 0], U, atol=1e-5)
    assert inputs.means[0] == pytest.approx(SKEWED.mean(), rel=0.05)


@pytest.mark.parametrize(
    ("family", "law"),
    [
        ("normal", stats.norm(10.0, 2.0)),
        ("lognormal", stats.lognorm(0.5, scale=2.0)),
        ("weibull", stats.weibull_min(2.5, scale=3.0)),
        ("gamma", stats.gamma(3.0, scale=2.0)),
        ("exponential", stats.expon(scale=2.0)),
        ("gumbel", stats.gumbel_r(1.0, 2.0)),
        ("logistic", stats.logistic(1.0, 2.0)),
    ],
)
def test_a_fit_finds_the_family_again(family: str, law: Any) -> None:
    inputs = only(from_data(law.isf((np.arange(50) + 0.5) / 50), family))
    assert inputs.means[0] == pytest.approx(law.mean(), rel=0.05)
    assert inputs.standard_deviations[0] == pytest.approx(law.std(), rel=0.1)


@pytest.mark.parametrize("family", ["normal", "weibull"])
def test_a_family_that_the_values_contradict_is_refused(family: str) -> None:
    values = np.concatenate([SYMMETRIC[:40], SYMMETRIC[:40] + 2.0])
    with pytest.raises(ValueError, match=r"the values contradict it \(Anderson-Darling, p = 0.005"):
        from_data(values, family)


@pytest.mark.parametrize(
    ("data", "options", "said"),
    [
        (SYMMETRIC[:9], {}, "give 10 to 10,000 values, not 9"),
        (np.round(SYMMETRIC, 1), {}, "of 200 values differ, as of something discrete"),
        (SKEWED, {}, r"on the other side of zero: give bounds=\(0, inf\), or a family"),
        (SYMMETRIC, {"bounds": (0.0, 2.0)}, "give bounds around all values"),
        (SYMMETRIC - 2.0, {"family": "weibull"}, "give positive values for the family"),
        (SYMMETRIC, {"family": "normal", "bounds": (0.0, 9.0)}, "a family has its own"),
        (SYMMETRIC, {"family": "log-normal"}, "did you mean 'lognormal'"),
        (SYMMETRIC * 1e300, {}, "give them in another unit, the largest one 1e-50 to 1e\\+50"),
        (SYMMETRIC * 1e-300, {"family": "normal"}, "give them in another unit"),
        (1.0 + 1e-15 * np.arange(99), {"family": "lognormal"}, "give differences instead"),
        (1e12 + SYMMETRIC, {}, "they differ by less than 1e-09 of the largest: give differences"),
        (np.exp(300.0 * (SYMMETRIC - 2.0)), {"family": "gamma"}, "cannot be fitted|contradict it"),
    ],
)
def test_what_says_too_little_is_refused(data: Any, options: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        from_data(data, **options)


@pytest.mark.parametrize("size", [1e-49, 1e49])
def test_the_unit_of_values_does_not_matter(size: float) -> None:
    for family in (None, "normal", "logistic"):
        inputs, usual = (
            only(from_data(SYMMETRIC * size, family)),
            only(from_data(SYMMETRIC, family)),
        )
        found, known = (one.from_standard_normal(U[:, None]) for one in (inputs, usual))
        np.testing.assert_allclose(found / size, known, rtol=1e-6)


def test_nothing_is_no_data() -> None:
    with pytest.raises(TypeError, match=r"data = None: give finite real numbers of shape \(n,\)"):
        from_data(None)  # type: ignore[arg-type]
