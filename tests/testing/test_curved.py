"""The curved system: its exact value against simulation."""

import numpy as np
import pytest

from uqfold.testing.curved import CurvedSystem


@pytest.mark.parametrize("threshold", [11.5, 12.5, 13.5])
def test_exact_value_agrees_with_simulation(threshold: float) -> None:
    system, rng, n = CurvedSystem(units=3), np.random.default_rng(0), 400_000
    v = rng.standard_normal(n)
    late = np.zeros(n, dtype=bool)
    for _ in range(system.units):
        rows = np.column_stack([v, rng.standard_normal((n, 2))])
        late |= system.response(rows) > threshold
    pf = float(late.mean())
    assert abs(system.pf(threshold) - pf) < 4.0 * np.sqrt(pf / n)
