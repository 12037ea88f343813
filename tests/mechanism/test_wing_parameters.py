"""The parameter record: Table 1, and a clear refusal of every impossible value."""

import dataclasses
import math
import subprocess
import sys

import numpy as np
import pytest

from uqfold.mechanism import WingParameters
from uqfold.mechanism.parameters import PARTS
from uqfold.mechanism.scales import MOST_VIBRATIONS, hertz_stiffness, scales_of

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
        ({"k_d": "strong"}, r"k_d = 'strong'", "give a finite value"),
        ({"k_d": None}, r"k_d = None", "give a finite value"),
        ({"C_r": -0.001}, r"C_r = -0.001", "give a positive"),
        ({"C_r": 0.0}, r"C_r = 0.0", "give a positive"),
        ({"C_r": 0.01}, r"C_r = 0.01 m.*R_b = 0.01 m", "below R_b"),
        ({"R_b": 0.002}, r"C_r = 0.0025 m.*R_b = 0.002 m", "below R_b"),
        ({"b": 0.0}, r"b = 0.0", "give a positive"),
        ({"l_1": -1.5}, r"l_1 = -1.5", "give a positive"),
        ({"rho_2": 0.0}, r"rho_2 = 0.0", "give a positive"),
        ({"V_q": -1.0}, r"V_q = -1.0", ">= 0"),
        ({"C_f": -0.1}, r"C_f = -0.1", ">= 0"),
        ({"C_e": 0.0}, r"C_e = 0.0", "give a positive"),
        ({"C_e": 1.1}, r"C_e = 1.1", r"in \(0, 1\]"),
        ({"nu_1": 0.6}, r"nu_1 = 0.6", r"in \(-1, 0.5\]"),
        ({"nu_2": -1.0}, r"nu_2 = -1.0", r"in \(-1, 0.5\]"),
        ({"friction_v_0": 0.02}, r"friction_v_1 = 0.01 .*friction_v_0 = 0.02", "ramp"),
        ({"onset_velocity_floor": 0.0}, r"onset_velocity_floor = 0.0", "give a positive"),
        ({"t_max": 0.0}, r"t_max = 0.0", "give a positive"),
        ({"l_2": 0.05}, r"l_2 = 0.05 m.*0.1 m", "lengthen"),
        ({"theta_1_initial": 1.5}, r"l_2 = 1.3 m is too short", "reduce"),
        ({"x_lock": 0.2}, r"x_lock = 0.2 m.*0.20385", "larger x_lock"),
        ({"x_lock": 3.0}, r"x_lock = 3.0 m is unreachable", "within reach"),
        ({"C_e": 1e-4}, r"C_e = 0.0001", "at least 0.001"),
        ({"C_f": 11.0}, r"C_f = 11.0", "at most 10"),
        ({"onset_velocity_floor": 1e-10}, r"onset_velocity_floor = 1e-10", "at least 1e-9"),
        ({"friction_v_1": 0.001 + 1e-12}, r"friction_v_1 = 0.001000000001", "at least 1e-9"),
        ({"theta_1_initial": 7.0}, r"theta_1_initial = 7.0", "within -2 pi and 2 pi"),
        ({"l_1": 60.0, "l_2": 60.0, "x_lock": 70.0}, r"l_1 \+ l_2 = 120 m", "at most 100 m"),
        ({"l_2": 1e200}, r"l_2 = 1e\+200", r"<= 1e\+30"),
        ({"rho_1": 5e-324}, r"rho_1 = 5e-324", ">= 1e-30"),
        ({"C_r_C": 1e-9}, r"C_r = 1e-09 m", "at least 2.8e-08 m"),
        ({"t_max": 1e3}, r"t_max = 1000.0 s", "at most 100 s"),
        ({"k_d": 1e8}, r"1e\+08 N .* bears 3.43e\+06 N .* R_b = 0.01 m", "reduce k_d"),
        ({"V_q": 1e25}, r"loads of up to 1.27e\+48 N", "reduce k_d, V_q"),
        ({"rho_3": 1e30, "V_3": 1e30}, r"loads of up to 9.81e\+60 N", "or the masses"),
        ({"b": 1e-12}, r"rad/s, too fast .*t_max = 2.0 s", "heavier bodies"),
        ({"E_1": 1e23, "E_2": 1e23}, r"rad/s, too fast", "t_max of at most"),
        (
            {"tangential_velocity": "both"},
            r"tangential_velocity = 'both'",
            "'geometric', 'material'",
        ),
    ],
)
def test_impossible_values_are_refused_by_name_value_and_remedy(changes, named, remedy):
    with pytest.raises((ValueError, TypeError), match=named) as error:
        WingParameters(**changes)
    assert error.match(remedy)


def test_scales_are_far_from_those_of_the_paper():
    wing = WingParameters()
    K_B = hertz_stiffness(wing.R_b, wing.R_j_B, wing.E_1, wing.nu_1, wing.E_1, wing.nu_1)
    K_C = hertz_stiffness(wing.R_b, wing.R_j_C, wing.E_2, wing.nu_2, wing.E_1, wing.nu_1)
    scale = scales_of(wing, K_B, K_C)
    # drive, drag 0.5 rho C_0 b (l_1 + l_2) V^2, weights
    drag = 0.5 * 1.293 * 0.007 * 2.8 * 140**2
    masses = (2700 * 1.5 * 0.3 * 0.007, 2700 * 1.3 * 0.2 * 0.007, 7.87)
    assert scale.load == pytest.approx(550 + drag + 9.81 * sum(masses))
    assert scale.capacity == pytest.approx(K_B * 0.01**1.5)
    assert scale.frequency == pytest.approx(math.sqrt(1.5 * K_C * 0.1 / (masses[1] / 4)))
    assert 100 * scale.load < scale.capacity
    assert 1000 * scale.frequency * wing.t_max < MOST_VIBRATIONS


@pytest.mark.parametrize("field", [f.name for f in dataclasses.fields(WingParameters)])
def test_every_number_refuses_nan(field):
    with pytest.raises((ValueError, TypeError), match=rf"^{field} = nan"):
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


def test_numpy_scalars_make_the_same_wing():
    exact = np.longdouble(600)
    wing = WingParameters(
        k_d=np.int64(600), C_e=np.array(0.9), V_q=exact, contact_law=np.str_("gonthier")
    )
    assert wing == WingParameters(k_d=600.0, C_e=0.9, V_q=600.0, contact_law="gonthier")
    assert {type(getattr(wing, name)) for name in ("k_d", "C_e", "V_q")} == {float}


def test_no_value_of_any_type_or_size_ends_in_another_error():
    wrong = (True, "5", b"5", None, 5j, object(), [], [1.0], 10**400, -1e308, 1e308, 1e160)
    for field in [f.name for f in dataclasses.fields(WingParameters)] + list(PARTS):
        names = "|".join((field, *PARTS.get(field, ())))
        for value in wrong:
            with pytest.raises((ValueError, TypeError), match=rf"^({names}) = "):
                WingParameters(**{field: value})
