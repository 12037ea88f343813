"""Loads on the wing from outside: drive (13), drag (14) and gravity (15)-(16)."""

import math

from uqfold.mechanism.compiled import inlined, kernel

DRIVE_RISE_END = 0.01
DRIVE_FALL_START = 0.61
DRIVE_FALL_END = 0.62


@inlined
def drive_force(t: float, k_d: float) -> float:
    """Force of the cylinder on the slider (N) at time `t` (s), Eq. (13); 0 after 0.62 s."""
    if t < DRIVE_RISE_END:
        return 100.0 * k_d * t
    if t <= DRIVE_FALL_START:
        return k_d
    if t < DRIVE_FALL_END:
        return 100.0 * k_d * (DRIVE_FALL_END - t)
    return 0.0


@inlined
def next_drive_corner(t: float, t_max: float) -> float:
    """First time after `t` (s) at which the slope of the drive jumps, or `t_max`."""
    if t < DRIVE_RISE_END:
        corner = DRIVE_RISE_END
    elif t < DRIVE_FALL_START:
        corner = DRIVE_FALL_START
    elif t < DRIVE_FALL_END:
        corner = DRIVE_FALL_END
    else:
        corner = t_max
    return min(corner, t_max)


@kernel
def drag_coefficient(rho_a: float, C_0: float, b: float, l_i: float, V_q: float) -> float:
    """Drag of body i per unit of |sin(theta_i)| (N), Eq. (14)."""
    return 0.5 * rho_a * C_0 * b * l_i * V_q * V_q


@kernel
def gravity_force(m_i: float, g: float, delta: float) -> float:
    """Weight of body i along X (N), signed as in Eq. (16)."""
    return m_i * g * math.sin(delta)
