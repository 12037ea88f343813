"""Deployment times: known numbers, accuracy, batches, rows that fail."""

import math
import os
import subprocess
import sys
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from uqfold.mechanism import (
    DEFAULT_TOLERANCE,
    WingParameters,
    deployment_times,
    ideal_deployment_times,
    trajectory,
)
from uqfold.mechanism.compiled import fingerprint
from uqfold.mechanism.deployment import COARSEST_TOLERANCE, FINEST_TOLERANCE, deploy_rows
from validation.against_other_codes.measure import stored_times
from validation.mechanism import independent
from validation.mechanism.parameter_sets import parameter_sets

TABLE_6 = WingParameters(C_r=0.0015)


def time(tolerance=1e-9, **changes):
    return deployment_times(TABLE_6.replace(**changes), tolerance=tolerance)[0]


@cache
def table_6_draws(n):
    rng = np.random.default_rng(2024)
    return {
        "V_q": rng.normal(140, 10, n),
        "delta": np.radians(rng.normal(0, 5, n)),
        "k_d": rng.normal(550, 10, n),
        "b": rng.normal(0.007, 0.00025, n),
        "C_r": rng.normal(0.0015, 0.00005, n),
    }


@pytest.mark.parametrize(
    ("changes", "seconds"),
    [
        ({}, 0.53558),
        ({"tangential_velocity": "material"}, 0.53688),
        ({"V_q": 200, "k_d": 1100, "b": 0.006}, 0.35551),
        ({"C_r": 0.001}, 0.53588),
        ({"C_r": 0.002}, 0.53531),
        ({"V_q": 100}, 0.52946),
        ({"V_q": 180}, 0.54471),
        ({"delta": math.radians(-30)}, 0.54584),
        ({"delta": math.radians(30)}, 0.52631),
    ],
)
def test_times_at_the_means_of_tables_6_8_and_10(changes, seconds):
    # the numbers carry five digits; the default tolerance scatters by its own rms
    assert time(**changes) == pytest.approx(seconds, abs=1e-5)
    assert time(DEFAULT_TOLERANCE, **changes) == pytest.approx(seconds, abs=2e-4)


def test_weak_drives_lock_late_or_never():
    assert time(k_d=200) == math.inf
    assert time(k_d=150) == math.inf
    assert time(k_d=300) == pytest.approx(0.80, abs=5e-3)  # after the drive has ended


def test_signs_of_the_effect_of_every_mean():
    """Slower for larger V_q and b; faster for larger delta, k_d and C_r."""
    steps = {
        "V_q": (100, 140, 180),
        "b": (0.006, 0.007, 0.008),
        "delta": (math.radians(30), 0.0, math.radians(-30)),
        "k_d": (600, 550, 500),
        "C_r": (0.002, 0.0015, 0.001),
    }
    for name, values in steps.items():
        times = deployment_times(TABLE_6, tolerance=1e-8, **{name: values})
        assert np.all(np.diff(times) > 0), name


def test_scatter_under_table_6():
    n = 3000
    times = deployment_times(TABLE_6, **table_6_draws(n))
    standard_error = times.std() / math.sqrt(2 * n)
    assert times.std(ddof=1) == pytest.approx(0.0102, abs=4 * standard_error + 0.00005)


def test_halving_the_tolerance_converges():
    draws = {name: values[:150] for name, values in table_6_draws(3000).items()}
    reference = deployment_times(TABLE_6, tolerance=1e-11, **draws)
    medians = [
        np.median(np.abs(deployment_times(TABLE_6, tolerance=tolerance, **draws) - reference))
        for tolerance in (1e-6, 1e-7, 1e-8, 1e-9)
    ]
    assert all(fine < coarse for coarse, fine in pairwise(medians))
    assert medians[-1] < 1e-6


def test_agrees_with_an_independent_integration():
    """Beside the wings of `against_other_codes`, whose times are stored."""
    parameters = TABLE_6.replace(
        tangential_velocity="material", delta=-0.2, V_q=170, l_1=1.504, C_e=0.7, C_f=0.2
    )
    # what 1e-6 of the clearance does to the time bounds what agreement can mean
    shifts = parameters.C_r * (1 + 1e-6 * np.arange(-2, 3))
    times = deployment_times(parameters, C_r=shifts, tolerance=1e-12)
    expected = independent.deployment_time(parameters)
    assert np.ptp(times) < 1e-6
    assert times[2] == pytest.approx(expected, abs=1e-6)


def test_agrees_with_stored_times_of_the_independent_integration():
    stored, wings = stored_times("scipy"), parameter_sets()
    names = [f"table {k}{what}" for k in (1, 6, 10) for what in ("", ", material")]
    for name in names:
        time = deployment_times(wings[name], tolerance=1e-12)[0]
        assert time == pytest.approx(stored[name][0], abs=1e-6), name


def test_the_onset_velocity_floor_does_not_matter():
    draws = {name: values[:40] for name, values in table_6_draws(3000).items()}
    lower = TABLE_6.replace(onset_velocity_floor=1e-4)
    shift = deployment_times(lower, tolerance=1e-9, **draws) - deployment_times(
        TABLE_6, tolerance=1e-9, **draws
    )
    assert np.median(np.abs(shift)) < 1e-7
    assert np.max(np.abs(shift)) < 1e-4


def test_a_sample_does_not_see_its_batch():
    draws = {name: values[:300] for name, values in table_6_draws(3000).items()}
    times = deployment_times(TABLE_6, threads=1, **draws)
    order = np.random.default_rng(0).permutation(300)
    shuffled = {name: values[order] for name, values in draws.items()}
    for threads in (2, 3, None):
        np.testing.assert_array_equal(
            deployment_times(TABLE_6, threads=threads, **shuffled), times[order]
        )
    alone = TABLE_6.replace(**{name: values[17] for name, values in draws.items()})
    assert deployment_times(alone)[0] == times[17]


def test_scalars_broadcast_and_lengths_are_used():
    times = deployment_times(TABLE_6, l_1=[1.5, 1.504], l_2=1.3, V_q=np.float32(140))
    assert times.shape == (2,)
    assert times[0] == time(DEFAULT_TOLERANCE)
    assert times[1] == time(DEFAULT_TOLERANCE, l_1=1.504)
    assert deployment_times(TABLE_6).shape == (1,)
    assert deployment_times(TABLE_6, V_q=[]).shape == (0,)


@pytest.mark.parametrize(
    "bad",
    [
        {"V_q": math.nan},
        {"V_q": math.inf},
        {"V_q": -1.0},
        {"delta": math.nan},
        {"k_d": math.nan},
        {"b": 0.0},
        {"b": -0.001},
        {"C_r": 0.0},
        {"C_r": 0.01},
        {"C_r": math.nan},
        {"l_1": -1.5},
        {"l_2": 0.09},
        {"l_2": 0.505},  # assembles, but starts beyond the lock
        {"k_d": 1e9},  # presses journals through their bearings
        {"C_r": 1e-9},  # not resolved beside the arms
    ],
)
def test_an_impossible_sample_is_nan_and_spoils_no_other(bad):
    (name, value), *_ = bad.items()
    good = getattr(TABLE_6, name)
    times = deployment_times(TABLE_6, **{name: [good, value, good]})
    assert np.isnan(times[1])
    assert times[0] == times[2] == time(DEFAULT_TOLERANCE)


def test_arms_too_short_for_the_lock_never_lock():
    assert deployment_times(TABLE_6, l_1=0.5, l_2=0.4)[0] == math.inf


def test_the_cache_is_keyed_by_every_source_of_the_room():
    closure = getattr(deploy_rows, "py_func", deploy_rows).__closure__
    assert fingerprint() in [cell.cell_contents for cell in closure]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"tolerance": math.nan}, "tolerance = nan"),
        ({"tolerance": 2e-4}, r"tolerance = 0.0002: give a number of metres in \[1e-16, 0.0001\]"),
        ({"tolerance": 1e-300}, "tolerance = 1e-300"),
        ({"tolerance": "1e-7"}, "tolerance = '1e-7'"),
        ({"threads": True}, "threads = True"),
        ({"V_q": ["120"]}, r"V_q = \['120'\]: give real numbers"),
        ({"C_r": [True]}, r"C_r = \[True\]: give real numbers"),
        ({"C_r": np.ma.array([0.001], mask=[True])}, "none of them masked"),
        ({"parameters": 5}, r"parameters = 5: give WingParameters"),
        ({"threads": 0}, "threads = 0"),
        ({"V_q": [[1.0]]}, r"V_q has shape \(1, 1\)"),
        ({"V_q": [1.0, 2.0], "b": [1.0, 2.0, 3.0]}, "lengths differ"),
    ],
)
def test_bad_calls_are_refused(arguments, message):
    with pytest.raises((ValueError, TypeError), match=message):
        deployment_times(**{"parameters": TABLE_6, **arguments})


def test_no_tolerance_that_is_accepted_gives_another_time():
    """Tolerances of 0.1, 1 and 100 m were accepted, for inf, 1.06 s and 0.66 s, not 0.535."""
    finest, coarsest = (
        deployment_times(TABLE_6, tolerance=tolerance)[0]
        for tolerance in (FINEST_TOLERANCE, COARSEST_TOLERANCE)
    )
    assert coarsest == pytest.approx(finest, abs=1e-3)
    for tolerance in (0.1, 1, 100):
        with pytest.raises(ValueError, match=f"tolerance = {tolerance}"):
            deployment_times(TABLE_6, tolerance=tolerance)


@pytest.mark.parametrize("times", [deployment_times, ideal_deployment_times])
def test_an_unknown_name_is_refused_with_those_that_are_known(times):
    with pytest.raises(TypeError, match=r"C_e: no parameter .* differ between samples.*V_q, delta"):
        times(TABLE_6, C_e=[0.8, 0.9])


def test_the_kernels_run_without_compilation():
    code = (
        "from uqfold.mechanism import WingParameters, trajectory;"
        "t = trajectory(WingParameters(C_r=0.0015, t_max=0.03));"
        "print(len(t.time), *t.coordinates[-1], t.energy_residual[-1], t.deployment_time)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        check=True,
        capture_output=True,
        text=True,
    )
    t = trajectory(TABLE_6.replace(t_max=0.03))
    compiled = [len(t.time), *t.coordinates[-1], t.energy_residual[-1], t.deployment_time]
    interpreted = [float(number) for number in run.stdout.split()]
    assert interpreted == pytest.approx(compiled, rel=1e-9, abs=1e-12)
