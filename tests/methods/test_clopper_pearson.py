import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, binomtest

from uqfold.methods.clopper_pearson import clopper_pearson


@pytest.mark.parametrize(("failures", "n"), [(1, 10), (7, 10), (9, 10), (3, 100_000), (500, 1000)])
def test_two_sided_interval_agrees_with_scipy(failures: int, n: int) -> None:
    expected = binomtest(failures, n).proportion_ci(0.95, method="exact")
    assert clopper_pearson(failures, n) == pytest.approx((expected.low, expected.high), rel=1e-9)


@pytest.mark.parametrize("n", [1, 30, 10**7])
@pytest.mark.parametrize("level", [0.9, 0.95, 0.999])
def test_without_a_failure_the_bound_is_one_sided(n: int, level: float) -> None:
    low, high = clopper_pearson(0, n, level)
    assert low == 0.0
    # the definition: a probability at the bound still gives no failure with probability 1 - level
    assert math.exp(n * math.log1p(-high)) == pytest.approx(1.0 - level, rel=1e-7)


def test_nothing_but_failures_mirrors_no_failure() -> None:
    low, high = clopper_pearson(40, 40)
    assert high == 1.0
    assert 1.0 - low == pytest.approx(clopper_pearson(0, 40)[1], rel=1e-14)


@given(st.integers(1, 10**6), st.data())
def test_interval_holds_the_estimate_and_is_ordered(n: int, data: st.DataObject) -> None:
    failures = data.draw(st.integers(0, n))
    low, high = clopper_pearson(failures, n)
    assert 0.0 <= low <= failures / n <= high <= 1.0
    if failures < n:
        up = clopper_pearson(failures + 1, n)
        assert low <= up[0]
        assert high <= up[1]


def test_coverage_is_exact_or_better_but_for_the_stated_gap() -> None:
    n = 60
    k = np.arange(n + 1)
    ends = np.array([clopper_pearson(int(i), n) for i in k])
    one_sided, two_sided = 1.0 - 0.05 ** (1 / n), 1.0 - 0.025 ** (1 / n)
    lowest = 1.0
    for p in np.linspace(0.001, 0.999, 1997):
        held = (ends[:, 0] <= p) & (p <= ends[:, 1])
        coverage = float(binom.pmf(k, n, p)[held].sum())
        distance = min(p, 1.0 - p)
        if not one_sided <= distance <= two_sided:
            assert coverage >= 0.95, p
        lowest = min(lowest, coverage)
    assert 1.5 * 0.95 - 0.5 <= lowest < 0.95


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 0), "at least one sample"),
        ((-1, 5), "failures = -1"),
        ((6, 5), "failures = 6"),
        ((1, 5, 1.0), "level = 1.0"),
        ((1, 5, math.nan), "level = nan"),
    ],
)
def test_bad_arguments_are_named(arguments: tuple[int, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        clopper_pearson(*arguments)
