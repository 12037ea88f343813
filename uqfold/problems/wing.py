"""Example 3: the folding-wing system (section 4.3, Table 6).

Four wings fold out side by side. Each must reach its lock before the threshold T, and under a
synchronization threshold tau the first and the last may not lie further apart than that. Flight
speed and pitch angle are one draw for the vehicle and stay the same over its missions; drive
force, wing thickness and joint clearance are drawn anew for every wing and every mission, since
the mechanisms are replaced after each flight.

This module is the one bridge between the mechanics (SI units) and the random inputs (the units of
Table 6). The references come from simulation of the same mechanism.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from uqfold.inputs import normal
from uqfold.mechanism import WingParameters
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.problems.reference import load_references
from uqfold.typing import FloatArray

INPUT_UNITS = ("m/s", "deg", "N", "mm", "mm")

# Table 6: name -> (mean, standard deviation), in INPUT_UNITS
TABLE_6_SHARED = {"V_q": (140.0, 10.0), "delta": (0.0, 5.0)}
TABLE_6_INDIVIDUAL = {"k_d": (550.0, 10.0), "b": (7.0, 0.25), "C_r": (1.5, 0.05)}

DEFAULT_THRESHOLDS = (0.545, 0.550, 0.555, 0.560, 0.565, 0.570)
DEFAULT_TAU = (None, 0.04)


@dataclass(frozen=True)
class DeploymentTime:
    """Deployment time of one wing, in the units of Table 6.

    Attributes
    ----------
    parameters
        The mechanism; its values of V_q, delta, k_d, b and C_r do not matter.
    """

    parameters: WingParameters

    def __call__(self, x: FloatArray) -> FloatArray:
        """Give the deployment times (n,) in s of X (n, 5): V_q, delta, k_d, b, C_r."""
        from uqfold.mechanism import deployment_times

        return deployment_times(self.parameters, **_in_si_units(x))


@dataclass(frozen=True)
class IdealDeploymentTime:
    """Deployment time of one wing with ideal joints: the low-fidelity partner, in the same units.

    Attributes
    ----------
    parameters
        The mechanism, as in `DeploymentTime`.
    """

    parameters: WingParameters

    def __call__(self, x: FloatArray) -> FloatArray:
        """Give the deployment times (n,) in s of X (n, 5): V_q, delta, k_d, b, C_r."""
        from uqfold.mechanism import ideal_deployment_times

        return ideal_deployment_times(self.parameters, **_in_si_units(x))


def _in_si_units(x: FloatArray) -> dict[str, Any]:
    """Give the columns of X as the mechanism takes them."""
    v_q, delta, k_d, b, c_r = np.ascontiguousarray(x.T)
    return {"V_q": v_q, "delta": np.deg2rad(delta), "k_d": k_d, "b": b * 1e-3, "C_r": c_r * 1e-3}


def folding_wing(parameters: WingParameters | None = None) -> Problem:
    """Give the folding-wing system of Example 3.

    Parameters
    ----------
    parameters
        The mechanism; None takes Table 1. Its values of V_q, delta, k_d, b and C_r do not matter,
        since these five are the random inputs.

    Returns
    -------
    Problem
        Four units; shared inputs V_q (m/s) and delta (deg), individual inputs k_d (N), b (mm) and
        C_r (mm); the response is the deployment time (s), +inf for a wing that never locks. Its
        low-fidelity partner is the wing with ideal joints, which takes no notice of C_r.
        References are attached only when the mechanism is the default one.
    """
    wing = WingParameters() if parameters is None else parameters

    is_default = wing == WingParameters()
    return Problem(
        DeploymentTime(wing),
        shared={name: normal(*table) for name, table in TABLE_6_SHARED.items()},
        individual={name: normal(*table) for name, table in TABLE_6_INDIVIDUAL.items()},
        units=4,
        low_fidelity=IdealDeploymentTime(wing),
        name="folding-wing",
        version=_version(wing),
        response="deployment time",
        response_unit="s",
        input_units=INPUT_UNITS,
        default_criteria=criteria(threshold=DEFAULT_THRESHOLDS, tau=DEFAULT_TAU),
        references=load_references("folding_wing") if is_default else None,
    )


def _version(wing: WingParameters) -> str:
    """Give a text that changes with whatever may change a deployment time.

    That is the source of the mechanism and of this module, the parameters, and the compiler, which
    may change the last digit.
    """
    import uqfold.mechanism

    digest = hashlib.sha256(repr(wing).encode())
    digest.update(f"numba {version('numba')}, llvmlite {version('llvmlite')}".encode())
    for path in [Path(__file__), *sorted(Path(uqfold.mechanism.__file__).parent.glob("*.py"))]:
        digest.update(path.read_bytes())
    return f"example-3-{digest.hexdigest()[:16]}"
