"""Any wing that the parameter record accepts gets a finite time or +inf: no hang and no NaN.

`test_deployment.py` varies what the paper varies; here every field of the record varies at once.
"""

import dataclasses
import math
import warnings
from datetime import timedelta

import pytest
from hypothesis import HealthCheck, assume, event, given, settings
from hypothesis import strategies as st

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.ideal import ideal_deployment_times

# About half to twice the values of Table 1, every loss and any pitch angle
NEAR = {
    "l_1": (0.8, 3.0),
    "w_1": (0.15, 0.6),
    "rho_1": (1300.0, 5400.0),
    "l_2": (0.7, 2.6),
    "w_2": (0.1, 0.4),
    "rho_2": (1300.0, 5400.0),
    "V_3": (5e-4, 2e-3),
    "rho_3": (4000.0, 16_000.0),
    "b_1": (0.0035, 0.014),
    "b_2": (0.0035, 0.014),
    "c": (-0.2, 0.2),
    "k_d": (-500.0, 2200.0),
    "V_q": (0.0, 400.0),
    "delta": (-3.2, 3.2),
    "C_0": (0.0, 2.0),
    "rho_a": (0.0, 2.6),
    "g": (1.0, 10.0),
    "C_r_B": (1e-4, 5e-3),
    "C_r_C": (1e-4, 5e-3),
    "R_b": (0.006, 0.02),
    "C_e": (0.3, 1.0),
    "E_b_B": (1e9, 4e11),
    "nu_b_B": (0.0, 0.5),
    "E_j_B": (1e9, 4e11),
    "nu_j_B": (0.0, 0.5),
    "E_b_C": (1e9, 4e11),
    "nu_b_C": (0.0, 0.5),
    "E_j_C": (1e9, 4e11),
    "nu_j_C": (0.0, 0.5),
    "C_f": (0.0, 0.2),
    "friction_v_0": (0.0, 0.003),
    "friction_v_1": (0.006, 0.1),
    "onset_velocity_floor": (1e-4, 1e-2),
    "theta_1_initial": (-0.5, 0.5),
    "x_lock": (0.5, 2.0),
    "t_max": (0.1, 3.0),
}
# Far beyond, where explicit steps may not suffice: 20 kN on light arms, friction of 1, contacts
# that hardly return, resting contacts damped by a rate of a micrometre per second
FAR = NEAR | {
    "l_1": (0.3, 3.0),
    "w_1": (0.01, 1.0),
    "rho_1": (500.0, 20_000.0),
    "l_2": (0.3, 3.0),
    "w_2": (0.01, 1.0),
    "rho_2": (500.0, 20_000.0),
    "V_3": (1e-4, 0.01),
    "rho_3": (500.0, 20_000.0),
    "b_1": (0.001, 0.05),
    "b_2": (0.001, 0.05),
    "c": (-0.5, 0.5),
    "k_d": (-2000.0, 20_000.0),
    "V_q": (0.0, 700.0),
    "delta": (-7.0, 7.0),
    "C_r_B": (1e-5, 0.015),
    "C_r_C": (1e-5, 0.015),
    "R_b": (0.002, 0.05),
    "C_e": (0.05, 1.0),
    "C_f": (0.0, 1.0),
    "onset_velocity_floor": (1e-6, 0.1),
    "theta_1_initial": (-1.5, 1.5),
    "x_lock": (0.25, 2.7),
    "t_max": (0.001, 3.0),
}
CHOICES = {
    "contact_law": ("lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier"),
    "tangential_velocity": ("geometric", "material"),
}


def fields(ranges):
    """Strategy for the values of all fields."""
    values = {name: st.floats(*bounds) for name, bounds in ranges.items()}
    values |= {name: st.sampled_from(choices) for name, choices in CHOICES.items()}
    return st.fixed_dictionaries(values)


def test_every_field_varies():
    assert NEAR.keys() == FAR.keys()
    assert (NEAR | CHOICES).keys() == {field.name for field in dataclasses.fields(WingParameters)}


def record(values, share):
    """The record with these values, its lock within reach; None where there is no such wing."""
    rise = values["l_1"] * math.sin(values["theta_1_initial"]) + values["c"]
    if abs(rise) >= values["l_2"]:
        return None
    run = math.sqrt(values["l_2"] ** 2 - rise**2)
    start = values["l_1"] * math.cos(values["theta_1_initial"]) - run
    span = values["l_1"] + values["l_2"]
    try:
        return WingParameters(**values | {"x_lock": start + share * (span - start)})
    except ValueError:
        return None


FREELY = settings(
    max_examples=80,
    deadline=timedelta(seconds=60),
    derandomize=True,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
SHARE = st.floats(0.001, 0.99)


@FREELY
@given(values=fields(NEAR), share=SHARE)
def test_any_wing_locks_or_does_not(values, share):
    wing = record(values, share)
    assume(wing is not None)
    for times in (deployment_times, ideal_deployment_times):
        t = float(times(wing)[0])
        event(f"{times.__name__}: {'locks' if t < math.inf else 'does not lock'}")
        assert t == math.inf or 0 < t <= wing.t_max


@pytest.mark.thorough
@FREELY
@given(values=fields(FAR), share=SHARE)
def test_any_record_at_all_comes_to_an_end(values, share):
    wing = record(values, share)
    assume(wing is not None)
    with warnings.catch_warnings(record=True) as rough:
        warnings.simplefilter("always")
        t = float(deployment_times(wing)[0])
    event("rough" if rough else "under control")
    assert t == math.inf or 0 < t <= wing.t_max


@pytest.mark.parametrize(("name", "bounds"), FAR.items(), ids=list(FAR))
def test_every_field_alone_at_its_ends(name, bounds):
    for value in bounds:
        try:
            wing = WingParameters(C_r=0.0015).replace(**{name: value})
        except ValueError:
            continue
        t = float(deployment_times(wing)[0])
        assert t == math.inf or 0 < t <= wing.t_max
