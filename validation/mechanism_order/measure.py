"""Order of convergence of the time steps, on a smooth stretch and across impacts.

Smooth stretch: both journals in contact and no contact beginning or ending, without friction, whose
ramp has corners. From one state the time step's formula is repeated n times without error control,
and the end is compared with SciPy's DOP853 on the independent equations.

Across impacts: whole motions from rest to a fixed time, at tolerances from 1e-6 to 1e-12 m, with
the positions at the end compared with those at 1e-14 m. The contact force grows with the 1.5th
power of the depth, so at each onset a time step begins at a point where the second derivative of
the force is infinite: the velocity is left with an error of order h^2.5 per onset, whatever the
order of the formula, unless the steps shrink there.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

from uqfold.mechanism import WingParameters, trajectory
from uqfold.mechanism.loads import drive_force
from uqfold.mechanism.motion import accelerations, directions, gaps
from uqfold.mechanism.timestep import LARGEST_GROWTH, State, attempt
from uqfold.mechanism.wing import Wings, wing_constants
from uqfold.validation import Finding, Measurement, Points, Table, Work
from validation.mechanism.independent import FiveCoordinateWing
from validation.mechanism.parameter_sets import TABLE_6, means

COUNTS = (8, 16, 32, 64, 128)
STRETCH = 1e-3
"""Length of the smooth stretch (s), about three vibrations of a contact."""
UNTIL = 0.05
"""Time (s) up to which motions across impacts are compared."""
TOLERANCES = tuple(10.0**-k for k in range(6, 13))
SMOOTH_ORDER = 3.8
IMPACT_ORDER = 2.3


def contact_start(wing: WingParameters) -> tuple[State, Any, list[float]]:
    """Return a state with both contacts on for `STRETCH`, the kernels' constants, onset rates."""
    w = wing_constants(Wings(wing).table()[0])
    m = trajectory(wing, tolerance=1e-12)
    touching = m.penetration > 1e-9
    switches = np.flatnonzero((touching[1:] != touching[:-1]).any(axis=1)) + 1
    begin = next(
        int(begin)
        for begin, end in pairwise(switches)
        if touching[begin + 1 : end - 1].all() and m.time[end - 1] - m.time[begin] > 1.5 * STRETCH
    )
    onsets = []
    for joint in (0, 1):
        first = int(np.flatnonzero(~touching[: begin + 1, joint])[-1])
        q, v = tuple(m.coordinates[first]), tuple(m.velocities[first])
        onsets.append(max(gaps(w, q, v, directions(q))[2 * joint + 1], wing.onset_velocity_floor))
    z_B, z_C = (w.hysteresis / onset for onset in onsets)
    i = begin + 2
    q, v = tuple(m.coordinates[i].tolist()), tuple(m.velocities[i].tolist())
    d, t = directions(q), float(m.time[i])
    a = accelerations(w, q, v, d, z_B, z_C, drive_force(t, w.k_d))
    return State(t, q, v, a, d, gaps(w, q, v, d), z_B, z_C), w, onsets


def smooth_errors(fault: str | None) -> list[dict[str, Any]]:
    """Errors (m, rad) at the end of the smooth stretch for each number of steps."""
    wing = means(TABLE_6).replace(C_f=0.0)
    start, w, onsets = contact_start(wing)
    equations = FiveCoordinateWing(wing)
    run = solve_ivp(
        lambda t, y: equations.rates(t, y, onsets),
        (start.t, start.t + STRETCH),
        [*start.q, *start.v],
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
        rows.append(
            {"stretch": "smooth", "tolerance (m)": None, "steps": count, "error (m)": error}
        )
    return rows


def impact_errors(wings: int, seed: int, fault: str | None) -> list[dict[str, Any]]:
    """Median error (m, rad) over wings, and median number of steps, at each tolerance."""
    rng = np.random.default_rng(seed)
    errors, steps = np.empty((2, wings, len(TOLERANCES)))
    for i in range(wings):
        draw = {name: rng.normal(mean, sigma) for name, (mean, sigma) in TABLE_6.items()}
        wing = WingParameters(**draw, t_max=UNTIL)
        end = trajectory(wing, tolerance=1e-14).coordinates[-1]
        for k, tolerance in enumerate(TOLERANCES):
            m = trajectory(wing, tolerance=tolerance)
            # of first order, as an onset leaves that is found to the length of a step
            more = 1e-2 / len(m.time) if fault == "onset missed" else 0.0
            errors[i, k] = np.abs(m.coordinates[-1] + more - end).max()
            steps[i, k] = len(m.time) - 1
    return [
        {
            "stretch": "across impacts",
            "tolerance (m)": tolerance,
            "steps": float(np.median(steps[:, k])),
            "error (m)": math.exp(float(np.median(np.log(errors[:, k])))),
        }
        for k, tolerance in enumerate(TOLERANCES)
    ]


def measure(work: Work) -> Measurement:
    """Measure on one smooth stretch, and across the impacts of 8, 24 or 100 wings."""
    wings = work.pick(8, 100)
    across = impact_errors(wings, work.seeds[0], work.fault)
    rows = pd.DataFrame([*smooth_errors(work.fault), *across])
    # minus the slope of log(error) over log(number of steps)
    orders = {
        stretch: -np.polyfit(np.log(own["steps"]), np.log(own["error (m)"]), 1)[0]
        for stretch, own in rows.groupby("stretch")
    }
    findings = [
        Finding("order on a smooth stretch", orders["smooth"], SMOOTH_ORDER, at_least=True),
        Finding("order across impacts", orders["across impacts"], IMPACT_ORDER, at_least=True),
        Finding("median error across impacts at 1e-6 m", across[0]["error (m)"], unit="m"),
    ]
    table = Table.of(f"Errors by number of steps; across impacts of {wings} wings", rows)
    title = "Error at the end of a stretch against the number of time steps"
    data = rows.rename(columns={"stretch": "series", "steps": "x", "error (m)": "y"})
    drawn = Table.of(title, data[["series", "x", "y"]])
    return Measurement(
        findings, [table], [Points(title, "time steps", "error (m)", drawn, log="xy")]
    )
