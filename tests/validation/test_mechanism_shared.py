"""What the mechanism's cases share: wings, stored times, and the table."""

import numpy as np
import pytest

from validation.against_exudyn import measure as exudyn
from validation.against_scipy import measure as scipy
from validation.mechanism import independent, parameter_sets


def test_parameter_sets_cover_the_tables() -> None:
    sets = parameter_sets
    wings = sets.parameter_sets()
    assert len(wings) >= 40
    six = [wing for name, wing in wings.items() if name.startswith("table 6 corner")]
    for name, (mean, sigma) in sets.TABLE_6.items():
        levels = {round((getattr(wing, name) - mean) / sigma, 9) for wing in six}
        assert levels == {-3.0, 3.0}
    ten = [wing for name, wing in wings.items() if name.startswith("table 10 corner")]
    for table, corners in ((sets.TABLE_6, six), (sets.TABLE_10, ten)):
        signs = np.array(
            [[np.sign(getattr(w, n) - mean) for n, (mean, _) in table.items()] for w in corners]
        )
        # every pair of variables takes all its combinations equally often
        np.testing.assert_array_equal(signs.T @ signs, len(corners) * np.eye(len(table)))


def test_stored_scipy_times_are_those_of_the_integration() -> None:
    sets, stored = parameter_sets.parameter_sets(), scipy.stored_times()
    assert stored.keys() == sets.keys()
    again = independent.deployment_time(sets["table 10"])
    assert again == pytest.approx(stored["table 10"][0], abs=1e-8)


@pytest.mark.slow
def test_stored_exudyn_times_are_those_of_exudyn() -> None:
    pytest.importorskip("exudyn")
    wing, stored = parameter_sets.parameter_sets()["table 10"], exudyn.stored_times()
    again = exudyn.exudyn_times(wing, [4 * exudyn.STEPS[-1]])[0]
    assert again == pytest.approx(stored["table 10"][-1], abs=exudyn.AGREEMENT)
