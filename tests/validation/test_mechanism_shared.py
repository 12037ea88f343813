"""What the mechanism's cases share: wings, stored times, and the table."""

import numpy as np
import pytest

from validation.against_other_codes.measure import CODES, exudyn_times, stored_times
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


@pytest.mark.parametrize("name", CODES)
def test_every_code_has_stored_times_for_its_wings(name: str) -> None:
    assert [*stored_times(name)] == [*CODES[name].wings]


def test_stored_scipy_times_are_those_of_the_integration() -> None:
    wing = parameter_sets.parameter_sets()["table 10"]
    again = independent.deployment_time(wing)
    assert again == pytest.approx(stored_times("scipy")["table 10"][0], abs=1e-8)


@pytest.mark.slow
def test_stored_exudyn_times_are_those_of_exudyn() -> None:
    pytest.importorskip("exudyn")
    wing = parameter_sets.parameter_sets()["table 10"]
    [again] = exudyn_times(wing, (16e-6,))
    stored = stored_times("exudyn")["table 10"][0]
    assert again == pytest.approx(stored, abs=CODES["exudyn"].agreement)
