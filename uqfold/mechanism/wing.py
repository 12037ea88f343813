"""What the kernels know of one wing: plain numbers worked out once before the motion starts."""

import math
from typing import NamedTuple

from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.contact import hertz_stiffness
from uqfold.mechanism.loads import drag_coefficient, gravity_force
from uqfold.mechanism.parameters import WingParameters


class SharedParameters(NamedTuple):
    """The fields of `WingParameters` that all samples of a batch share."""

    w_1: float
    rho_1: float
    w_2: float
    rho_2: float
    V_3: float
    rho_3: float
    c: float
    C_0: float
    rho_a: float
    g: float
    R_b: float
    C_e: float
    E_1: float
    nu_1: float
    E_2: float
    nu_2: float
    C_f: float
    friction_v_0: float
    friction_v_1: float
    onset_velocity_floor: float
    material: bool
    theta_1_initial: float
    x_lock: float
    t_max: float


class SampleParameters(NamedTuple):
    """The fields of `WingParameters` that may differ between the samples of a batch."""

    V_q: float
    delta: float
    k_d: float
    b: float
    C_r: float
    l_1: float
    l_2: float


class WingConstants(NamedTuple):
    """What the equations of motion need, in SI units; D are drags, G weights along X."""

    l_1: float
    half_l_1: float
    half_l_2: float
    c: float
    C_r: float
    inverse_C_r: float
    R_b: float
    R_j: float
    inverse_J_A: float
    inverse_m_2: float
    inverse_J_2: float
    inverse_m_3: float
    K_B: float
    K_C: float
    damping: float
    onset_velocity_floor: float
    C_f: float
    v_0: float
    ramp_slope: float
    material: bool
    D_1: float
    D_2: float
    G_1: float
    G_2: float
    G_3: float
    k_d: float
    x_lock: float
    t_max: float


def shared_parameters(parameters: WingParameters) -> SharedParameters:
    """Return the part of a record that the samples of a batch share."""
    numbers = {name: getattr(parameters, name) for name in SharedParameters._fields[:20]}
    return SharedParameters(
        **numbers,
        material=parameters.tangential_velocity == "material",
        theta_1_initial=parameters.theta_1_initial,
        x_lock=parameters.x_lock,
        t_max=parameters.t_max,
    )


@kernel
def wing_constants(f: SharedParameters, p: SampleParameters) -> WingConstants:
    """Masses (19), joint stiffness (6), drag (14) and weights (16) of one wing."""
    m_1 = f.rho_1 * p.l_1 * f.w_1 * p.b
    m_2 = f.rho_2 * p.l_2 * f.w_2 * p.b
    m_3 = f.rho_3 * f.V_3
    J_1 = m_1 * (p.l_1 * p.l_1 + f.w_1 * f.w_1) / 12.0
    J_2 = m_2 * (p.l_2 * p.l_2 + f.w_2 * f.w_2) / 12.0
    R_j = f.R_b - p.C_r
    return WingConstants(
        p.l_1,
        0.5 * p.l_1,
        0.5 * p.l_2,
        f.c,
        p.C_r,
        1.0 / p.C_r,
        f.R_b,
        R_j,
        1.0 / (J_1 + m_1 * (0.5 * p.l_1) ** 2),
        1.0 / m_2,
        1.0 / J_2,
        1.0 / m_3,
        # B: crank on rod, both aluminium; C: steel slider on aluminium rod
        hertz_stiffness(f.R_b, R_j, f.E_1, f.nu_1, f.E_1, f.nu_1),
        hertz_stiffness(f.R_b, R_j, f.E_2, f.nu_2, f.E_1, f.nu_1),
        0.75 * (1.0 - f.C_e * f.C_e),
        f.onset_velocity_floor,
        f.C_f,
        f.friction_v_0,
        1.0 / (f.friction_v_1 - f.friction_v_0),
        f.material,
        drag_coefficient(f.rho_a, f.C_0, p.b, p.l_1, p.V_q),
        drag_coefficient(f.rho_a, f.C_0, p.b, p.l_2, p.V_q),
        gravity_force(m_1, f.g, p.delta),
        gravity_force(m_2, f.g, p.delta),
        gravity_force(m_3, f.g, p.delta),
        p.k_d,
        f.x_lock,
        f.t_max,
    )


@kernel
def initial_pose(
    f: SharedParameters, p: SampleParameters
) -> tuple[float, float, float, float, float]:
    """Coordinates before deployment: journals centred, slider on the side nearer to A."""
    x_B = p.l_1 * math.cos(f.theta_1_initial)
    y_B = p.l_1 * math.sin(f.theta_1_initial)
    rise = y_B + f.c
    run = math.sqrt(p.l_2 * p.l_2 - rise * rise)
    theta_2 = math.atan2(rise, run)
    return f.theta_1_initial, x_B - 0.5 * run, y_B - 0.5 * rise, theta_2, x_B - run


@kernel
def is_possible(f: SharedParameters, p: SampleParameters) -> bool:
    """Whether a wing with these parameters can be built and starts ahead of its lock."""
    for value in p:
        if not math.isfinite(value):
            return False
    if p.V_q < 0.0 or p.C_r >= f.R_b or min(p.b, p.C_r, p.l_1, p.l_2) <= 0.0:
        return False
    rise = p.l_1 * math.sin(f.theta_1_initial) + f.c
    if abs(rise) >= p.l_2:
        return False
    run = math.sqrt(p.l_2 * p.l_2 - rise * rise)
    return p.l_1 * math.cos(f.theta_1_initial) - run < f.x_lock
