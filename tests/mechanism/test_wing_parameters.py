"""The parameter record: Table 1, and a clear refusal of every impossible value."""

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest

from uqfold.mechanism import WingParameters

TABLE_1 = {
    "l_1": 1.5,
    "w_1": 0.3,
    "rho_1": 2700,
    "l_2": 1.3,
    "w_2": 0.2,
    "rho_2": 2700,
    "V_3": 0.001,
    "rho_3": 7870,
    "k_d": 550,
    "V_q": 140,
    "delta": 0,
    "C_0": 1,
    "rho_a": 1.293,
    "b": 0.007,
    "C_r": 0.0025,
    "R_b": 0.010,
    "c": 0.1,
    "C_e": 0.9,
    "E_1": 70e9,
    "nu_1": 0.33,
    "E_2": 200e9,
    "nu_2": 0.3,
    "C_f": 0.1,
}


def test_defaults_are_those_of_table_1():
    assert {name: getattr(WingParameters(), name) for name in TABLE_1} == TABLE_1


def test_slider_starts_on_the_side_nearer_to_A():
    # l_1 - sqrt(l_2^2 - c^2) with the crank along X
    assert WingParameters().x_3_initial == pytest.approx(1.5 - math.sqrt(1.3**2 - 0.1**2))


def test_replace_returns_a_validated_copy_and_the_record_is_frozen():
    original = WingParameters()
    changed = original.replace(C_r=0.0015, V_q=np.float64(100))
    assert (changed.C_r, changed.V_q, changed.R_j_C) == (0.0015, 100.0, pytest.approx(0.0085))
    assert original.C_r == 0.0025
    with pytest.raises(ValueError, match="C_r"):
        original.replace(C_r=0.02)
    with pytest.raises(TypeError, match="clearance"):
        original.replace(clearance=0.001)
    with pytest.raises(dataclasses.FrozenInstanceError):
        original.C_r = 0.001


@pytest.mark.parametrize(
    ("changes", "named", "remedy"),
    [
        ({"V_q": math.nan}, r"V_q = nan", "finite"),
        ({"delta": math.inf}, r"delta = inf", "finite"),
        ({"k_d": "strong"}, r"k_d = 'strong'", "number"),
        ({"k_d": None}, r"k_d = None", "number"),
        ({"C_r": -0.001}, r"C_r = -0.001", "above 0"),
        ({"C_r": 0.0}, r"C_r = 0.0", "above 0"),
        ({"C_r": 0.01}, r"C_r = 0.01 m.*R_b = 0.01 m", "below R_b"),
        ({"R_b": 0.002}, r"C_r = 0.0025 m.*R_b = 0.002 m", "below R_b"),
        ({"b": 0.0}, r"b = 0.0", "above 0"),
        ({"l_1": -1.5}, r"l_1 = -1.5", "above 0"),
        ({"rho_2": 0.0}, r"rho_2 = 0.0", "above 0"),
        ({"V_q": -1.0}, r"V_q = -1.0", "0 or a positive"),
        ({"C_f": -0.1}, r"C_f = -0.1", "0 or a positive"),
        ({"C_e": 0.0}, r"C_e = 0.0", "above 0"),
        ({"C_e": 1.1}, r"C_e = 1.1", r"in \(0, 1\]"),
        ({"nu_1": 0.6}, r"nu_1 = 0.6", "up to 0.5"),
        ({"nu_2": -1.0}, r"nu_2 = -1.0", "above -1"),
        ({"friction_v_0": 0.02}, r"friction_v_1 = 0.01 .*friction_v_0 = 0.02", "ramp"),
        ({"onset_velocity_floor": 0.0}, r"onset_velocity_floor = 0.0", "above 0"),
        ({"t_max": 0.0}, r"t_max = 0.0", "above 0"),
        ({"l_2": 0.05}, r"l_2 = 0.05 m.*0.1 m", "lengthen"),
        ({"theta_1_initial": 1.5}, r"l_2 = 1.3 m is too short", "reduce"),
        ({"x_lock": 0.2}, r"x_lock = 0.2 m.*0.20385", "larger x_lock"),
        ({"x_lock": 3.0}, r"x_lock = 3.0 m is unreachable", "within reach"),
        ({"tangential_velocity": "both"}, r"tangential_velocity = 'both'", "geometric, material"),
    ],
)
def test_impossible_values_are_refused_by_name_value_and_remedy(changes, named, remedy):
    with pytest.raises(ValueError, match=named) as error:
        WingParameters(**changes)
    assert error.match(remedy)


@pytest.mark.parametrize("field", [f.name for f in dataclasses.fields(WingParameters)])
def test_every_number_refuses_nan(field):
    with pytest.raises(ValueError, match=rf"^{field} = nan"):
        WingParameters(**{field: math.nan})


def test_the_record_needs_no_numba():
    code = (
        "import sys, uqfold.mechanism as m; m.WingParameters();"
        "assert 'numba' not in sys.modules; m.deployment_times; assert 'numba' in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_unknown_names_are_attribute_errors():
    import uqfold.mechanism as room

    assert set(room.__all__) <= set(dir(room))
    with pytest.raises(AttributeError, match="deployment_tims"):
        _ = room.deployment_tims
