"""How far the time steps can be trusted: their order, and errors of times at usual tolerances.

* On a smooth stretch: both journals in contact and no contact beginning or ending, without
  friction, whose ramp has corners. From one state the time step's formula is repeated n times
  without error control; the end is compared with SciPy's DOP853 on the independent equations.
* Across impacts: whole motions from rest to a fixed time, at tolerances from 1e-6 to 1e-12 m; the
  positions at the end are compared with those at 1e-14 m. The contact force grows with the 1.5th
  power of the depth, so at each onset a time step begins at a point where the second derivative of
  the force is infinite: the velocity is left with an error of order h^2.5 per onset, whatever the
  order of the formula, unless the steps shrink there.
* Of whole deployments: times over draws of Table 6 against those at 1e-12 m, and how far a change
  of the clearance by a millionth moves them, since first impacts are chaotic.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times, trajectory
from uqfold.mechanism.loads import drive_force
from uqfold.mechanism.motion import accelerations, directions, gaps
from uqfold.mechanism.timestep import LARGEST_GROWTH, State, attempt
from uqfold.mechanism.wing import Wings, wing_constants
from uqfold.validation import Finding, Measurement, Points, Table, Work
from validation.mechanism.independent import FiveCoordinateWing
from validation.mechanism.parameter_sets import TABLE_6, draws_of_table_6, means

COUNTS = (8, 16, 32, 64, 128)
STRETCH = 1e-3
"""Length of the smooth stretch (s), about three vibrations of a contact."""
START = 0.071
"""Where it begins (s): both journals are in contact for six milliseconds."""
ONSET = 0.1
"""Rate (m/s) at which both contacts are said to have begun; it sets their damping."""
UNTIL = 0.05
"""Time (s) up to which motions across impacts are compared."""
IMPACT_TOLERANCES = tuple(10.0**-k for k in range(6, 13))
SMOOTH_ORDER, IMPACT_ORDER = 3.8, 2.3
TIME_TOLERANCES = (DEFAULT_TOLERANCE, 1e-7, 1e-8, 1e-9, 1e-10)
MEDIAN, ROOT_MEAN_SQUARE, BIAS, LARGEST = 2e-5, 5e-5, 5e-6, 3e-4
"""Largest errors of times (s) at the default tolerance."""


def smooth_errors(fault: str | None) -> list[dict[str, Any]]:
    """Errors (m, rad) at the end of the smooth stretch for each number of steps."""
    wing = means(TABLE_6).replace(C_f=0.0)
    motion = trajectory(wing, tolerance=1e-12)
    i = int(np.searchsorted(motion.time, START))
    q, v = tuple(motion.coordinates[i].tolist()), tuple(motion.velocities[i].tolist())
    w, d, t = wing_constants(Wings(wing).table()[0]), directions(q), float(motion.time[i])
    z = w.hysteresis / ONSET
    a = accelerations(w, q, v, d, z, z, drive_force(t, w.k_d))
    start = State(t, q, v, a, d, gaps(w, q, v, d), z, z)
    equations = FiveCoordinateWing(wing)
    run = solve_ivp(
        lambda t, y: equations.rates(t, y, [ONSET, ONSET]),
        (t, t + STRETCH),
        [*q, *v],
        method="DOP853",
        rtol=1e-13,
        atol=1e-16,
        max_step=STRETCH / 200,
    )
    rows = []
    for count in COUNTS:
        state, h = start, STRETCH / count
        for _ in range(count):
            end: State = attempt(w, state, h, LARGEST_GROWTH, math.inf, 1.0).end
            if fault == "second order":
                # positions by Taylor's formula to second order
                rates = zip(state.q, state.v, state.a, strict=True)
                end = end._replace(q=tuple(x + h * (v + 0.5 * h * a) for x, v, a in rates))
            state = end
        error = float(np.abs(np.array(state.q) - run.y[:5, -1]).max())
        rows.append({"stretch": "smooth", "steps": count, "error (m)": error})
    return rows


def impact_errors(wings: int, seed: int, fault: str | None) -> list[dict[str, Any]]:
    """Median error (m, rad) over wings, and median number of steps, at each tolerance."""
    rng = np.random.default_rng(seed)
    errors, steps = np.empty((2, wings, len(IMPACT_TOLERANCES)))
    for i in range(wings):
        draw = {name: rng.normal(mean, sigma) for name, (mean, sigma) in TABLE_6.items()}
        wing = WingParameters(**draw, t_max=UNTIL)
        end = trajectory(wing, tolerance=1e-14).coordinates[-1]
        for k, tolerance in enumerate(IMPACT_TOLERANCES):
            m = trajectory(wing, tolerance=tolerance)
            # of first order, as an onset leaves that is found to the length of a step
            more = 1e-2 / len(m.time) if fault == "onset missed" else 0.0
            errors[i, k] = np.abs(m.coordinates[-1] + more - end).max()
            steps[i, k] = len(m.time) - 1
    typical = np.exp(np.median(np.log(errors), axis=0))
    return [
        {"stretch": "across impacts", "steps": count, "error (m)": error}
        for count, error in zip(np.median(steps, axis=0), typical, strict=True)
    ]


def time_errors(draws: int, seed: int, fault: str | None) -> pd.DataFrame:
    """Errors (s) of deployment times, one row per tolerance, and with a clearance changed."""
    x, wing = draws_of_table_6(draws, seed), WingParameters()
    expected = deployment_times(wing, tolerance=1e-12, **x)
    coarser, later = 100.0 if fault == "coarse" else 1.0, 1e-5 if fault == "late" else 0.0
    found = {
        f"tolerance {tolerance:g} m": later
        + deployment_times(wing, tolerance=coarser * tolerance, **x)
        for tolerance in TIME_TOLERANCES
    }
    x["C_r"] = x["C_r"] * (1.0 + 1e-6)
    found["clearance changed by 1e-6"] = deployment_times(wing, tolerance=1e-12, **x)
    errors = {name: times - expected for name, times in found.items()}
    return pd.DataFrame(
        {
            "run": name,
            "median (s)": np.median(np.abs(error)),
            "root mean square (s)": np.sqrt(np.mean(error**2)),
            "bias (s)": np.mean(error),
            "standard error of the bias (s)": np.std(error, ddof=1) / np.sqrt(draws),
            "largest (s)": np.abs(error).max(),
            "share above 1e-6 s": np.mean(np.abs(error) > 1e-6),
            "share above 1e-5 s": np.mean(np.abs(error) > 1e-5),
        }
        for name, error in errors.items()
    )


def measure(work: Work) -> Measurement:
    """Measure the impacts of 8 or 100 wings, and the times of 400 or 20,000 draws."""
    wings, draws = work.pick(8, 100), work.pick(400, 20_000)
    across = impact_errors(wings, work.seeds[0], work.fault)
    steps = pd.DataFrame([*smooth_errors(work.fault), *across])
    # minus the slope of log(error) over log(number of steps)
    orders = {
        stretch: -np.polyfit(np.log(own["steps"]), np.log(own["error (m)"]), 1)[0]
        for stretch, own in steps.groupby("stretch")
    }
    times = time_errors(draws, work.seeds[1], work.fault)
    default, tight, nudged = times.iloc[0], times.iloc[-2], times.iloc[-1]
    bias = abs(default["bias (s)"]) - 2.0 * default["standard error of the bias (s)"]
    findings = [
        Finding("order on a smooth stretch", orders["smooth"], SMOOTH_ORDER, at_least=True),
        Finding("order across impacts", orders["across impacts"], IMPACT_ORDER, at_least=True),
        Finding("median error of times", default["median (s)"], MEDIAN, "s"),
        Finding("root mean square error", default["root mean square (s)"], ROOT_MEAN_SQUARE, "s"),
        Finding("size of the mean error, less two standard errors", max(bias, 0.0), BIAS, "s"),
        Finding("largest error", default["largest (s)"], LARGEST, "s"),
        Finding("median error at 1e-10 m", tight["median (s)"], 1e-6, "s"),
        Finding("clearance changed by 1e-6: share of times changed by over 1e-6 s",
                nudged["share above 1e-6 s"]),
        Finding("clearance changed by 1e-6: largest change", nudged["largest (s)"], unit="s"),
    ]  # fmt: skip
    title = "Error at the end of a stretch against the number of time steps"
    data = steps.rename(columns={"stretch": "series", "steps": "x", "error (m)": "y"})
    tables = [
        Table.of(f"Errors by number of steps; across impacts of {wings} wings", steps),
        Table.of(f"Errors of deployment times over {draws} draws of Table 6", times),
    ]
    points = Points(title, "time steps", "error (m)", Table.of(title, data), log="xy")
    return Measurement(findings, tables, [points])
