"""The paper's own equations of motion: nine coordinates, Lagrange multipliers, Eqs. (1) to (20).

Coordinates q = (x_1, y_1, theta_1, x_2, y_2, theta_2, x_3, y_3, theta_3) are held together by the
constraints (10), which Baumgarte's terms in (20) keep from drifting apart. Nothing of the reduced
form in `uqfold.mechanism.motion` is used here: the two forms check each other.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.parameters import WingParameters

FloatArray = NDArray[np.float64]

_HYSTERESIS: dict[str, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda e: 3 * (1 - e**2) / 4,
    "hunt-crossley": lambda e: 3 * (1 - e) / 2,
    "flores-2011": lambda e: 8 * (1 - e) / (5 * e),
    "gonthier": lambda e: (1 - e**2) / e,
}

# theta_3 is constrained to 0, so any inertia of the slider serves (kg m^2)
_J_3 = 1.0


class Joint(NamedTuple):
    """A revolute joint with clearance: body i carries the bearing, body j the journal.

    Bodies count from 0; s is the place of the centre along the body's own x axis (m).
    """

    i: int
    s_i: float
    j: int
    s_j: float
    R_i: float
    R_j: float
    K: float
    hysteresis: float


class Multibody(NamedTuple):
    """What Eqs. (1) to (19) need, in SI units."""

    mass: FloatArray
    joint_B: Joint
    joint_C: Joint
    l_1: float
    c: float
    drag: FloatArray
    weight: FloatArray
    k_d: float
    c_f: float
    v_0: float
    v_1: float
    onset_floor: float
    material: bool
    x_lock: float


def multibody(p: WingParameters) -> Multibody:
    """Masses (19), joints (6), loads (14)-(15)."""
    lengths, widths = np.array([p.l_1, p.l_2]), np.array([p.w_1, p.w_2])
    thicknesses = np.array([p.b_1, p.b_2])
    m = np.append(np.array([p.rho_1, p.rho_2]) * lengths * widths * thicknesses, p.rho_3 * p.V_3)
    J = np.append(m[:2] * (lengths**2 + widths**2) / 12, _J_3)
    hysteresis = _HYSTERESIS[p.contact_law](p.C_e)

    def joint(
        i: int,
        s_i: float,
        s_j: float,
        C_r: float,
        bearing: tuple[float, float],
        journal: tuple[float, float],
    ) -> Joint:
        R_j = p.R_b - C_r
        h_i, h_j = ((1 - nu**2) / E for E, nu in (bearing, journal))
        K = 4 / (3 * (h_i + h_j)) * (p.R_b * R_j / (p.R_b + R_j)) ** 0.5
        return Joint(i, s_i, 1, s_j, p.R_b, R_j, K, hysteresis)

    return Multibody(
        mass=np.column_stack([m, m, J]).ravel(),
        joint_B=joint(0, p.l_1 / 2, p.l_2 / 2, p.C_r_B, (p.E_b_B, p.nu_b_B), (p.E_j_B, p.nu_j_B)),
        joint_C=joint(2, 0.0, -p.l_2 / 2, p.C_r_C, (p.E_b_C, p.nu_b_C), (p.E_j_C, p.nu_j_C)),
        l_1=p.l_1,
        c=p.c,
        drag=p.rho_a / 2 * p.C_0 * thicknesses * lengths * p.V_q**2,
        weight=m * p.g * math.sin(p.delta),
        k_d=p.k_d,
        c_f=p.C_f,
        v_0=p.friction_v_0,
        v_1=p.friction_v_1,
        onset_floor=p.onset_velocity_floor,
        material=p.tangential_velocity == "material",
        x_lock=p.x_lock,
    )


def initial_coordinates(p: WingParameters) -> FloatArray:
    """Coordinates before deployment: journals centred, slider on the side nearer to A."""
    B = p.l_1 * np.array([math.cos(p.theta_1_initial), math.sin(p.theta_1_initial)])
    theta_2 = math.asin((B[1] + p.c) / p.l_2)
    C = B - p.l_2 * np.array([math.cos(theta_2), math.sin(theta_2)])
    return np.array([*(B / 2), p.theta_1_initial, *((B + C) / 2), theta_2, C[0], -p.c, 0.0])


@kernel
def _eccentricity(
    joint: Joint, q: FloatArray, v: FloatArray
) -> tuple[float, float, float, float, float, float, float, float]:
    """Eccentricity (1), its rate, and the arms of both centres about their centroids."""
    i, j = 3 * joint.i, 3 * joint.j
    i_x, i_y = joint.s_i * math.cos(q[i + 2]), joint.s_i * math.sin(q[i + 2])
    j_x, j_y = joint.s_j * math.cos(q[j + 2]), joint.s_j * math.sin(q[j + 2])
    return (
        q[j] + j_x - q[i] - i_x,
        q[j + 1] + j_y - q[i + 1] - i_y,
        v[j] - j_y * v[j + 2] - v[i] + i_y * v[i + 2],
        v[j + 1] + j_x * v[j + 2] - v[i + 1] - i_x * v[i + 2],
        i_x,
        i_y,
        j_x,
        j_y,
    )


@kernel
def penetration(joint: Joint, q: FloatArray, v: FloatArray) -> tuple[float, float]:
    """Penetration (2), negative before contact, and its rate."""
    e_x, e_y, r_x, r_y, _, _, _, _ = _eccentricity(joint, q, v)
    distance = math.hypot(e_x, e_y)
    rate = (e_x * r_x + e_y * r_y) / distance if distance > 0.0 else 0.0
    return distance - (joint.R_i - joint.R_j), rate


@kernel
def _add_contact(
    b: Multibody, joint: Joint, onset: float, q: FloatArray, v: FloatArray, Q: FloatArray
) -> None:
    """Add the contact forces (5)-(8) of a joint and their moments (9) to `Q`."""
    e_x, e_y, r_x, r_y, i_x, i_y, j_x, j_y = _eccentricity(joint, q, v)
    distance = math.hypot(e_x, e_y)
    depth = distance - (joint.R_i - joint.R_j)
    if depth <= 0.0:
        return
    n_x, n_y = e_x / distance, e_y / distance
    t_x, t_y = -n_y, n_x
    v_n = r_x * n_x + r_y * n_y
    v_t = r_x * t_x + r_y * t_y
    if b.material:
        v_t += joint.R_j * v[3 * joint.j + 2] - joint.R_i * v[3 * joint.i + 2]
    else:
        turning = v_t / distance  # dn/dt = turning t
        v_t += (joint.R_j - joint.R_i) * turning
    F_N = joint.K * depth**1.5 * (1.0 + joint.hysteresis * v_n / onset)
    if F_N <= 0.0:
        return
    c_d = min(1.0, max(0.0, (abs(v_t) - b.v_0) / (b.v_1 - b.v_0)))
    # the journal drags the bearing along: opposite to the sign printed in (7), which adds energy
    F_T = math.copysign(b.c_f * c_d * F_N, v_t)
    F_x = F_N * n_x + F_T * t_x
    F_y = F_N * n_y + F_T * t_y
    i, j = 3 * joint.i, 3 * joint.j
    Q[i] += F_x
    Q[i + 1] += F_y
    Q[i + 2] += (i_x + joint.R_i * n_x) * F_y - (i_y + joint.R_i * n_y) * F_x
    Q[j] -= F_x
    Q[j + 1] -= F_y
    Q[j + 2] -= (j_x + joint.R_j * n_x) * F_y - (j_y + joint.R_j * n_y) * F_x


@kernel
def constraints(b: Multibody, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Constraints (10) and their Jacobian."""
    half = 0.5 * b.l_1
    cosine, sine = math.cos(q[2]), math.sin(q[2])
    phi = np.array([q[0] - half * cosine, q[1] - half * sine, q[7] + b.c, q[8]])
    jacobian = np.zeros((4, 9))
    jacobian[0, 0] = 1.0
    jacobian[0, 2] = half * sine
    jacobian[1, 1] = 1.0
    jacobian[1, 2] = -half * cosine
    jacobian[2, 7] = 1.0
    jacobian[3, 8] = 1.0
    return phi, jacobian


@kernel
def _solve(matrix: FloatArray, x: FloatArray) -> None:
    """Solve a linear system in place by elimination with partial pivoting; `x` holds both sides."""
    n = x.shape[0]
    for k in range(n):
        pivot = k
        for row in range(k + 1, n):
            if abs(matrix[row, k]) > abs(matrix[pivot, k]):
                pivot = row
        if pivot != k:
            for column in range(n):
                matrix[k, column], matrix[pivot, column] = matrix[pivot, column], matrix[k, column]
            x[k], x[pivot] = x[pivot], x[k]
        for row in range(k + 1, n):
            factor = matrix[row, k] / matrix[k, k]
            if factor != 0.0:
                for column in range(k + 1, n):
                    matrix[row, column] -= factor * matrix[k, column]
                x[row] -= factor * x[k]
    for k in range(n - 1, -1, -1):
        for column in range(k + 1, n):
            x[k] -= matrix[k, column] * x[column]
        x[k] /= matrix[k, k]


@kernel
def rates(
    b: Multibody, alpha: float, beta: float, t: float, y: FloatArray, onset: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Rates of coordinates and velocities `y` (18,) by Eq. (20), and the multipliers (4,).

    `onset` holds the penetration velocity at which each contact began, 0 where there is none.
    """
    q, v = y[:9], y[9:]
    Q = np.zeros(9)
    Q[0] = b.drag[0] * abs(math.sin(q[2])) + b.weight[0]
    Q[3] = b.drag[1] * abs(math.sin(q[5])) + b.weight[1]
    drive = b.k_d * max(0.0, min(100.0 * t, 1.0, 62.0 - 100.0 * t))
    Q[6] = b.weight[2] + drive
    if onset[0] > 0.0:
        _add_contact(b, b.joint_B, onset[0], q, v, Q)
    if onset[1] > 0.0:
        _add_contact(b, b.joint_C, onset[1], q, v, Q)

    phi, jacobian = constraints(b, q)
    gamma = np.zeros(4)
    gamma[0] = -0.5 * b.l_1 * math.cos(q[2]) * v[2] * v[2]
    gamma[1] = -0.5 * b.l_1 * math.sin(q[2]) * v[2] * v[2]
    matrix = np.zeros((13, 13))
    x = np.empty(13)
    for k in range(9):
        matrix[k, k] = b.mass[k]
        x[k] = Q[k]
    for k in range(4):
        phi_rate = 0.0
        for column in range(9):
            matrix[9 + k, column] = jacobian[k, column]
            matrix[column, 9 + k] = jacobian[k, column]
            phi_rate += jacobian[k, column] * v[column]
        x[9 + k] = gamma[k] - 2.0 * alpha * phi_rate - beta * beta * phi[k]
    _solve(matrix, x)
    result = np.empty(18)
    for k in range(9):
        result[k] = v[k]
        result[9 + k] = x[k]
    return result, x[9:]
