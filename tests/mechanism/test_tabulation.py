"""The motion as named columns: against the trajectory it comes from, and the geometry."""

import numpy as np
import pytest

from uqfold.mechanism import WingParameters, motion_table, trajectory

WING = WingParameters(C_r_C=0.002, l_2=1.29)


@pytest.fixture(scope="module")
def table():
    return motion_table(WING)


def test_columns_are_those_of_the_trajectory(table):
    m = trajectory(WING)
    np.testing.assert_array_equal(table["time"], m.time)
    assert table["time"][-1] == m.deployment_time
    np.testing.assert_array_equal(table["theta_1"], m.coordinates[:, 0])
    np.testing.assert_array_equal(table["x_C"], m.coordinates[:, 4])
    for k, joint in enumerate("BC"):
        np.testing.assert_array_equal(table[f"penetration_{joint}"], m.penetration[:, k])
        np.testing.assert_array_equal(table[f"normal_force_{joint}"], m.normal_force[:, k])
        np.testing.assert_array_equal(table[f"tangential_force_{joint}"], m.tangential_force[:, k])
    assert {len(column) for column in table.values()} == {len(m.time)}


@pytest.mark.parametrize(("joint", "clearance"), [("B", 0.0025), ("C", 0.002)])
def test_eccentricity_is_clearance_and_penetration(table, joint, clearance):
    distance = np.hypot(table[f"e_{joint}_x"], table[f"e_{joint}_y"])
    np.testing.assert_allclose(distance - table[f"penetration_{joint}"], clearance, atol=1e-12)


def test_journals_are_a_rod_length_apart(table):
    x = table["x_B"] + table["e_B_x"] - table["x_C"] - table["e_C_x"]
    y = table["y_B"] + table["e_B_y"] - table["y_C"] - table["e_C_y"]
    np.testing.assert_allclose(np.hypot(x, y), 1.29, rtol=1e-12)
    np.testing.assert_allclose(np.arctan2(y, x), table["theta_2"], atol=1e-12)


def test_energies_balance(table):
    work = table["work_drive"] + table["work_drag"] + table["work_gravity"]
    kept = table["kinetic_energy"] + table["elastic_energy"]
    lost = table["contact_loss"] + table["friction_loss"]
    assert np.abs(work - kept - lost).max() < 1e-3 * table["work_drive"].max()
    assert lost[-1] > 0.0


def test_bad_tolerance_is_refused():
    with pytest.raises(ValueError, match="tolerance = 0"):
        motion_table(WING, tolerance=0.0)
