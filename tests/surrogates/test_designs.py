"""Designs that reach into the tails."""

import numpy as np
import pytest
from scipy.special import ndtr

from uqfold.surrogates.designs import MAX_COORDINATE, space_filling_design


def test_points_are_spread_wider_than_the_inputs() -> None:
    u = space_filling_design(256, 4, np.random.default_rng(1), spread=1.7)
    assert u.shape == (256, 4)
    assert u.std(axis=0) == pytest.approx(np.full(4, 1.7), rel=0.1)
    assert np.abs(u).max() <= MAX_COORDINATE
    assert (u[0] == 0.0).all()


def test_another_seed_gives_another_design_and_the_same_seed_the_same() -> None:
    first, again, other = (
        space_filling_design(30, 3, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    assert (first == again).all()
    assert not (first == other).any(axis=1)[1:].any()


def test_one_dimension_is_filled_without_gaps() -> None:
    u = np.sort(space_filling_design(64, 1, np.random.default_rng(5))[1:, 0])
    assert np.diff(ndtr(u / 1.7)).max() < 2.5 / 64


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((0, 2, 1.7), "0 points"), ((5, 0, 1.7), "0 variables"), ((5, 2, 0.0), "spread = 0.0")],
)
def test_bad_designs_are_refused(arguments: tuple[int, int, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        space_filling_design(*arguments[:2], np.random.default_rng(0), arguments[2])
