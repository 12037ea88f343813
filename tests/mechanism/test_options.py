"""Named choices of the wing: one value per joint and wing, common names, contact laws."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.parameters import PARTS
from validation.mechanism import independent

WING = WingParameters(C_r=0.0015)
SPLIT = WING.replace(
    C_r_B=0.0011, b_2=0.0065, E_j_C=200e9, nu_j_C=0.3, E_b_B=110e9, contact_law="flores-2011"
)


def test_a_common_name_sets_and_reads_all_its_parts():
    for common, parts in PARTS.items():
        value = 5e10 if common.startswith("E_") else 0.003
        wing = WingParameters(**{common: value})
        assert [getattr(wing, part) for part in parts] == [value] * len(parts)
        assert getattr(wing, common) == value
        assert WingParameters().replace(**{common: value}) == wing
        assert WingParameters(**dict.fromkeys(parts, value)) == wing


def test_a_common_name_has_no_value_where_its_parts_differ():
    wing = WING.replace(C_r_C=0.002)
    assert (wing.C_r_B, wing.C_r_C) == (0.0015, 0.002)
    assert (wing.R_j_B, wing.R_j_C) == pytest.approx((0.0085, 0.008), rel=1e-15)
    with pytest.raises(ValueError, match=r"C_r has no one value.*'C_r_B': 0.0015, 'C_r_C': 0.002"):
        _ = wing.C_r
    with pytest.raises(ValueError, match="b has no one value"):
        _ = wing.replace(b_1=0.006).b
    assert wing.replace(C_r=0.001).C_r == 0.001


def test_a_field_cannot_be_given_twice():
    for give in (WingParameters, WING.replace):
        with pytest.raises(ValueError, match="C_r already sets C_r_B"):
            give(C_r=0.001, C_r_B=0.001)
        with pytest.raises(ValueError, match="E_1 already sets E_j_C"):
            give(E_j_C=70e9, E_1=70e9)
    with pytest.raises(ValueError, match="b already sets b_2"):
        deployment_times(WING, b=0.007, b_2=0.007)


def test_unknown_names_are_refused_before_their_values():
    with pytest.raises(TypeError, match="Cr, clearance"):
        WingParameters(clearance=math.nan, Cr=0.001)


@pytest.mark.parametrize("wing", [WingParameters(), WING, SPLIT, WING.replace(E_1=1e11)])
def test_the_record_shows_what_differs_from_table_1(wing):
    assert eval(repr(wing)) == wing
    assert pickle.loads(pickle.dumps(wing)) == wing == copy.deepcopy(wing)
    assert hash(wing) == hash(wing.replace())
    assert dataclasses.replace(wing, l_1=1.4).l_1 == 1.4


def test_the_shortest_form_is_shown():
    assert repr(WingParameters()) == "WingParameters()"
    assert repr(WING) == "WingParameters(C_r=0.0015)"
    assert repr(WING.replace(b_1=0.006)) == "WingParameters(b_1=0.006, C_r=0.0015)"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"C_r_B": 0.012}, r"C_r_B = 0.012 m leaves no journal"),
        ({"C_r_C": 0.0}, r"C_r_C = 0.0: give a positive value"),
        ({"b_2": -0.007}, r"b_2 = -0.007: give a positive value"),
        ({"nu_j_B": 0.7}, r"nu_j_B = 0.7: give a Poisson's ratio"),
        ({"E_b_C": math.inf}, r"E_b_C = inf: give a finite value"),
        (
            {"contact_law": "hertz"},
            r"contact_law = 'hertz'.*'lankarani-nikravesh', 'hunt-crossley'",
        ),
    ],
)
def test_impossible_parts_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        WING.replace(**changes)


def test_samples_take_values_per_joint_and_wing():
    values = {
        "b_1": [0.0065, 0.0070],
        "b_2": [0.0075, 0.0070],
        "C_r_B": [0.0011, 0.0015],
        "C_r_C": [0.0019, 0.0015],
    }
    times = deployment_times(WING, **values)
    first = {name: value[0] for name, value in values.items()}
    assert times[0] == deployment_times(WING.replace(**first))[0]
    assert times[1] == deployment_times(WING)[0]
    assert np.isnan(deployment_times(WING, C_r_C=[0.011, -0.001])).all()
    assert np.isnan(deployment_times(WING, b_1=[0.0, math.nan])).all()


def test_every_part_acts():
    changes = {
        "b_1": 0.0065,
        "b_2": 0.0065,
        "C_r_B": 0.0012,
        "C_r_C": 0.0012,
        "E_b_B": 5e9,
        "nu_b_B": 0.0,
        "E_j_B": 5e9,
        "nu_j_B": 0.0,
        "E_b_C": 5e9,
        "nu_b_C": 0.0,
        "E_j_C": 5e9,
        "nu_j_C": 0.0,
        "contact_law": "gonthier",
    }
    times = [deployment_times(WING.replace(**{name: v}))[0] for name, v in changes.items()]
    assert np.isfinite(times).all()
    # bearing and journal of one joint may be exchanged; nothing else may coincide
    assert len({*times, deployment_times(WING)[0]}) == len(changes) - 2 + 1


@pytest.mark.thorough
def test_separate_values_agree_with_an_independent_integration():
    shifts = SPLIT.C_r_B * (1 + 1e-6 * np.arange(-2, 3))
    times = deployment_times(SPLIT, C_r_B=shifts, tolerance=1e-12)
    assert np.ptp(times) < 1e-6
    assert times[2] == pytest.approx(independent.deployment_time(SPLIT), abs=1e-6)
