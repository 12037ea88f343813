"""Equations of motion of the wing in the five coordinates that constraints (10) leave free.

Coordinates q = (theta_1, x_2, y_2, theta_2, x_3), velocities v = dq/dt. The crank turns about the
fixed pivot A, so its centroid follows from theta_1, its inertia is J_1 + m_1 (l_1 / 2)^2, and the
forces of joint B enter with their moment about A; theta_3 = 0 and y_3 = -c drop out.
"""

import math

from uqfold.mechanism.compiled import inlined
from uqfold.mechanism.contact import contact_forces
from uqfold.mechanism.wing import WingConstants

Five = tuple[float, float, float, float, float]
"""One value per coordinate."""

Four = tuple[float, float, float, float]
"""cos(theta_1), sin(theta_1), cos(theta_2), sin(theta_2); or X and Y of joint B, then of C."""

LARGEST_TURN = 0.02
"""Turn (rad) up to which `turned` is exact to 1e-13."""


@inlined
def directions(q: Five) -> Four:
    """Cosine and sine of theta_1, then of theta_2."""
    return math.cos(q[0]), math.sin(q[0]), math.cos(q[3]), math.sin(q[3])


@inlined
def turned(d: Four, q: Five, q_new: Five) -> Four:
    """Directions at `q_new`, up to `LARGEST_TURN` away, given the directions `d` at `q`."""
    c_1, s_1 = _rotate(d[0], d[1], q_new[0] - q[0])
    c_2, s_2 = _rotate(d[2], d[3], q_new[3] - q[3])
    return c_1, s_1, c_2, s_2


@inlined
def _rotate(cosine: float, sine: float, turn: float) -> tuple[float, float]:
    """Cosine and sine of an angle turned on by `turn` (rad).

    Within a time step the turn is tiny, and a short series replaces the library's functions, which
    would cost as much as the rest of the equations of motion and know no packed form.
    """
    z = turn * turn
    c = 1.0 - z * (1 / 2 - z * (1 / 24))
    s = turn * (1.0 - z * (1 / 6 - z * (1 / 120)))
    return cosine * c - sine * s, sine * c + cosine * s


@inlined
def eccentricities(w: WingConstants, q: Five, d: Four) -> Four:
    """Eccentricities (m), Eq. (1), of B and C: journal centre minus bearing centre."""
    return (
        q[1] + w.half_l_2 * d[2] - w.l_1 * d[0],
        q[2] + w.half_l_2 * d[3] - w.l_1 * d[1],
        q[1] - w.half_l_2 * d[2] - q[4],
        q[2] - w.half_l_2 * d[3] + w.c,
    )


@inlined
def eccentricity_rates(w: WingConstants, v: Five, d: Four) -> Four:
    """Rates of the eccentricities (m/s)."""
    return (
        v[1] - w.half_l_2 * d[3] * v[3] + w.l_1 * d[1] * v[0],
        v[2] + w.half_l_2 * d[2] * v[3] - w.l_1 * d[0] * v[0],
        v[1] + w.half_l_2 * d[3] * v[3] - v[4],
        v[2] - w.half_l_2 * d[2] * v[3],
    )


@inlined
def gaps(w: WingConstants, q: Five, v: Five, d: Four) -> Four:
    """Contact functions of B and C and their rates: (B, rate of B, C, rate of C) in m and m/s.

    The contact function (|e|^2 - C_r^2) / (2 C_r) has the sign of the penetration (2), and where it
    vanishes its rate is the penetration velocity; unlike the penetration it is smooth where the
    journal is centred.
    """
    e = eccentricities(w, q, d)
    rate = eccentricity_rates(w, v, d)
    return (
        0.5 * ((e[0] * e[0] + e[1] * e[1]) * w.inverse_C_r_B - w.C_r_B),
        (e[0] * rate[0] + e[1] * rate[1]) * w.inverse_C_r_B,
        0.5 * ((e[2] * e[2] + e[3] * e[3]) * w.inverse_C_r_C - w.C_r_C),
        (e[2] * rate[2] + e[3] * rate[3]) * w.inverse_C_r_C,
    )


@inlined
def joint_force(
    w: WingConstants,
    e_x: float,
    e_y: float,
    rate_x: float,
    rate_y: float,
    roll: float,
    C_r: float,
    stiffness: float,
    damping: float,
) -> tuple[float, float, float]:
    """Contact force on the bearing of one joint, Eqs. (2) to (8).

    Parameters
    ----------
    w : WingConstants
        The wing.
    e_x, e_y, rate_x, rate_y : float
        Eccentricity (m) and its rate (m/s).
    roll : float
        R_j times the angular velocity of the journal minus R_b times that of the bearing (m/s).
    C_r : float
        Clearance of the joint (m).
    stiffness : float
        K of Eq. (6) (N/m^1.5).
    damping : float
        Hysteresis factor over the penetration velocity at onset (s/m), negative while the joint is
        not in contact.

    Returns
    -------
    tuple of three floats
        Force along X and Y (N), and its part along the tangent (N). The normal part points at the
        centres of both circles, so that the tangential one alone, with the radius as its arm, has
        a moment about them.
    """
    square = e_x * e_x + e_y * e_y
    if damping < 0.0 or square <= C_r * C_r:
        return 0.0, 0.0, 0.0
    distance = math.sqrt(square)
    inverse = 1.0 / distance
    n_x = e_x * inverse
    n_y = e_y * inverse
    penetration = distance - C_r
    rate = rate_x * n_x + rate_y * n_y
    sliding = rate_y * n_x - rate_x * n_y
    if w.material != 0.0:
        sliding += roll
    else:
        # Eqs. (3), (4): the radii of the two contact points differ by C_r, and dn/dt is the
        # tangential rate over |e|, which leaves (|e| - C_r) (dn/dt . t)
        sliding *= penetration * inverse
    normal, tangential = contact_forces(
        penetration, rate, sliding, stiffness, damping, w.C_f, w.v_0, w.ramp_slope
    )
    return n_x * normal - n_y * tangential, n_y * normal + n_x * tangential, tangential


@inlined
def joint_forces(
    w: WingConstants, q: Five, v: Five, d: Four, damping_B: float, damping_C: float
) -> tuple[float, float, float, float, float, float]:
    """Contact forces on the bearings (N): X, Y and tangential part of B, then of C."""
    e = eccentricities(w, q, d)
    rate = eccentricity_rates(w, v, d)
    roll_B = w.R_j_B * v[3] - w.R_b * v[0]
    roll_C = w.R_j_C * v[3]
    B_x, B_y, B_t = joint_force(w, e[0], e[1], rate[0], rate[1], roll_B, w.C_r_B, w.K_B, damping_B)
    C_x, C_y, C_t = joint_force(w, e[2], e[3], rate[2], rate[3], roll_C, w.C_r_C, w.K_C, damping_C)
    return B_x, B_y, B_t, C_x, C_y, C_t


@inlined
def accelerations(
    w: WingConstants,
    q: Five,
    v: Five,
    d: Four,
    damping_B: float,
    damping_C: float,
    drive: float,
) -> Five:
    """Accelerations of the five coordinates (rad/s^2, m/s^2), Eqs. (16) to (19) in reduced form.

    Parameters
    ----------
    w : WingConstants
        The wing.
    q, v, d : tuple of floats
        Coordinates (rad, m), velocities (rad/s, m/s), and directions at `q`.
    damping_B, damping_C : float
        Damping of the contacts (s/m), negative where there is none; see `joint_force`.
    drive : float
        Force of the cylinder (N).
    """
    B_x, B_y, B_t, C_x, C_y, C_t = joint_forces(w, q, v, d, damping_B, damping_C)
    c_1, s_1, c_2, s_2 = d
    load_1 = w.D_1 * abs(s_1) + w.G_1
    load_2 = w.D_2 * abs(s_2) + w.G_2
    moment_1 = w.l_1 * (c_1 * B_y - s_1 * B_x) + w.R_b * B_t - w.half_l_1 * s_1 * load_1
    # journals of one radius, the usual case, need the sum of their friction only
    friction_2 = w.R_j_B * (B_t + C_t) + (w.R_j_C - w.R_j_B) * C_t
    moment_2 = w.half_l_2 * (c_2 * (C_y - B_y) - s_2 * (C_x - B_x)) - friction_2
    return (
        moment_1 * w.inverse_J_A,
        (load_2 - B_x - C_x) * w.inverse_m_2,
        -(B_y + C_y) * w.inverse_m_2,
        moment_2 * w.inverse_J_2,
        (w.G_3 + drive + C_x) * w.inverse_m_3,
    )
