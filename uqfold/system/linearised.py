"""System failure from one linearised unit (FORM): the one-factor normal integral.

FORM replaces a unit's limit state by a plane in standard-normal space, so that the unit fails if
U = alpha . u > beta. Split alpha into the shared and the individual part: with
rho = |alpha_shared|^2, U = sqrt(rho) Z + sqrt(1 - rho) E with Z common to all units and missions
of a system and E drawn anew for each. Given Z = z a unit fails with probability
Phi((sqrt(rho) z - beta) / sqrt(1 - rho)), and a one-dimensional integral over z remains
(Dunnett and Sobel, Biometrika 42 (1955) 258; Hohenbichler and Rackwitz, J. Eng. Mech. 109 (1983)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from uqfold.moments.panels import integrate
from uqfold.problems.criterion import Missions
from uqfold.system.missions import over_missions
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

_FARTHEST = 38.5  # the normal density underflows beyond


def linearised_failures(
    beta: float, rho: float, units: SystemUnits | int, missions: Sequence[Missions]
) -> tuple[FloatArray, FloatArray]:
    """Failure probability and reliability of a linearised system.

    Parameters
    ----------
    beta
        Reliability index of one unit, of either sign; +-inf allowed.
    rho
        Squared length of the shared part of the design direction, in [0, 1]: the correlation of
        two units' linearised margins.
    units
        The units and their structure, or the number n >= 1 of units in series.
    missions
        Fixed or binomial numbers of missions, one for each entry of the result.

    Returns
    -------
    pf, reliability : arrays (len(missions),)
        Each computed directly.

    Raises
    ------
    ValueError
        If beta is NaN, rho lies outside [0, 1] or units < 1.
    """
    if math.isnan(beta):
        raise ValueError("beta is NaN: FORM gave no design point")
    if not 0.0 <= rho <= 1.0:
        raise ValueError(f"rho = {rho}: the shared part of a unit vector has a square in [0, 1]")
    units = SystemUnits.of(units)
    if math.isinf(beta) or rho == 0.0:
        return _columns(_over_units(np.array([-beta]), units, missions))
    if rho == 1.0:
        # Everything is shared: the whole system fails with one unit, if a mission is flown at all.
        fails, works = _normal_tails(beta)
        flown, not_flown = over_missions(np.ones(1), np.zeros(1), 1)
        pairs = [over_missions(flown, not_flown, mission) for mission in missions]
        pf = np.array([float(p[0]) * fails for p, _ in pairs])
        return pf, np.array([works + float(q[0]) * fails for _, q in pairs])

    scale = math.sqrt(1.0 - rho)

    def integrand(z: FloatArray) -> FloatArray:
        failure, success = _over_units((math.sqrt(rho) * z - beta) / scale, units, missions)
        density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
        return np.concatenate([failure, success]) * density

    total = np.minimum(integrate(integrand, _edges(beta, rho), np.zeros(2 * len(missions))), 1.0)
    return total[: len(missions)], total[len(missions) :]


def linearised_failure(
    beta: float, rho: float, units: SystemUnits | int, missions: Missions = 1
) -> tuple[float, float]:
    """(pf, reliability) for one number of missions; see linearised_failures."""
    pf, reliability = linearised_failures(beta, rho, units, [missions])
    return float(pf[0]), float(reliability[0])


def _edges(beta: float, rho: float) -> FloatArray:
    """Where to divide an integral over z."""
    # around z = beta / sqrt(rho) a unit changes from working to failing, over this width
    centre, width = beta / math.sqrt(rho), math.sqrt((1.0 - rho) / rho)
    edges = np.concatenate(
        [
            [-_FARTHEST, -30.0, -22.0, -16.0, 16.0, 22.0, 30.0, _FARTHEST],
            np.arange(-12.0, 12.5, 1.0),
            centre + width * np.array([-16, -10, -7, -5, -4, -3, -2, -1, 0, 1, 2, 3, 5, 8, 16]),
        ]
    )
    return np.unique(edges[np.abs(edges) <= _FARTHEST])


def _normal_tails(beta: float) -> tuple[float, float]:
    """Phi(-beta) and Phi(beta)."""
    from scipy.special import ndtr

    return float(ndtr(-beta)), float(ndtr(beta))


def _over_units(
    x: FloatArray, units: SystemUnits, missions: Sequence[Missions]
) -> tuple[FloatArray, FloatArray]:
    """Failure and success (len(missions), N) given that each unit fails with Phi(x), x (N,)."""
    from scipy.special import log_ndtr, ndtr

    if units.diagram is not None:
        failure, success = units.mission(ndtr(x)[None], ndtr(-x)[None])
    else:
        log_works = units.count * log_ndtr(-x)
        failure, success = -np.expm1(log_works), np.exp(log_works)
    pairs = [over_missions(failure, success, mission) for mission in missions]
    return np.stack([pair[0] for pair in pairs]), np.stack([pair[1] for pair in pairs])


def _columns(pair: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    return pair[0][:, 0], pair[1][:, 0]
