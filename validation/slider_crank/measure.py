"""A mechanism with a clearance joint after published ones: the slider-crank at 5000 rpm.

The mechanism on which clearance joints are commonly shown (P. Flores, J. Ambrosio, J. C. P. Claro,
H. M. Lankarani, C. S. Koshy, Mech. Mach. Theory 41 (2006) 247-261; P. Flores, Nonlinear Dyn. 61
(2010) 633-653): the crank turns evenly, the joint of crank and rod is ideal, that of rod and slider
has a clearance and no friction. It is rebuilt from its parameters with stiffness and contact force
of `uqfold.mechanism.contact` and a loop of its own.

What these papers report of the motion they report in figures, which give no numbers to compare
with. Put in words, and judged here, is that the mechanism runs regularly at some clearances and
chaotically at others (abstract of the paper on clearance size and friction in Proc. ASME IDETC-CIE
2003, vol. 37033, p. 2679). That a smaller clearance brings it closer to the ideal mechanism is a
matter of course, and judged as well.

Formulas of the contact laws, titles and pages were checked against reference lists and codes of
others. The dimensions could not be: the papers' text was not at hand when they were written down.
Until they are, whether this is the published mechanism cannot be judged, and neither can the claim.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from numba import njit

from uqfold.mechanism.contact import contact_forces, hertz_stiffness, hysteresis_factor
from uqfold.validation import Finding, Measurement, Table, Work

# Crank and rod (m), rod (kg, kg m^2), slider (kg), crank speed (rad/s)
CRANK, ROD = 0.05, 0.12
ROD_MASS, ROD_INERTIA, SLIDER_MASS = 0.21, 0.00025, 0.14
SPEED = 5000.0 * 2.0 * math.pi / 60.0
PERIOD = 2.0 * math.pi / SPEED
# Bearing (m), both bodies' modulus (Pa) and Poisson's ratio, restitution
R_b, MODULUS, POISSON, RESTITUTION = 0.010, 207e9, 0.3, 0.9
ONSET_VELOCITY_FLOOR = 1e-3

CLEARANCES = (0.5e-3, 0.2e-3, 0.1e-3, 0.05e-3, 0.01e-3)
TURNS, SETTLED = 24, 16
"""Turns of the crank, and how many of them to leave out."""

STEPS = 60_000
"""Time steps per turn (0.2 microseconds each)."""

POINTS = 600
"""Points kept per turn."""

NUDGE = 1e-9
"""Change of the slider's initial position (m) whose growth shows chaos."""

REGULAR, IRREGULAR = 1e-6, 1e-3
"""Scatter from turn to turn, over the ideal peak velocity, of regular and of chaotic motion."""


@njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _gap(t, psi, x, w, v, C_r):  # type: ignore[no-untyped-def]
    """Penetration (m) of journal on the rod and bearing in the slider, its rate, its direction."""
    cosine, sine = math.cos(SPEED * t), math.sin(SPEED * t)
    c, s = math.cos(psi), math.sin(psi)
    e_x, e_y = CRANK * cosine + ROD * c - x, CRANK * sine + ROD * s
    r_x = -CRANK * SPEED * sine - ROD * s * w - v
    r_y = CRANK * SPEED * cosine + ROD * c * w
    distance = math.sqrt(e_x * e_x + e_y * e_y)
    if distance == 0.0:
        return -C_r, 0.0, 0.0, 0.0
    n_x, n_y = e_x / distance, e_y / distance
    return distance - C_r, r_x * n_x + r_y * n_y, n_x, n_y


@njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _accelerations(t, psi, x, w, v, C_r, K, damping):  # type: ignore[no-untyped-def]
    """Accelerations of the rod's angle and of the slider."""
    depth, rate, n_x, n_y = _gap(t, psi, x, w, v, C_r)
    normal = 0.0
    if depth > 0.0 and damping >= 0.0:
        normal, _ = contact_forces(depth, rate, 0.0, K, damping, 0.0, 1e-3, 1.0)
    f_x, f_y = normal * n_x, normal * n_y
    c, s = math.cos(psi), math.sin(psi)
    # about the crank pin, which is accelerated towards the crank's pivot
    pin = CRANK * SPEED * SPEED
    along = pin * math.cos(SPEED * t) * s - pin * math.sin(SPEED * t) * c
    moment = ROD * (s * f_x - c * f_y) - 0.5 * ROD_MASS * ROD * along
    return moment / (ROD_INERTIA + 0.25 * ROD_MASS * ROD * ROD), f_x / SLIDER_MASS


@njit(error_model="numpy")  # type: ignore[untyped-decorator]
def _run(x, turns, steps, C_r, K, hysteresis, kept):  # type: ignore[no-untyped-def]
    """Fill `kept` (n, 5): time, slider's position, velocity, acceleration, penetration."""
    psi, w, v = 0.0, -CRANK * SPEED / ROD, 0.0
    h = PERIOD / steps
    damping = -1.0
    depth, rate, _, _ = _gap(0.0, psi, x, w, v, C_r)
    contacts, k = 0, 0
    for i in range(turns * steps):
        t = i * h
        a_1, b_1 = _accelerations(t, psi, x, w, v, C_r, K, damping)
        if i % (steps // POINTS) == 0:
            kept[k, 0], kept[k, 1], kept[k, 2], kept[k, 3], kept[k, 4] = t, x, v, b_1, depth
            k += 1
        half = 0.5 * h
        w_2, v_2 = w + half * a_1, v + half * b_1
        a_2, b_2 = _accelerations(t + half, psi + half * w, x + half * v, w_2, v_2, C_r, K, damping)
        w_3, v_3 = w + half * a_2, v + half * b_2
        a_3, b_3 = _accelerations(
            t + half, psi + half * w_2, x + half * v_2, w_3, v_3, C_r, K, damping
        )
        w_4, v_4 = w + h * a_3, v + h * b_3
        a_4, b_4 = _accelerations(t + h, psi + h * w_3, x + h * v_3, w_4, v_4, C_r, K, damping)
        psi += h / 6.0 * (w + 2.0 * w_2 + 2.0 * w_3 + w_4)
        x += h / 6.0 * (v + 2.0 * v_2 + 2.0 * v_3 + v_4)
        w += h / 6.0 * (a_1 + 2.0 * a_2 + 2.0 * a_3 + a_4)
        v += h / 6.0 * (b_1 + 2.0 * b_2 + 2.0 * b_3 + b_4)
        new, new_rate, _, _ = _gap(t + h, psi, x, w, v, C_r)
        if new > 0.0 and damping < 0.0:
            # the onset lies within the step; speed^2 is taken linear in the distance
            share = -depth / (new - depth)
            onset = math.sqrt(max(rate * rate + share * (new_rate**2 - rate * rate), 0.0))
            damping = hysteresis / max(onset, ONSET_VELOCITY_FLOOR)
            contacts += 1
        elif new <= 0.0:
            damping = -1.0
        depth, rate = new, new_rate
    return contacts


def simulate(
    C_r: float, hysteresis: float, steps: int = STEPS, nudge: float = 0.0
) -> tuple[np.ndarray, int]:
    """Run from the ideal configuration: kept points, shape (turns, POINTS, 5), and contacts."""
    K = hertz_stiffness(R_b, R_b - C_r, MODULUS, POISSON, MODULUS, POISSON)
    kept = np.empty((TURNS * POINTS, 5))
    contacts = _run(CRANK + ROD + nudge, TURNS, steps, C_r, K, hysteresis, kept)
    return kept.reshape(TURNS, POINTS, 5), int(contacts)


def ideal(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration of the slider with an ideal joint."""
    c, s = np.cos(SPEED * t), np.sin(SPEED * t)
    root = np.sqrt(ROD**2 - (CRANK * s) ** 2)
    root_1 = -(CRANK**2) * s * c / root
    root_2 = -(CRANK**2) * (c * c - s * s) / root - root_1**2 / root
    position = CRANK * c + root
    return position, SPEED * (root_1 - CRANK * s), SPEED**2 * (root_2 - CRANK * c)


def motion_row(C_r: float, hysteresis: float) -> dict[str, Any]:
    """Return how the slider moves with one clearance, once it has settled."""
    points, contacts = simulate(C_r, hysteresis)
    nudged, _ = simulate(C_r, hysteresis, nudge=NUDGE)
    finer, _ = simulate(C_r, hysteresis, steps=2 * STEPS)
    position, velocity, acceleration = ideal(points[..., 0])
    late = points[SETTLED:]
    away = np.abs(late[..., 1] - position[SETTLED:]).max()
    return {
        "clearance (mm)": 1e3 * C_r,
        "contacts per turn": contacts / TURNS,
        "share of time apart": np.mean(late[..., 4] <= 0.0),
        "deviation of position (mm)": 1e3 * away,
        "deviation of acceleration (m/s^2)": np.abs(late[..., 3] - acceleration[SETTLED:]).max(),
        "scatter of velocity from turn to turn": np.ptp(late[..., 2], axis=0).max()
        / np.abs(velocity).max(),
        "growth of a nudge": np.abs(nudged - points)[SETTLED:, :, 1].max() / NUDGE,
        "change by half the step (m)": np.abs(finer - points)[0, :, 1].max(),
    }


def measure(work: Work) -> Measurement:
    """Run all clearances, and compare with what the papers put in words; the tiers are the same."""
    hysteresis = hysteresis_factor("lankarani-nikravesh", RESTITUTION)
    if work.fault == "damping's sign":
        # contacts that feed energy in keep even the smallest clearances rattling
        hysteresis = -0.3
    rows = pd.DataFrame(motion_row(C_r, hysteresis) for C_r in CLEARANCES)
    largest = rows.iloc[0]
    scatter = rows["scatter of velocity from turn to turn"]
    # each over that of the next larger clearance
    ratios = (rows / rows.shift()).max()
    acceleration = np.abs(ideal(np.linspace(0.0, PERIOD, 1000))[2]).max()
    peak = 1.0 + largest["deviation of acceleration (m/s^2)"] / acceleration
    findings = [
        Finding("scatter of velocity at 0.5 mm", scatter[0], IRREGULAR, at_least=True),
        Finding("growth of a change of 1e-9 m at 0.5 mm", largest["growth of a nudge"], 1e3,
                at_least=True),
        Finding("scatter of velocity up to 0.1 mm",
                scatter[rows["clearance (mm)"] <= 0.1].max(), REGULAR),
        Finding("deviation of position, smaller over next larger clearance",
                ratios["deviation of position (mm)"], 1.0),
        Finding("deviation of acceleration, smaller over next larger clearance",
                ratios["deviation of acceleration (m/s^2)"], 1.0),
        Finding("change of the first turn by half the step",
                rows["change by half the step (m)"].max(), unit="m"),
        Finding("peak acceleration at 0.5 mm over that of the ideal mechanism", peak),
        Finding("dimensions of the published mechanism",
                remark="not checked: the papers' text was not at hand"),
        Finding("peaks of acceleration, contact force and crank moment against the papers",
                remark="the papers give them in figures only"),
    ]  # fmt: skip
    return Measurement(findings, [Table.of("Motion of the slider by clearance", rows)])
