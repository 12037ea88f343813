"""What the kernels know of one wing: plain numbers worked out once before the motion starts."""

import math
from typing import Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from uqfold.checks import array
from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.contact import hertz_stiffness, hysteresis_factor
from uqfold.mechanism.loads import drag_coefficient, gravity_force
from uqfold.mechanism.parameters import WingParameters, spread
from uqfold.mechanism.scales import are_resolved, scales_of


class SharedParameters(NamedTuple):
    """The fields of `WingParameters` that all samples of a batch share.

    Named choices come as what the kernels need of them: `hysteresis` is the factor of the contact
    law, `material` whether the tangential velocity is that of the material points.
    """

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
    E_b_B: float
    nu_b_B: float
    E_j_B: float
    nu_j_B: float
    E_b_C: float
    nu_b_C: float
    E_j_C: float
    nu_j_C: float
    C_f: float
    friction_v_0: float
    friction_v_1: float
    onset_velocity_floor: float
    hysteresis: float
    material: bool
    theta_1_initial: float
    x_lock: float
    t_max: float


class SampleParameters(NamedTuple):
    """The fields of `WingParameters` that may differ between the samples of a batch."""

    V_q: float
    delta: float
    k_d: float
    b_1: float
    b_2: float
    C_r_B: float
    C_r_C: float
    l_1: float
    l_2: float


class Samples(TypedDict, total=False):
    """Values per sample that a batch may be given: arrays of shape (n,), scalars, or None for none.

    In SI units: V_q (m/s), delta (rad), k_d (N), all others in m. `b` is one thickness for crank
    and rod, `C_r` one clearance for both joints.
    """

    V_q: ArrayLike | None
    delta: ArrayLike | None
    k_d: ArrayLike | None
    b: ArrayLike | None
    b_1: ArrayLike | None
    b_2: ArrayLike | None
    C_r: ArrayLike | None
    C_r_B: ArrayLike | None
    C_r_C: ArrayLike | None
    l_1: ArrayLike | None
    l_2: ArrayLike | None


class WingConstants(NamedTuple):
    """What the equations of motion need, in SI units; D are drags, G weights along X."""

    l_1: float
    half_l_1: float
    half_l_2: float
    c: float
    C_r_B: float
    C_r_C: float
    inverse_C_r_B: float
    inverse_C_r_C: float
    R_b: float
    R_j_B: float
    R_j_C: float
    inverse_J_A: float
    inverse_m_2: float
    inverse_J_2: float
    inverse_m_3: float
    K_B: float
    K_C: float
    hysteresis: float
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
    translated: dict[str, Any] = {
        "hysteresis": hysteresis_factor(parameters.contact_law, parameters.C_e),
        "material": parameters.tangential_velocity == "material",
    }
    for name in SharedParameters._fields:
        if name not in translated:
            translated[name] = getattr(parameters, name)
    return SharedParameters(**translated)


def sample_parameters(parameters: WingParameters) -> SampleParameters:
    """Return the part of a record that may differ between the samples of a batch."""
    return SampleParameters(*(getattr(parameters, name) for name in SampleParameters._fields))


def sample_table(parameters: WingParameters, given: Samples) -> NDArray[np.float64]:
    """Return the samples as rows, with the columns of `SampleParameters`.

    Parameters
    ----------
    parameters : WingParameters
        Values of what is not given.
    given : Samples
        Values per sample; a name that stands for several fields of `SampleParameters` (see
        `spread`) gives all of them.

    Returns
    -------
    ndarray, shape (n, len(SampleParameters))
        One row per sample.

    Raises
    ------
    ValueError
        If the shapes do not fit, or a field is given twice.
    TypeError
        If a name is none of `Samples`, or a value is no number.
    """
    unknown = given.keys() - Samples.__annotations__.keys()
    if unknown:
        raise TypeError(
            f"{', '.join(sorted(unknown))}: no parameter that may differ between samples; those "
            f"are {', '.join(Samples.__annotations__)}"
        )
    checked = {
        name: array(name, values, finite=False)
        for name, values in given.items()
        if values is not None
    }
    for name, values in checked.items():
        if values.ndim > 1:
            raise ValueError(
                f"{name} has shape {values.shape}: give a scalar or an array of shape (n,)"
            )
    values_of = spread(checked)
    columns = {
        name: np.atleast_1d(values_of.get(name, np.asarray(getattr(parameters, name))))
        for name in SampleParameters._fields
    }
    lengths = {name: len(column) for name, column in columns.items() if len(column) != 1}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the lengths differ, {lengths}: give scalars or arrays of one length")
    return np.column_stack(np.broadcast_arrays(*columns.values()))


@inlined
def as_sample(row: NDArray[np.float64]) -> SampleParameters:
    """Row of a table of samples by name."""
    return SampleParameters(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8])


_scales_of = kernel(scales_of)
_are_resolved = kernel(are_resolved)


@kernel
def _stiffnesses(f: SharedParameters, p: SampleParameters) -> tuple[float, float]:
    """Stiffness (6) of the joints B and C (N/m^1.5)."""
    return (
        hertz_stiffness(f.R_b, f.R_b - p.C_r_B, f.E_b_B, f.nu_b_B, f.E_j_B, f.nu_j_B),
        hertz_stiffness(f.R_b, f.R_b - p.C_r_C, f.E_b_C, f.nu_b_C, f.E_j_C, f.nu_j_C),
    )


@kernel
def wing_constants(f: SharedParameters, p: SampleParameters) -> WingConstants:
    """Masses (19), joint stiffness (6), drag (14) and weights (16) of one wing."""
    m_1 = f.rho_1 * p.l_1 * f.w_1 * p.b_1
    m_2 = f.rho_2 * p.l_2 * f.w_2 * p.b_2
    m_3 = f.rho_3 * f.V_3
    J_1 = m_1 * (p.l_1 * p.l_1 + f.w_1 * f.w_1) / 12.0
    J_2 = m_2 * (p.l_2 * p.l_2 + f.w_2 * f.w_2) / 12.0
    K_B, K_C = _stiffnesses(f, p)
    return WingConstants(
        p.l_1,
        0.5 * p.l_1,
        0.5 * p.l_2,
        f.c,
        p.C_r_B,
        p.C_r_C,
        1.0 / p.C_r_B,
        1.0 / p.C_r_C,
        f.R_b,
        f.R_b - p.C_r_B,
        f.R_b - p.C_r_C,
        1.0 / (J_1 + m_1 * (0.5 * p.l_1) ** 2),
        1.0 / m_2,
        1.0 / J_2,
        1.0 / m_3,
        K_B,
        K_C,
        f.hysteresis,
        f.onset_velocity_floor,
        f.C_f,
        f.friction_v_0,
        1.0 / (f.friction_v_1 - f.friction_v_0),
        f.material,
        drag_coefficient(f.rho_a, f.C_0, p.b_1, p.l_1, p.V_q),
        drag_coefficient(f.rho_a, f.C_0, p.b_2, p.l_2, p.V_q),
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
    """Whether such a wing can be built, starts ahead of its lock, and has scales of the model."""
    for value in p:
        if not math.isfinite(value):
            return False
    if p.V_q < 0.0 or max(p.C_r_B, p.C_r_C) >= f.R_b:
        return False
    if min(p.b_1, p.b_2, p.C_r_B, p.C_r_C, p.l_1, p.l_2) <= 0.0:
        return False
    rise = p.l_1 * math.sin(f.theta_1_initial) + f.c
    if abs(rise) >= p.l_2:
        return False
    run = math.sqrt(p.l_2 * p.l_2 - rise * rise)
    if not p.l_1 * math.cos(f.theta_1_initial) - run < f.x_lock:
        return False
    K_B, K_C = _stiffnesses(f, p)
    return bool(_are_resolved(f, p, _scales_of(f, p, K_B, K_C)))
