"""Contact of journal and bearing in a joint with clearance, Eqs. (5) to (7)."""

import math

from uqfold.mechanism.compiled import inlined, kernel


@kernel
def hertz_stiffness(
    R_b: float, R_j: float, E_b: float, nu_b: float, E_j: float, nu_j: float
) -> float:
    """Stiffness K of Eq. (6).

    Parameters
    ----------
    R_b, R_j : float
        Radii of bearing and journal (m).
    E_b, nu_b, E_j, nu_j : float
        Young's modulus (Pa) and Poisson's ratio of bearing and journal.

    Returns
    -------
    float
        Stiffness (N/m^1.5).
    """
    compliance = (1.0 - nu_b * nu_b) / E_b + (1.0 - nu_j * nu_j) / E_j
    return 4.0 / (3.0 * compliance) * math.sqrt(R_b * R_j / (R_b + R_j))


@inlined
def contact_forces(
    penetration: float,
    rate: float,
    sliding: float,
    stiffness: float,
    damping: float,
    C_f: float,
    v_0: float,
    ramp_slope: float,
) -> tuple[float, float]:
    """Normal and tangential contact force on the bearing, Eqs. (5) and (7).

    Parameters
    ----------
    penetration, rate : float
        Depth of penetration (m), at least 0, and its rate (m/s).
    sliding : float
        Tangential velocity of the journal relative to the bearing (m/s).
    stiffness : float
        K of Eq. (6) (N/m^1.5).
    damping : float
        3 (1 - C_e^2) / 4 over the penetration velocity at onset (s/m).
    C_f, v_0, ramp_slope : float
        Coefficient of friction (1), sliding velocity at which friction sets in (m/s), and growth
        of its correction c_d per sliding velocity beyond that (s/m).

    Returns
    -------
    tuple of two floats
        Force along the normal n (N), never negative, and along the tangent t (N). The journal
        drags the bearing along, so friction takes energy out: this is the sign opposite to the
        printed one, which would feed energy in.
    """
    normal = stiffness * penetration * math.sqrt(penetration) * (1.0 + damping * rate)
    normal = max(normal, 0.0)
    ramp = min(max((abs(sliding) - v_0) * ramp_slope, 0.0), 1.0)
    return normal, math.copysign(C_f * ramp * normal, sliding)
