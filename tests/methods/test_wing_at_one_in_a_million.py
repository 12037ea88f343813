"""Example 3 under tau at one in a million: a sampler on the mechanism agrees with surfaces."""

import pytest

from validation.benchmarks.wing_rare import answers


@pytest.mark.slow
def test_subset_simulation_on_the_mechanism_agrees_with_surfaces() -> None:
    found = answers(200_000)
    sampled, surface, rules = (
        found[name][0] for name in ("subset-simulation", "kriging", "ffni-pearson")
    )
    assert 0.8e-6 < surface.pf < 1.8e-6
    assert sampled.std_error < 0.3 * sampled.pf
    for row in (surface, rules):
        assert row.status == "converged"
        assert sampled.ci_low < row.pf < sampled.ci_high
