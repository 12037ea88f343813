"""Deployment time of one wing as a function of the random inputs, in their units.

This module is the one bridge between the mechanics (SI units) and the random inputs (the units of
the paper's tables), and says when responses kept in a store are those of the present mechanism.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cache
from typing import Any

from uqfold.mechanism import WingParameters
from uqfold.provenance import source_digest, versions
from uqfold.typing import FloatArray

INPUT_UNITS = {
    "V_q": "m/s",
    "delta": "deg",
    "k_d": "N",
    "b": "mm",
    "C_r": "mm",
    "l_1": "mm",
    "l_2": "mm",
}
"""Input -> unit."""
NAMES = "V_q", "delta", "k_d", "b", "C_r"
"""The inputs of Table 6."""
_TO_SI = {"m/s": 1.0, "N": 1.0, "deg": math.pi / 180.0, "mm": 1e-3}


@dataclass(frozen=True)
class DeploymentTime:
    """Deployment time of one wing, in the units of the random inputs.

    Attributes
    ----------
    parameters
        The mechanism; its values of the random inputs do not matter.
    names
        What the columns are.
    """

    parameters: WingParameters
    names: tuple[str, ...] = NAMES

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the deployment times (n,) in s of X (n, d)."""
        from uqfold.mechanism import deployment_times

        return deployment_times(self.parameters, **_in_si_units(self.names, x))


@dataclass(frozen=True)
class IdealDeploymentTime:
    """Deployment time of one wing with ideal joints: the low-fidelity partner, in the same units.

    Attributes
    ----------
    parameters, names
        As in `DeploymentTime`.
    """

    parameters: WingParameters
    names: tuple[str, ...] = NAMES

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the deployment times (n,) in s of X (n, d)."""
        from uqfold.mechanism import ideal_deployment_times

        return ideal_deployment_times(self.parameters, **_in_si_units(self.names, x))


def _in_si_units(names: tuple[str, ...], x: FloatArray) -> dict[str, Any]:
    """Return the columns of X as the mechanism takes them."""
    return {name: column * in_si(name) for name, column in zip(names, x.T, strict=True)}


def in_si(name: str) -> float:
    """Return what one of the units of an input is in SI units."""
    return _TO_SI[INPUT_UNITS[name]]


def version_of(wing: WingParameters) -> str:
    """Return a text that changes with whatever may change a deployment time.

    That is the source of the mechanism and of this module, the parameters, and the compiler, which
    may change the last digit.
    """
    digest = hashlib.sha256(f"{wing!r}, {_code()}".encode())
    return f"deployment-{digest.hexdigest()[:16]}"


@cache
def _code() -> tuple[dict[str, str], list[str]]:
    """Digests of the source as this process has loaded it, and versions of the compiler."""
    found = versions(["llvmlite"])
    return source_digest(__name__), [found["numba"], found["llvmlite"]]
