"""The four-branch system: its limit state, and references that follow by another integration."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from uqfold.problems import four_branch
from uqfold.problems.base import LIMIT_STATE_THRESHOLD
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray


def as_printed(x: FloatArray, k: float = 7.0) -> FloatArray:
    """The four branches, one by one."""
    x1, x2 = x.T
    root = math.sqrt(2.0)
    branches = [
        3.0 + 0.1 * (x1 - x2) ** 2 - (x1 + x2) / root,
        3.0 + 0.1 * (x1 - x2) ** 2 + (x1 + x2) / root,
        (x1 - x2) + k / root,
        (x2 - x1) + k / root,
    ]
    return np.min(branches, axis=0)


@pytest.mark.parametrize("k", [6.0, 7.0])
def test_response_is_minus_the_smallest_branch(k: float) -> None:
    x = 3.0 * np.random.default_rng(1).standard_normal((2_000, 2))
    problem = four_branch(k)
    np.testing.assert_allclose(problem.model(x), -as_printed(x, k), rtol=1e-12, atol=1e-12)
    failed = problem.model(x) > LIMIT_STATE_THRESHOLD
    np.testing.assert_array_equal(failed, as_printed(x, k) <= 0.0)
    assert problem.n_units == 1
    assert problem.inputs.n_shared == 0


def test_references_agree_with_polar_integration() -> None:
    """Along each direction from the origin the response rises: failure lies beyond one radius."""
    references = four_branch().references
    assert references is not None
    angles = (np.arange(20_000) + 0.5) * (2.0 * np.pi / 20_000)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    for reference in references:
        # g - level is quadratic along a ray, branch by branch: take the smallest positive root
        level = reference.criterion.threshold
        s = directions.sum(axis=1) / math.sqrt(2.0)
        t = (directions[:, 0] - directions[:, 1]) / math.sqrt(2.0)
        plane = (3.5 + level / math.sqrt(2.0)) / np.abs(t)
        # 3 + level + 0.2 t^2 r^2 - |s| r = 0
        discriminant = s**2 - 0.8 * t**2 * (3.0 + level)
        inside = discriminant >= 0.0
        root = np.sqrt(np.where(inside, discriminant, 0.0))
        # the curved region ends again further out
        enter = 2.0 * (3.0 + level) / (np.abs(s) + root)
        leave = np.where(t != 0.0, (np.abs(s) + root) / (0.4 * t**2), np.inf)
        both = np.exp(-0.5 * np.minimum(plane, 40.0) ** 2)
        outside_plane = np.exp(-0.5 * enter**2) - np.exp(
            -0.5 * np.clip(np.minimum(leave, plane), enter, 40.0) ** 2
        )
        pf = np.mean(both + np.where(inside & (enter < plane), outside_plane, 0.0))
        assert pf == pytest.approx(reference.pf, rel=2e-4)


def test_published_value() -> None:
    references = four_branch().references
    assert references is not None
    found = references.lookup(Criterion(LIMIT_STATE_THRESHOLD))
    assert found is not None
    assert found.pf == pytest.approx(2.2228e-3, rel=1e-4)
    # and its plane branches alone hold a fifth of it
    assert 2.0 * ndtr(-3.5) / found.pf == pytest.approx(0.21, abs=0.01)


def test_other_k_has_no_references_and_bad_k_is_refused() -> None:
    assert four_branch(6.0).references is None
    assert four_branch(6.0).name != four_branch().name
    for k in (0.0, -7.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="k = "):
            four_branch(k)
