"""Dynamics of the folding wing with joint clearances: deployment times and trajectories.

The room knows no probability. Numba is loaded, and kernels are compiled or taken from the cache,
with the first use of what simulates; `WingParameters` alone needs neither.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from uqfold.mechanism.parameters import TangentialVelocity, WingParameters

if TYPE_CHECKING:
    from uqfold.mechanism.deployment import DEFAULT_TOLERANCE, deployment_times
    from uqfold.mechanism.recording import Trajectory, trajectory

__all__ = [
    "DEFAULT_TOLERANCE",
    "TangentialVelocity",
    "Trajectory",
    "WingParameters",
    "deployment_times",
    "trajectory",
]

_HOMES = {
    "DEFAULT_TOLERANCE": "deployment",
    "deployment_times": "deployment",
    "Trajectory": "recording",
    "trajectory": "recording",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
