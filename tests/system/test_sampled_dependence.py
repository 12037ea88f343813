"""Sampling estimates of correlated against independent units, against exact values."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from uqfold.system.sampled_dependence import sampled_dependence
from uqfold.typing import FloatArray

THRESHOLDS = np.array([-1.0, 0.0, 1.0, 2.0])
WEIGHT = 0.6  # of the shared variable; the response is standard normal


def responses(seed: int, draws: int = 4000, per_draw: int = 8) -> FloatArray:
    rng = np.random.default_rng(seed)
    shared = rng.standard_normal((draws, 1))
    own = rng.standard_normal((draws, per_draw))
    return WEIGHT * shared + np.sqrt(1.0 - WEIGHT**2) * own


def exact(threshold: float, count: int) -> tuple[float, float]:
    """Failure probability of correlated and of independent units."""
    scale = np.sqrt(1.0 - WEIGHT**2)
    works, _ = quad(
        lambda v: norm.pdf(v) * norm.cdf((threshold - WEIGHT * v) / scale) ** count, -9.0, 9.0
    )
    return 1.0 - works, 1.0 - norm.cdf(threshold) ** count


@pytest.mark.parametrize("count", [2, 5, 8])
def test_estimates_in_their_own_standard_errors(count: int) -> None:
    truth = np.array([np.subtract(*exact(t, count)[::-1]) for t in THRESHOLDS])
    runs = [sampled_dependence(responses(seed), THRESHOLDS, count) for seed in range(40)]
    z = np.array([(one.difference - truth) / one.std_error for one in runs])
    # 40 repetitions: the mean of z scatters by 0.16, its spread by 0.11
    assert (np.abs(z.mean(axis=0)) < 0.65).all(), z.mean(axis=0)
    assert ((z.std(axis=0) > 0.6) & (z.std(axis=0) < 1.5)).all(), z.std(axis=0)
    # the same check refuses a difference that is ten per cent too large at the largest gap
    wrong = np.array([(one.difference - 1.1 * truth) / one.std_error for one in runs])
    assert (np.abs(wrong.mean(axis=0)) > 0.65).any()


def test_probabilities_themselves() -> None:
    found = sampled_dependence(responses(1, draws=40_000), THRESHOLDS, 4)
    for i, threshold in enumerate(THRESHOLDS):
        pf, independent = exact(float(threshold), 4)
        assert found.pf[i] == pytest.approx(pf, abs=0.01)
        assert found.pf_independent[i] == pytest.approx(independent, abs=0.01)


def test_one_unit_has_no_difference() -> None:
    found = sampled_dependence(responses(2), THRESHOLDS, 1)
    assert np.abs(found.difference).max() < 1e-12
    assert found.std_error.max() < 1e-12


def test_ends_and_failed_runs() -> None:
    y = responses(3)
    found = sampled_dependence(y, [-np.inf, np.inf], 4)
    assert list(found.pf) == [1.0, 0.0]
    assert list(found.pf_independent) == [1.0, 0.0]
    y[:, 0] = np.nan
    assert sampled_dependence(y, [np.inf], 8).pf[0] == 1.0


def test_wrong_arguments() -> None:
    with pytest.raises(ValueError, match="8 responses per draw cannot judge 9"):
        sampled_dependence(responses(4), [0.0], 9)
    with pytest.raises(ValueError, match="give at least 2"):
        sampled_dependence(responses(4, draws=1), [0.0], 2)
