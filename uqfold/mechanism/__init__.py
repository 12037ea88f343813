"""Dynamics of the folding wing with joint clearances: deployment times and trajectories.

`deployment_times` and `trajectory` follow the motion in a compiled reduced form,
`baumgarte_trajectory` in the paper's own form, and `ideal_deployment_times` without clearance.

The room knows no probability. Numba is loaded, and kernels are compiled or taken from the cache,
with the first use of what simulates; `WingParameters` alone needs neither.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from uqfold.mechanism.parameters import ContactLaw, TangentialVelocity, WingParameters

if TYPE_CHECKING:
    from uqfold.mechanism.baumgarte import BaumgarteTrajectory, baumgarte_trajectory
    from uqfold.mechanism.deployment import DEFAULT_TOLERANCE, deployment_times
    from uqfold.mechanism.ideal import ideal_deployment_times
    from uqfold.mechanism.recording import Trajectory, trajectory
    from uqfold.mechanism.tabulation import motion_table

__all__ = [
    "DEFAULT_TOLERANCE",
    "BaumgarteTrajectory",
    "ContactLaw",
    "TangentialVelocity",
    "Trajectory",
    "WingParameters",
    "baumgarte_trajectory",
    "deployment_times",
    "ideal_deployment_times",
    "motion_table",
    "trajectory",
]

_HOMES = {
    "BaumgarteTrajectory": "baumgarte",
    "baumgarte_trajectory": "baumgarte",
    "DEFAULT_TOLERANCE": "deployment",
    "deployment_times": "deployment",
    "ideal_deployment_times": "ideal",
    "motion_table": "tabulation",
    "Trajectory": "recording",
    "trajectory": "recording",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
