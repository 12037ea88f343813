"""The wing's motion a second way: complex numbers, virtual power and SciPy, no kernel of uqfold.

Points of the plane are complex numbers. Each force F at a point r(q) adds Re(conj(F) dr/dq) to the
generalised forces, and r' = sum of dr/dq q' is the velocity of the body's point that is touched.
"""

import cmath
import math

import numpy as np
from scipy.integrate import solve_ivp

DRIVE_CORNERS = (0.01, 0.61, 0.62)
_HAIR = 1e-11


def ramp(x, start, end):
    return min(max((x - start) / (end - start), 0.0), 1.0)


class Wing:
    """Masses, joints and loads of one parameter record."""

    def __init__(self, p):
        self.p = p
        m_1 = p.rho_1 * p.l_1 * p.w_1 * p.b
        m_2 = p.rho_2 * p.l_2 * p.w_2 * p.b
        m_3 = p.rho_3 * p.V_3
        about_A = m_1 * (p.l_1**2 / 3 + p.w_1**2 / 12)
        self.inertia = (about_A, m_2, m_2, m_2 * (p.l_2**2 + p.w_2**2) / 12, m_3)
        self.weight = [m * p.g * math.sin(p.delta) for m in (m_1, m_2, m_3)]
        self.drag = [0.5 * p.rho_a * p.C_0 * p.b * length * p.V_q**2 for length in (p.l_1, p.l_2)]
        self.R_j = p.R_b - p.C_r
        root = math.sqrt(p.R_b * self.R_j / (p.R_b + self.R_j))
        soft, hard = (1 - p.nu_1**2) / p.E_1, (1 - p.nu_2**2) / p.E_2
        self.K = (4 / (3 * (soft + soft)) * root, 4 / (3 * (hard + soft)) * root)

    def start(self):
        p = self.p
        B = cmath.rect(p.l_1, p.theta_1_initial)
        rise = B.imag + p.c
        rod = complex(math.sqrt(p.l_2**2 - rise**2), rise)
        middle, C = B - rod / 2, B - rod
        return np.array(
            [p.theta_1_initial, middle.real, middle.imag, cmath.phase(rod), C.real, 0, 0, 0, 0, 0]
        )

    def joint(self, y, which):
        """Eccentricity, its rate, and the half rod that points at the journal."""
        crank = cmath.rect(self.p.l_1, y[0])
        half = cmath.rect(self.p.l_2 / 2, y[3]) * (1, -1)[which]
        journal = complex(y[1], y[2]) + half
        journal_rate = complex(y[6], y[7]) + 1j * y[8] * half
        if which == 0:
            return journal - crank, journal_rate - 1j * y[5] * crank, half
        return journal - complex(y[4], -self.p.c), journal_rate - y[9], half

    def penetration(self, y, which):
        e, e_rate, _ = self.joint(y, which)
        return abs(e) - self.p.C_r, (e.conjugate() * e_rate).real / max(abs(e), 1e-99)

    def rates(self, t, y, onset):
        p = self.p
        y = y.tolist()
        crank = cmath.rect(p.l_1, y[0])
        Q = [0.0] * 5

        def push_crank(force, point):
            Q[0] += (force.conjugate() * 1j * point).real

        def push_rod(force, arm):
            Q[1] += force.real
            Q[2] += force.imag
            Q[3] += (force.conjugate() * 1j * arm).real

        push_crank(self.weight[0] + self.drag[0] * abs(math.sin(y[0])), crank / 2)
        push_rod(self.weight[1] + self.drag[1] * abs(math.sin(y[3])), 0)
        Q[4] = self.weight[2] + p.k_d * (ramp(t, 0, 0.01) - ramp(t, 0.61, 0.62))
        for which in (0, 1):
            if onset[which] is None:
                continue
            e, e_rate, half = self.joint(y, which)
            depth = abs(e) - p.C_r
            if depth <= 0:
                continue
            n = e / abs(e)
            along = n.conjugate() * e_rate  # normal and tangential rate
            if p.tangential_velocity == "geometric":
                slip = along.imag + (self.R_j - p.R_b) * along.imag / abs(e)
            else:
                slip = along.imag + self.R_j * y[8] - (p.R_b * y[5] if which == 0 else 0.0)
            hysteresis = 0.75 * (1 - p.C_e**2) * along.real / onset[which]
            F_N = max(0.0, self.K[which] * depth**1.5 * (1 + hysteresis))
            F_T = p.C_f * ramp(abs(slip), p.friction_v_0, p.friction_v_1) * F_N
            F = n * complex(F_N, math.copysign(F_T, slip))
            push_rod(-F, half + self.R_j * n)
            if which == 0:
                push_crank(F, crank + p.R_b * n)
            else:
                Q[4] += F.real
        return [*y[5:], *(q / i for q, i in zip(Q, self.inertia, strict=True))]


def deployment_time(p, rtol=1e-9, atol=1e-11, max_step=1e-4):
    """Time of the lock by SciPy, restarted wherever a contact begins or ends or the drive bends."""
    wing = Wing(p)
    y = wing.start()
    t = 0.0
    onset = [None, None]

    def lock(_, y):
        return y[4] - p.x_lock

    lock.terminal, lock.direction = True, 1
    switches = []
    for which in (0, 1):

        def switch(_, y, which=which):
            # a hair of hysteresis, so that a contact that has just ended or begun is seen to have
            margin = _HAIR if onset[which] else -_HAIR
            return wing.penetration(y.tolist(), which)[0] + margin

        switch.terminal = True
        switches.append(switch)
    while t < p.t_max:
        for which in (0, 1):
            switches[which].direction = -1 if onset[which] else 1
        run = solve_ivp(
            lambda t, y: wing.rates(t, y, onset),
            (t, min([c for c in DRIVE_CORNERS if c > t] + [p.t_max])),
            y,
            method="DOP853",
            rtol=rtol,
            atol=atol,
            events=[lock, *switches],
            max_step=max_step if any(onset) else 1e-3,
        )
        t, y = run.t[-1], run.y[:, -1]
        if len(run.t_events[0]):
            return t
        for which in (0, 1):
            if len(run.t_events[1 + which]):
                speed = max(wing.penetration(y.tolist(), which)[1], p.onset_velocity_floor)
                onset[which] = None if onset[which] else speed
    return np.inf
