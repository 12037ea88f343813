"""Scales of force and time of one wing, and how far apart they may lie.

The model takes penetrations for small against the bearing, and its time steps resolve lengths and
times to a share of the largest ones that double precision leaves. Both bound what a wing can be.
The functions here are plain ones, which kernels compile and the parameter record calls as they are.
"""

import math
from typing import Any, NamedTuple

LONGEST_ARMS = 100.0
"""Largest sum of the arms' lengths (m): beyond it, the 1e-13 m to which events are located could
not be told from rounding."""

LEAST_CLEARANCE = 1e-8
"""Smallest clearance over the sum of the arms' lengths: eccentricities are differences of numbers
of that size, rounded to 1e-16 of it, and penetrations are far smaller than clearances."""

LONGEST_TIME = 100.0
"""Largest simulated time (s): its rounding stays below the shortest time step, 1e-13 s."""

MOST_VIBRATIONS = 1e8
"""Largest product of simulated time and angular frequency of contact (1): a period is then still
resolved in the simulated time."""


class Scales(NamedTuple):
    """Bounds on what acts in the joints of one wing.

    Attributes
    ----------
    load : float
        Drive, drag and weights all together (N).
    capacity : float
        Force of the softer contact at a penetration of the bearing's radius (N).
    frequency : float
        Angular frequency (1/s) at which the lightest body vibrates in the harder contact when
        pressed in by the bearing's radius.
    """

    load: float
    capacity: float
    frequency: float


def hertz_stiffness(
    R_b: float, R_j: float, E_b: float, nu_b: float, E_j: float, nu_j: float
) -> float:
    """Return the stiffness K of Eq. (6).

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


def scales_of(p: Any, K_B: float, K_C: float) -> Scales:
    """Return the scales of a wing.

    Parameters
    ----------
    p : WingParameters, or a record of `uqfold.mechanism.wing`
        The wing.
    K_B, K_C : float
        Stiffness of both contacts (N/m^1.5), Eq. (6).
    """
    m_1 = p.rho_1 * p.l_1 * p.w_1 * p.b_1
    m_2 = p.rho_2 * p.l_2 * p.w_2 * p.b_2
    m_3 = p.rho_3 * p.V_3
    drag = 0.5 * p.rho_a * p.C_0 * (p.b_1 * p.l_1 + p.b_2 * p.l_2) * p.V_q * p.V_q
    load = abs(p.k_d) + drag + (m_1 + m_2 + m_3) * p.g
    # a third of the mass of a thin rod moves with its end, a quarter when both ends are free
    lightest = min(m_1 / 3.0, m_2 / 4.0, m_3)
    root = math.sqrt(p.R_b)
    return Scales(
        load,
        min(K_B, K_C) * p.R_b * root,
        math.sqrt(1.5 * max(K_B, K_C) * root / lightest),
    )


def are_resolved(p: Any, scale: Scales) -> bool:
    """Return whether a wing with these scales is one of the model, and its motion resolved.

    `p` is that of `scales_of`, and `scale` its result.
    """
    arms = p.l_1 + p.l_2
    return (
        arms <= LONGEST_ARMS
        and min(p.C_r_B, p.C_r_C) >= LEAST_CLEARANCE * arms
        and p.t_max <= LONGEST_TIME
        and scale.load <= scale.capacity
        and scale.frequency * p.t_max <= MOST_VIBRATIONS
    )
