"""The wing's motion by general solvers, restarted wherever a contact begins or ends.

The equations are written once in plain Python and run as they are or compiled by numba. They are
those of the default wing: Lankarani-Nikravesh contact, geometric tangential velocity.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from uqfold.mechanism.loads import DRIVE_FALL_END, DRIVE_FALL_START, DRIVE_RISE_END
from uqfold.mechanism.wing import Wing, WingConstants, initial_pose, wing_constants

# A contact begins at this depth (m) and ends at this distance, so that each is seen to have begun.
_HAIR = 1e-9
_MOST_RESTARTS = 2000


def _build(jit: Callable[[Any], Any]) -> tuple[Any, Any]:
    """Rates of the ten states, and contact functions with their rates."""

    def plain_force(e_x, e_y, r_x, r_y, C_r, K, z, w):  # type: ignore[no-untyped-def]
        distance = math.sqrt(e_x * e_x + e_y * e_y)
        depth = distance - C_r
        if z < 0.0 or depth <= 0.0:
            return 0.0, 0.0, 0.0
        n_x = e_x / distance
        n_y = e_y / distance
        slip = (r_y * n_x - r_x * n_y) * depth / distance
        normal = K * depth * math.sqrt(depth) * (1.0 + z * (r_x * n_x + r_y * n_y))
        if normal <= 0.0:
            return 0.0, 0.0, 0.0
        ramp = min(max((abs(slip) - w.v_0) * w.ramp_slope, 0.0), 1.0)
        tangential = math.copysign(w.C_f * ramp * normal, slip)
        return n_x * normal - n_y * tangential, n_y * normal + n_x * tangential, tangential

    force = jit(plain_force)

    def rates(t, y, w, z_B, z_C):  # type: ignore[no-untyped-def]
        q_1, x_2, y_2, q_2, x_3, u_1, u_2, v_2, u_3, u_4 = y
        c_1 = math.cos(q_1)
        s_1 = math.sin(q_1)
        a_x = w.half_l_2 * math.cos(q_2)
        a_y = w.half_l_2 * math.sin(q_2)
        b_x = w.l_1 * c_1
        b_y = w.l_1 * s_1
        B_x, B_y, B_t = force(
            x_2 + a_x - b_x,
            y_2 + a_y - b_y,
            u_2 - a_y * u_3 + b_y * u_1,
            v_2 + a_x * u_3 - b_x * u_1,
            w.C_r_B,
            w.K_B,
            z_B,
            w,
        )
        C_x, C_y, C_t = force(
            x_2 - a_x - x_3,
            y_2 - a_y + w.c,
            u_2 + a_y * u_3 - u_4,
            v_2 - a_x * u_3,
            w.C_r_C,
            w.K_C,
            z_C,
            w,
        )
        drive = 0.0
        if t < 0.01:
            drive = 100.0 * t
        elif t <= 0.61:
            drive = 1.0
        elif t < 0.62:
            drive = 100.0 * (0.62 - t)
        load_1 = w.D_1 * abs(s_1) + w.G_1
        load_2 = w.D_2 * abs(a_y) / w.half_l_2 + w.G_2
        return (
            u_1,
            u_2,
            v_2,
            u_3,
            u_4,
            (b_x * B_y - b_y * B_x + w.R_b * B_t - w.half_l_1 * s_1 * load_1) * w.inverse_J_A,
            (load_2 - B_x - C_x) * w.inverse_m_2,
            -(B_y + C_y) * w.inverse_m_2,
            (a_x * (C_y - B_y) - a_y * (C_x - B_x) - w.R_j_B * B_t - w.R_j_C * C_t) * w.inverse_J_2,
            (w.G_3 + w.k_d * drive + C_x) * w.inverse_m_3,
        )

    def gaps(y, w):  # type: ignore[no-untyped-def]
        q_1, x_2, y_2, q_2, x_3, u_1, u_2, v_2, u_3, u_4 = y
        a_x = w.half_l_2 * math.cos(q_2)
        a_y = w.half_l_2 * math.sin(q_2)
        b_x = w.l_1 * math.cos(q_1)
        b_y = w.l_1 * math.sin(q_1)
        e_x = x_2 + a_x - b_x
        e_y = y_2 + a_y - b_y
        f_x = x_2 - a_x - x_3
        f_y = y_2 - a_y + w.c
        rate_B = e_x * (u_2 - a_y * u_3 + b_y * u_1) + e_y * (v_2 + a_x * u_3 - b_x * u_1)
        rate_C = f_x * (u_2 + a_y * u_3 - u_4) + f_y * (v_2 - a_x * u_3)
        return (
            0.5 * ((e_x * e_x + e_y * e_y) / w.C_r_B - w.C_r_B),
            rate_B / w.C_r_B,
            0.5 * ((f_x * f_x + f_y * f_y) / w.C_r_C - w.C_r_C),
            rate_C / w.C_r_C,
        )

    return jit(rates), jit(gaps)


_plain_rates, _plain_gaps = _build(lambda function: function)
_fast_rates, _fast_gaps = _build(njit)


@njit
def _states(y):  # type: ignore[no-untyped-def]
    return y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8], y[9]


@njit
def _fill_rates(t, y, rates, w, z):  # type: ignore[no-untyped-def]
    values = _fast_rates(t, _states(y), w[0], z[0], z[1])
    for k in range(10):
        rates[k] = values[k]


@njit
def _new_rates(t, y, w, z):  # type: ignore[no-untyped-def]
    rates = np.empty(10)
    _fill_rates(t, y, rates, w, z)
    return rates


@njit
def _fill_events(y, events, w, z):  # type: ignore[no-untyped-def]
    gap_B, _, gap_C, _ = _fast_gaps(_states(y), w[0])
    events[0] = y[4] - w[0].x_lock
    events[1] = (gap_B if z[0] < 0.0 else -gap_B) - _HAIR
    events[2] = (gap_C if z[1] < 0.0 else -gap_C) - _HAIR


@njit
def _gap(y, w, z, joint):  # type: ignore[no-untyped-def]
    gap = _fast_gaps(_states(y), w[0])[2 * joint]
    return (gap if z[joint] < 0.0 else -gap) - _HAIR


@dataclass(frozen=True)
class Solver:
    """A general solver with its settings; `integrate` gives the deployment time (s) of one wing."""

    name: str
    method: str
    compiled: bool
    rtol: float
    atol: float

    def integrate(self, p: Wing) -> float:
        """Return the deployment time (s) of a wing."""
        w = wing_constants(p)
        start = np.array([*initial_pose(p), 0.0, 0.0, 0.0, 0.0, 0.0])
        segment = self._cvode(w) if self.name == "CVODE" else self._scipy(w)
        return _deploy(w, start, segment)

    def _scipy(self, w: WingConstants) -> Segment:
        record = _record(w)

        def segment(t: float, y: np.ndarray, end: float, z: np.ndarray) -> Reached:
            def lock(_: float, y: np.ndarray) -> float:
                return float(y[4] - w.x_lock)

            def switch(joint: int) -> Any:
                sign = 1.0 if z[joint] < 0.0 else -1.0

                def plain(_: float, y: np.ndarray) -> float:
                    return float(sign * _plain_gaps(y.tolist(), w)[2 * joint] - _HAIR)

                def compiled(_: float, y: np.ndarray) -> float:
                    return float(_gap(y, record, z, joint))

                return compiled if self.compiled else plain

            z_B, z_C = z.tolist()
            events = [lock, switch(0), switch(1)]
            for event in events:
                event.terminal, event.direction = True, 1
            # a trial step that is rejected may overflow
            with np.errstate(invalid="ignore", over="ignore"):
                run = solve_ivp(
                    (lambda t, y: _new_rates(t, y, record, z))
                    if self.compiled
                    else (lambda t, y: _plain_rates(t, y.tolist(), w, z_B, z_C)),
                    (t, end),
                    y,
                    method=self.method,
                    rtol=self.rtol,
                    atol=self.atol,
                    events=events,
                )
            return run.t[-1], run.y[:, -1], [len(times) > 0 for times in run.t_events]

        return segment

    def _cvode(self, w: WingConstants) -> Segment:
        from sksundae.cvode import CVODE  # type: ignore[import-untyped]

        record = _record(w)
        z = np.full(2, -1.0)

        def rates(t: float, y: np.ndarray, yp: np.ndarray) -> None:
            _fill_rates(t, y, yp, record, z)

        def events(_: float, y: np.ndarray, values: np.ndarray) -> None:
            _fill_events(y, values, record, z)

        events.direction = [1, 1, 1]  # type: ignore[attr-defined]
        solver = CVODE(
            rates,
            eventsfn=events,
            num_events=3,
            method=self.method,
            rtol=self.rtol,
            atol=self.atol,
            max_num_steps=1_000_000,
        )

        def segment(t: float, y: np.ndarray, end: float, damping: np.ndarray) -> Reached:
            z[:] = damping
            solver.init_step(t, y)
            run = solver.step(end, tstop=end)
            reached = [False] * 3
            if run.i_events is not None:
                reached = (np.asarray(run.i_events).reshape(-1, 3)[-1] != 0).tolist()
            return float(run.t), np.array(run.y).reshape(-1), reached

        return segment


Reached = tuple[float, np.ndarray, list[bool]]
"""Time (s), states, and whether there was the lock, a switch of B, a switch of C."""

Segment = Callable[[float, np.ndarray, float, np.ndarray], Reached]
"""Integrates from (t, y) to the end of time given, or the first event, under given dampings."""


def _record(w: WingConstants) -> Any:
    """The same constants in a form that compiled code takes over at no cost."""
    return np.array([tuple(w)], dtype=[(name, float) for name in w._fields])


def _deploy(w: WingConstants, y: np.ndarray, segment: Segment) -> float:
    """Deployment time (s) of one wing, restarted at events and at corners of the drive."""
    t = 0.0
    z = np.full(2, -1.0)
    corners = [*(c for c in (DRIVE_RISE_END, DRIVE_FALL_START, DRIVE_FALL_END)), w.t_max]
    for _ in range(_MOST_RESTARTS):
        end = min(c for c in corners if c > t)
        t, y, reached = segment(t, y, end, z)
        if reached[0]:
            return t
        rates = _plain_gaps(y.tolist(), w)[1::2]
        for joint in (0, 1):
            if reached[1 + joint]:
                begins = z[joint] < 0.0
                speed = max(rates[joint], w.onset_velocity_floor)
                z[joint] = w.hysteresis / speed if begins else -1.0
        if t >= w.t_max:
            return math.inf
    return math.nan
