"""Criteria: validation, equality, labels, and the grid of all combinations."""

import math
import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from uqfold.problems.criterion import Binomial, Criteria, Criterion, criteria


@pytest.mark.parametrize("planned", [1, 10, np.int64(4), 6.0, np.float64(6.0)])
def test_binomial_takes_whole_numbers_of_any_type(planned: Any) -> None:
    binomial = Binomial(planned, 0.5)
    assert binomial.planned == planned
    assert type(binomial.planned) is int


@pytest.mark.parametrize(
    "planned", [0, -1, 2.5, math.nan, math.inf, True, "3", None, np.array([3]), 1 + 0j]
)
def test_binomial_refuses_other_numbers_of_flights(planned: Any) -> None:
    with pytest.raises((ValueError, TypeError), match=r"^planned = .*: give a whole number >= 1"):
        Binomial(planned, 0.5)


@pytest.mark.parametrize("p", [-1e-300, 1.0 + 1e-15, math.nan, math.inf, -math.inf, "0.5", True])
def test_binomial_refuses_what_is_no_probability(p: Any) -> None:
    with pytest.raises((ValueError, TypeError), match=r"^p = .*: give a probability in \[0, 1\]"):
        Binomial(4, p)


def test_binomial_label_and_ends() -> None:
    assert str(Binomial(10, 0.7)) == "binomial(10, 0.7)"
    assert Binomial(1, 0) == Binomial(1, 0.0)
    assert Binomial(1, 1).p == 1.0


@pytest.mark.parametrize("threshold", [0, -1.5, math.inf, -math.inf, np.float32(2), Fraction(1, 2)])
def test_threshold_is_any_number_but_nan(threshold: Any) -> None:
    value = Criterion(threshold).threshold
    assert type(value) is float
    assert value == threshold


def test_bad_thresholds_are_refused() -> None:
    for threshold in (math.nan, 10**400, "5", b"x", True, None, 5j, [1.0]):
        with pytest.raises(
            (ValueError, TypeError), match=r"^threshold = .*: give a number or \+-inf"
        ):
            Criterion(threshold)  # type: ignore[arg-type]
    for threshold in (b"x", "5", {"a": 1.0}, True, None, [], ["5"]):  # b"x" counted as 120
        with pytest.raises((ValueError, TypeError), match=r"^threshold = "):
            criteria(threshold)  # type: ignore[arg-type]


@pytest.mark.parametrize("tau", [-1e-12, math.nan, -math.inf])
def test_bad_tau_is_refused(tau: float) -> None:
    with pytest.raises(ValueError, match="give a number >= 0, or None"):
        Criterion(1.0, tau)


@pytest.mark.parametrize("tau", [0, 0.0, math.inf, np.float64(0.04)])
def test_tau_becomes_a_float(tau: Any) -> None:
    assert type(Criterion(1.0, tau).tau) is float


@pytest.mark.parametrize("missions", [0, -3, 1.5, math.nan, math.inf, False, "2", None, [1]])
def test_bad_missions_are_refused(missions: Any) -> None:
    wanted = r"^missions = .*: give a Binomial or a whole number >= 1"
    with pytest.raises((ValueError, TypeError), match=wanted):
        Criterion(1.0, missions=missions)


def test_criteria_of_equal_content_are_equal_keys() -> None:
    # references are looked up by criterion
    a = Criterion(np.float64(4), 0, np.int64(2))
    b = Criterion(4.0, 0.0, 2)
    assert a == b
    assert hash(a) == hash(b)
    assert Criterion(0.0) == Criterion(-0.0)
    assert Criterion(4.0) != Criterion(4.0, 0.0)
    assert Criterion(4.0, None, 1) != Criterion(4.0, None, Binomial(1, 1.0))
    assert Criterion(0.1 + 0.2) != Criterion(0.3)


def test_largest_number_of_missions() -> None:
    assert Criterion(1.0, missions=7).max_missions == 7
    assert Criterion(1.0, missions=Binomial(9, 0.1)).max_missions == 9


def test_labels() -> None:
    assert str(Criterion(0.55, 0.04, 5)) == "T = 0.55, tau = 0.04, m = 5"
    assert str(Criterion(math.inf, missions=Binomial(2, 0.5))) == "T = inf, m = binomial(2, 0.5)"


def test_thresholds_run_fastest_then_missions_then_tau() -> None:
    grid = criteria(threshold=[1, 2], tau=[None, 0.5], missions=[1, Binomial(4, 0.5)])
    assert [(c.threshold, c.missions, c.tau) for c in grid] == [
        (t, m, tau) for tau in (None, 0.5) for m in (1, Binomial(4, 0.5)) for t in (1.0, 2.0)
    ]


def test_single_values_make_a_grid_of_one() -> None:
    assert list(criteria(0.5)) == [Criterion(0.5)]
    assert list(criteria(np.float64(0.5), np.array(0.04), Binomial(3, 0.5))) == [
        Criterion(0.5, 0.04, Binomial(3, 0.5))
    ]


@pytest.mark.parametrize(
    "thresholds",
    [
        [1.0, 2.0],
        (1, 2),
        np.array([1.0, 2.0]),
        range(1, 3),
        {1.0: "a", 2.0: "b"}.keys(),
        {1.0, 2.0},
        (t for t in (1.0, 2.0)),
        iter([1.0, 2.0]),
    ],
    ids=lambda v: type(v).__name__,
)
def test_any_iterable_lists_values(thresholds: Any) -> None:
    assert sorted(c.threshold for c in criteria(thresholds)) == [1.0, 2.0]


def test_one_shot_iterables_serve_every_combination() -> None:
    grid = criteria(iter([1.0, 2.0]), iter([None, 0.5]), iter([1, 2]))
    assert len(grid) == len(set(grid)) == 8


@pytest.mark.parametrize("arguments", [{"threshold": []}, {"threshold": [1.0], "missions": []}])
def test_an_empty_grid_is_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"^(threshold|missions) = \[\]: give at least one"):
        criteria(**arguments)


def test_criteria_are_a_sequence() -> None:
    grid = criteria([1.0, 2.0, 3.0])
    assert isinstance(grid[1:], Criteria)
    assert grid[1:] == criteria([2.0, 3.0])
    assert grid[-1] == Criterion(3.0)
    assert grid + criteria(4.0) == criteria([1.0, 2.0, 3.0, 4.0])
    assert Criterion(2.0) in grid
    assert hash(grid) == hash(criteria([1, 2, 3]))
    assert grid != list(grid)
    assert repr(criteria([1.0])) == "Criteria([T = 1, m = 1])"
    assert pickle.loads(pickle.dumps(grid)) == grid


def test_only_criteria_make_criteria() -> None:
    with pytest.raises(TypeError, match=r"criteria\[0\] = 0\.5: give a Criterion"):
        Criteria([0.5])  # type: ignore[list-item]


@given(
    st.lists(st.floats(allow_nan=False), min_size=1, max_size=4),
    st.lists(st.none() | st.floats(0, 1e300), min_size=1, max_size=3),
    st.lists(
        st.integers(1, 50) | st.builds(Binomial, st.integers(1, 50), st.floats(0, 1)),
        min_size=1,
        max_size=3,
    ),
)
def test_every_combination_occurs_once_in_order(
    thresholds: list[float], taus: list[float | None], missions: list[Any]
) -> None:
    grid = criteria(thresholds, taus, missions)
    assert len(grid) == len(thresholds) * len(taus) * len(missions)
    per_tau = len(thresholds) * len(missions)
    for i, c in enumerate(grid):
        assert c.threshold == thresholds[i % len(thresholds)]
        assert c.missions == missions[i // len(thresholds) % len(missions)]
        assert c.tau == taus[i // per_tau]
