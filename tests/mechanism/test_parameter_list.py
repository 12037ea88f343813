"""One list names the parameters; every record, table and lane holds each under its own name.

In each check here two exchanged fields are planted as well, and have to be seen.
"""

import inspect
import math
from itertools import combinations
from typing import NamedTuple, get_type_hints

import numpy as np
import pytest

from uqfold.mechanism import WingParameters
from uqfold.mechanism.events import State
from uqfold.mechanism.lane_rows import LANES, lane_access, row_count, rows_of
from uqfold.mechanism.parameter_list import PARAMETERS, PARTS
from uqfold.mechanism.wing import WING, Samples, WingConstants, Wings, wing_constants
from validation.mechanism.bodies import Bodies
from validation.mechanism.independent import FiveCoordinateWing

# no two numbers are equal, so that no exchange goes unseen
DISTINCT = WingParameters(
    l_1=1.51, w_1=0.31, rho_1=2710.0, l_2=1.32, w_2=0.21, rho_2=2650.0, V_3=0.0011, rho_3=7800.0,
    b_1=0.0071, b_2=0.0064, c=0.12, k_d=560.0, V_q=143.0, delta=0.07, C_0=1.1, rho_a=1.25, g=9.7,
    C_r_B=0.0021, C_r_C=0.0018, R_b=0.013, C_e=0.85, E_b_B=71e9, nu_b_B=0.34, E_j_B=72e9,
    nu_j_B=0.32, E_b_C=190e9, nu_b_C=0.29, E_j_C=73e9, nu_j_C=0.35, C_f=0.14, friction_v_0=0.002,
    friction_v_1=0.015, onset_velocity_floor=0.003, tangential_velocity="material",
    theta_1_initial=0.05, x_lock=1.05, t_max=2.5, contact_law="gonthier",
)  # fmt: skip
NUMBERS = {name: getattr(DISTINCT, name) for name, one in PARAMETERS.items() if one.bounds}


def plain(kernel):
    """The Python function under a kernel; the kernel itself where numba is switched off."""
    return getattr(kernel, "py_func", kernel)


def differing(found, expected):
    """Names under which two mappings hold different numbers."""
    assert found.keys() == expected.keys()
    return {name for name in found if found[name] != pytest.approx(expected[name], rel=1e-14)}


def assert_each_exchange_is_seen(found, expected):
    for one, other in combinations(found, 2):
        exchanged = found | {one: found[other], other: found[one]}
        assert {one, other} & differing(exchanged, expected), (one, other)


def constants_by_hand(p):
    """The constants from masses, joints and loads that share no line with the mechanism's."""
    bodies = Bodies(p)
    about_A, m_2, _, J_2, m_3 = FiveCoordinateWing(p).inertia
    B, C = bodies.joints
    return {
        "l_1": p.l_1,
        "half_l_1": p.l_1 / 2,
        "half_l_2": p.l_2 / 2,
        "c": p.c,
        "C_r_B": p.C_r_B,
        "C_r_C": p.C_r_C,
        "inverse_C_r_B": 1 / p.C_r_B,
        "inverse_C_r_C": 1 / p.C_r_C,
        "R_b": p.R_b,
        "R_j_B": B.R_j,
        "R_j_C": C.R_j,
        "inverse_J_A": 1 / about_A,
        "inverse_m_2": 1 / m_2,
        "inverse_J_2": 1 / J_2,
        "inverse_m_3": 1 / m_3,
        "K_B": B.K,
        "K_C": C.K,
        "hysteresis": bodies.hysteresis,
        "onset_velocity_floor": p.onset_velocity_floor,
        "C_f": p.C_f,
        "v_0": p.friction_v_0,
        "ramp_slope": 1 / (p.friction_v_1 - p.friction_v_0),
        "material": 1.0,
        "D_1": bodies.drag[0],
        "D_2": bodies.drag[1],
        "G_1": bodies.weight[0],
        "G_2": bodies.weight[1],
        "G_3": bodies.weight[2],
        "k_d": p.k_d,
        "x_lock": p.x_lock,
        "t_max": p.t_max,
    }


def test_the_list_gives_fields_values_units_and_docstring():
    assert len(set(NUMBERS.values())) == len(NUMBERS)
    text = inspect.getdoc(WingParameters)
    for name, one in PARAMETERS.items():
        kind = "float" if one.bounds else "{"
        assert f"\n{name} : {kind}" in text
        assert (one.unit == "") == bool(one.choices), name
        assert f"({one.unit})." in text or one.choices
    assert {part for parts in PARTS.values() for part in parts} <= PARAMETERS.keys()
    assert Samples.__annotations__.keys() <= PARAMETERS.keys() | PARTS.keys()


def test_the_compiled_code_reads_every_number_by_its_name():
    record = Wings(DISTINCT).table()[0]
    words = {"hysteresis", "material", "finite"}
    found = {name: float(record[name]) for name in WING.names if name not in words}
    assert differing(found, NUMBERS) == set()
    assert_each_exchange_is_seen(found, NUMBERS)
    assert record.hysteresis == pytest.approx(Bodies(DISTINCT).hysteresis, rel=1e-15)
    assert (record.material, record.finite) == (1.0, 1.0)
    assert Wings(WingParameters()).table()[0].material == 0.0


def test_samples_replace_the_number_of_their_name_alone():
    names = [name for name in Samples.__annotations__ if name not in PARTS]
    given = {name: [1.01 * NUMBERS[name], NUMBERS[name]] for name in names}
    table = Wings(DISTINCT, given).table()
    for name, value in NUMBERS.items():
        np.testing.assert_array_equal(table[name], given.get(name, [value, value]))
    part = Wings(DISTINCT, {"C_r": [0.001, math.nan, 0.002], "V_q": 100.0})
    np.testing.assert_array_equal(part.table(1, 9)["C_r_C"], [math.nan, 0.002])
    np.testing.assert_array_equal(part.table()["C_r_B"], [0.001, math.nan, 0.002])
    np.testing.assert_array_equal(part.table()["V_q"], [100.0] * 3)
    np.testing.assert_array_equal(part.table()["finite"], [1.0, 0.0, 1.0])


def test_the_constants_hold_every_quantity_under_its_name():
    found = plain(wing_constants)(Wings(DISTINCT).table()[0])._asdict()
    expected = constants_by_hand(DISTINCT)
    assert differing(found, expected) == set()
    assert_each_exchange_is_seen(found, expected)


def test_lanes_hold_every_constant_in_the_row_of_its_name():
    """Exchanged fields were silently wrong as long as lanes were unpacked by position."""
    read, write = map(plain, lane_access(WingConstants))
    rows = np.zeros(row_count(WingConstants) * LANES)
    w = WingConstants(*np.arange(1.0, 1 + len(WingConstants._fields)))
    write(rows, 5, w)
    assert read(rows, 5) == w
    assert np.count_nonzero(rows) == len(w)
    for name, places in rows_of(WingConstants).items():
        assert rows[places.start * LANES + 5] == getattr(w, name)
    fields = list(get_type_hints(WingConstants).items())
    fields[3], fields[17] = fields[17], fields[3]
    # two lines of the record exchanged: each still finds its own number
    exchanged = NamedTuple("WingConstants", fields)
    read_other, write_other = map(plain, lane_access(exchanged))
    write_other(rows, 5, w)
    assert read_other(rows, 5)._asdict() == exchanged(**w._asdict())._asdict()
    # what is written by the one order and read by the other is seen to be wrong
    write(rows, 5, w)
    assert differing(read_other(rows, 5)._asdict(), w._asdict()) == {"c", "hysteresis"}


def test_lanes_hold_a_state_with_its_tuples():
    read, write = map(plain, lane_access(State))
    rows = np.zeros(row_count(State) * LANES)
    numbers = iter(np.arange(1.0, 1 + row_count(State)).tolist())
    parts = {name: len(places) for name, places in rows_of(State).items()}
    state = State(
        *(
            tuple(next(numbers) for _ in range(n)) if n > 1 else next(numbers)
            for n in parts.values()
        )
    )
    write(rows, 0, state)
    assert read(rows, 0) == state
    assert parts == {
        "t": 1, "q": 5, "v": 5, "a": 5, "d": 4, "gaps": 4, "damping_B": 1, "damping_C": 1,
    }  # fmt: skip
