"""Lanes: the bits of the scalar form, packed instructions, any place and any number of threads."""

import math
import re

import llvmlite.binding as llvm
import numpy as np
import pytest

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.mechanism import deployment as module
from uqfold.mechanism.compiled import fingerprint
from uqfold.mechanism.events import may_switch
from uqfold.mechanism.lane_rows import LANES
from uqfold.mechanism.lanes import (
    CONSTANT_ROWS,
    CONTROL_ROWS,
    GROUP,
    STATE_ROWS,
    step_lanes,
)
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.wing import WingConstants, Wings

TABLE_6 = WingParameters(C_r=0.0015)


def table_6_draws(n, seed=731):
    rng = np.random.default_rng(seed)
    return {
        "V_q": rng.normal(140, 10, n),
        "delta": np.radians(rng.normal(0, 5, n)),
        "k_d": rng.normal(550, 10, n),
        "b": rng.normal(0.007, 0.00025, n),
        "C_r": rng.normal(0.0015, 0.00005, n),
    }


def scalar_times(parameters, tolerance=DEFAULT_TOLERANCE, **given):
    """Times from the scalar form, one sample after the other."""
    wings = Wings(parameters, given)
    times = np.empty(len(wings))
    module.deploy_rows(wings.table(), tolerance, times, NO_RECORD)
    return times


@pytest.mark.parametrize(
    ("changes", "tolerance"),
    [
        ({}, DEFAULT_TOLERANCE),
        ({"tangential_velocity": "material"}, DEFAULT_TOLERANCE),
        ({"C_e": 0.6, "C_f": 0.25, "tangential_velocity": "material"}, 1e-5),
        ({"t_max": 0.54}, 1e-7),
        ({"theta_1_initial": 0.3, "x_lock": 1.1}, 1e-4),
        ({"E_1": 1e9, "C_e": 1.0}, 1e-6),
    ],
)
def test_lanes_compute_the_bits_of_the_scalar_form(changes, tolerance):
    parameters = TABLE_6.replace(**changes)
    draws = table_6_draws(3 * LANES + 5)
    draws["k_d"][::9] = np.linspace(100, 400, len(draws["k_d"][::9]))  # late or never
    draws["b"][[0, 40, 100]] = -1.0  # impossible
    expected = scalar_times(parameters, tolerance, **draws)
    times = deployment_times(parameters, tolerance=tolerance, threads=1, **draws)
    np.testing.assert_array_equal(times, expected)
    assert np.isnan(times).sum() == 3
    assert np.isposinf(times).any()
    assert np.isfinite(times).sum() > LANES / 2


@pytest.mark.parametrize("n", [1, 2, 3, 5, LANES - 1, LANES, LANES + 1])
def test_any_number_of_lanes_in_use(n):
    draws = table_6_draws(LANES + 1)
    expected = scalar_times(TABLE_6, **draws)[:n]
    times = deployment_times(TABLE_6, **{name: values[:n] for name, values in draws.items()})
    np.testing.assert_array_equal(times, expected)


def test_times_do_not_depend_on_place_or_threads():
    n = 1200  # several chunks for every number of threads
    draws = table_6_draws(n)
    times = deployment_times(TABLE_6, threads=1, **draws)
    assert len(np.unique(times)) == n
    order = np.random.default_rng(5).permutation(n)
    shuffled = {name: values[order] for name, values in draws.items()}
    for threads in (1, 2, 3, 7):
        np.testing.assert_array_equal(
            deployment_times(TABLE_6, threads=threads, **shuffled), times[order]
        )


@pytest.mark.parametrize("velocity", ["geometric", "material"])
def test_default_tolerance_meets_its_accuracy(velocity):
    parameters = TABLE_6.replace(tangential_velocity=velocity)
    draws = table_6_draws(400)
    reference = deployment_times(parameters, tolerance=1e-10, **draws)
    error = deployment_times(parameters, **draws) - reference
    assert np.median(np.abs(error)) <= 2e-5
    assert np.sqrt(np.mean(error**2)) <= 5e-5
    assert abs(np.mean(error)) <= 5e-6
    assert np.max(np.abs(error)) <= 3e-4


def test_the_tight_end_reaches_a_microsecond():
    draws = table_6_draws(60)
    reference = deployment_times(TABLE_6, tolerance=1e-12, **draws)
    error = np.abs(deployment_times(TABLE_6, tolerance=1e-9, **draws) - reference)
    assert np.median(error) < 1e-6


def test_a_lane_stops_at_the_largest_number_of_steps():
    table = Wings(TABLE_6, {"V_q": np.linspace(130, 150, 9)}).table()
    times = np.empty(9)
    steps = [
        module.deploy_rows(table[i : i + 1], DEFAULT_TOLERANCE, np.empty(1), NO_RECORD)
        for i in range(9)
    ]
    limit = sorted(steps)[4]
    module.deploy_lanes(table, DEFAULT_TOLERANCE, limit, times)
    assert (times == module.GIVEN_UP).tolist() == [count > limit for count in steps]


OPEN, CLOSED = -1.0, 10.0


@pytest.mark.parametrize(
    ("damping", "gap", "rate", "gap_end", "rate_end", "expected"),
    [
        (OPEN, -1e-5, 0.1, 1e-5, 0.1, True),  # begins
        (OPEN, -1e-5, 0.1, -2e-6, 0.1, False),  # comes near
        (OPEN, -1e-5, -0.1, -2e-5, -0.1, False),  # goes away
        (OPEN, -1e-6, 0.1, -1e-6, -0.1, True),  # may begin and end
        (OPEN, -1e-3, 0.1, -1e-3, -0.1, False),  # turns round far away
        (OPEN, 1e-18, -0.1, 1e-5, 0.1, True),  # opened just now, comes back
        (OPEN, 1e-18, 0.1, 1e-5, 0.1, True),  # the sign says that it has begun already
        (CLOSED, 1e-5, -0.1, -1e-5, -0.1, True),  # ends
        (CLOSED, 1e-5, -0.1, 2e-6, -0.1, False),
        (CLOSED, 1e-5, 0.1, 2e-5, 0.1, False),
        (CLOSED, 1e-6, -0.1, 1e-6, 0.1, True),  # may open for a moment
        (CLOSED, -1e-18, 0.1, -1e-5, -0.1, True),  # closed just now, opens again
        (CLOSED, -1e-18, -0.1, -1e-5, -0.1, False),  # has just begun with no more than rounding
        (OPEN, math.nan, 0.1, math.nan, 0.1, False),
    ],
)
def test_steps_that_need_a_closer_look(damping, gap, rate, gap_end, rate_end, expected):
    assert may_switch(gap, rate, gap_end, rate_end, 5e-4, damping) == expected


@pytest.mark.thorough
def test_the_loop_is_compiled_to_packed_instructions():
    features = llvm.get_host_cpu_features()
    if not features.get("avx"):
        pytest.skip("this machine has no packed instructions of 256 bits")
    # compiled on its own, since what comes from the cache cannot be listed
    arrays = [np.zeros(n * LANES) for n in (CONSTANT_ROWS, STATE_ROWS, STATE_ROWS, CONTROL_ROWS)]
    step_lanes(*arrays, LANES, 1e6, DEFAULT_TOLERANCE)
    assembly = "\n".join(step_lanes.inspect_asm().values())
    packed = re.findall(r"vsqrtpd\s.*%[yz]mm", assembly)
    # two per joint and stage, and two for the next time step
    assert len(packed) >= 4 * 2 * 2 + 2
    assert "vfmadd" not in assembly


def test_arrays_hold_whole_groups_and_every_field():
    assert LANES % GROUP == 0
    assert len(WingConstants._fields) == CONSTANT_ROWS == 31
    assert STATE_ROWS == 26


def test_the_cache_is_keyed_by_every_source_of_the_room():
    closure = getattr(module.deploy_lanes, "py_func", module.deploy_lanes).__closure__
    assert fingerprint() in [cell.cell_contents for cell in closure]
