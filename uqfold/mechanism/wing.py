"""What the kernels know of one wing: plain numbers worked out once before the motion starts."""

import math
from typing import Any, NamedTuple, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from uqfold.checks import array
from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.contact import hertz_stiffness, hysteresis_factor
from uqfold.mechanism.loads import drag_coefficient, gravity_force
from uqfold.mechanism.parameter_list import PARAMETERS
from uqfold.mechanism.parameters import WingParameters, spread
from uqfold.mechanism.scales import are_resolved, scales_of


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
    """What the equations of motion need, in SI units; D are drags, G weights along X.

    All are floats, so that lanes hold them in rows of numbers; `material` is 1 where the tangential
    velocity is that of the material points, else 0.
    """

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
    material: float
    D_1: float
    D_2: float
    G_1: float
    G_2: float
    G_3: float
    k_d: float
    x_lock: float
    t_max: float


Wing: TypeAlias = Any
"""The numbers of one wing, which compiled code reads by field name: one of `Wings.table`."""

_NUMBERS = tuple(name for name, one in PARAMETERS.items() if one.bounds is not None)

WING = np.dtype([(name, np.float64) for name in (*_NUMBERS, "hysteresis", "material", "finite")])
"""Fields of such a record: all parameters that are numbers, and what the words stand for.

`hysteresis` is the factor of the contact law; `material` is 1 where the tangential velocity is that
of the material points, and `finite` where all values of the sample are, else 0.
"""


class Wings:
    """A batch of wings, one per sample; len() says how many.

    Parameters
    ----------
    parameters : WingParameters
        Values of what is not given per sample.
    given : Samples, optional
        Values per sample; a name that stands for several parameters (see `spread`) gives all of
        them.

    Raises
    ------
    ValueError
        If the shapes do not fit, or a parameter is given twice.
    TypeError
        If a name is not one of `Samples`, or a value is not a number.
    """

    def __init__(self, parameters: WingParameters, given: Samples | None = None) -> None:
        given = given or {}
        unknown = given.keys() - Samples.__annotations__.keys()
        if unknown:
            raise TypeError(
                f"{', '.join(sorted(unknown))}: no parameter that may differ between samples; "
                f"those are {', '.join(Samples.__annotations__)}"
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
        self._columns = {name: np.atleast_1d(values) for name, values in spread(checked).items()}
        lengths = {name: len(column) for name, column in self._columns.items() if len(column) != 1}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"the lengths differ, {lengths}: give scalars or arrays of one length")
        self._length = next(iter(lengths.values()), 1)
        self._all_alike = np.zeros(1, WING)
        for name in _NUMBERS:
            self._all_alike[name] = getattr(parameters, name)
        self._all_alike["hysteresis"] = hysteresis_factor(parameters.contact_law, parameters.C_e)
        self._all_alike["finite"] = 1.0
        self._all_alike["material"] = parameters.tangential_velocity == "material"

    def __len__(self) -> int:
        return self._length

    def table(self, start: int = 0, stop: int | None = None) -> np.recarray[Any, Any]:
        """Return the records (m,), of type `WING`, of the samples from `start` to before `stop`."""
        rows = range(*slice(start, stop).indices(self._length))
        table = np.repeat(self._all_alike, len(rows))
        for name, column in self._columns.items():
            values = column if len(column) == 1 else column[start:stop]
            table[name] = values
            table["finite"] *= np.isfinite(values)
        return table.view(np.recarray)


_scales_of = kernel(scales_of)
_are_resolved = kernel(are_resolved)


@kernel
def _stiffnesses(p: Wing) -> tuple[float, float]:
    """Return the stiffness (6) of the joints B and C (N/m^1.5)."""
    return (
        hertz_stiffness(p.R_b, p.R_b - p.C_r_B, p.E_b_B, p.nu_b_B, p.E_j_B, p.nu_j_B),
        hertz_stiffness(p.R_b, p.R_b - p.C_r_C, p.E_b_C, p.nu_b_C, p.E_j_C, p.nu_j_C),
    )


@kernel
def wing_constants(p: Wing) -> WingConstants:
    """Return masses (19), joint stiffness (6), drag (14) and weights (16) of one wing."""
    m_1 = p.rho_1 * p.l_1 * p.w_1 * p.b_1
    m_2 = p.rho_2 * p.l_2 * p.w_2 * p.b_2
    m_3 = p.rho_3 * p.V_3
    J_1 = m_1 * (p.l_1 * p.l_1 + p.w_1 * p.w_1) / 12.0
    J_2 = m_2 * (p.l_2 * p.l_2 + p.w_2 * p.w_2) / 12.0
    K_B, K_C = _stiffnesses(p)
    return WingConstants(
        l_1=p.l_1,
        half_l_1=0.5 * p.l_1,
        half_l_2=0.5 * p.l_2,
        c=p.c,
        C_r_B=p.C_r_B,
        C_r_C=p.C_r_C,
        inverse_C_r_B=1.0 / p.C_r_B,
        inverse_C_r_C=1.0 / p.C_r_C,
        R_b=p.R_b,
        R_j_B=p.R_b - p.C_r_B,
        R_j_C=p.R_b - p.C_r_C,
        inverse_J_A=1.0 / (J_1 + m_1 * (0.5 * p.l_1) ** 2),
        inverse_m_2=1.0 / m_2,
        inverse_J_2=1.0 / J_2,
        inverse_m_3=1.0 / m_3,
        K_B=K_B,
        K_C=K_C,
        hysteresis=p.hysteresis,
        onset_velocity_floor=p.onset_velocity_floor,
        C_f=p.C_f,
        v_0=p.friction_v_0,
        ramp_slope=1.0 / (p.friction_v_1 - p.friction_v_0),
        material=p.material,
        D_1=drag_coefficient(p.rho_a, p.C_0, p.b_1, p.l_1, p.V_q),
        D_2=drag_coefficient(p.rho_a, p.C_0, p.b_2, p.l_2, p.V_q),
        G_1=gravity_force(m_1, p.g, p.delta),
        G_2=gravity_force(m_2, p.g, p.delta),
        G_3=gravity_force(m_3, p.g, p.delta),
        k_d=p.k_d,
        x_lock=p.x_lock,
        t_max=p.t_max,
    )


@kernel
def initial_pose(p: Wing) -> tuple[float, float, float, float, float]:
    """Return the coordinates at rest: journals centred, slider on the side nearer to A."""
    x_B = p.l_1 * math.cos(p.theta_1_initial)
    y_B = p.l_1 * math.sin(p.theta_1_initial)
    rise = y_B + p.c
    run = math.sqrt(p.l_2 * p.l_2 - rise * rise)
    theta_2 = math.atan2(rise, run)
    return p.theta_1_initial, x_B - 0.5 * run, y_B - 0.5 * rise, theta_2, x_B - run


@kernel
def is_possible(p: Wing) -> bool:
    """Return whether it can be built, starts ahead of its lock, and has scales of the model."""
    if p.finite == 0.0 or p.V_q < 0.0 or max(p.C_r_B, p.C_r_C) >= p.R_b:
        return False
    if min(p.b_1, p.b_2, p.C_r_B, p.C_r_C, p.l_1, p.l_2) <= 0.0:
        return False
    rise = p.l_1 * math.sin(p.theta_1_initial) + p.c
    if abs(rise) >= p.l_2:
        return False
    run = math.sqrt(p.l_2 * p.l_2 - rise * rise)
    if not p.l_1 * math.cos(p.theta_1_initial) - run < p.x_lock:
        return False
    K_B, K_C = _stiffnesses(p)
    return bool(_are_resolved(p, _scales_of(p, K_B, K_C)))
