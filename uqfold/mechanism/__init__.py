"""Dynamics of the folding wing with joint clearances: deployment times and trajectories.

`deployment_times` and `trajectory` follow the motion in a compiled reduced form, and
`ideal_deployment_times` follows it without clearance.

The room knows no probability. Numba is loaded, and kernels are compiled or taken from the cache,
with the first use of what simulates; `WingParameters` alone needs neither.
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports
from uqfold.mechanism.parameters import ContactLaw, TangentialVelocity, WingParameters

if TYPE_CHECKING:
    from uqfold.mechanism.deployment import DEFAULT_TOLERANCE, deployment_times
    from uqfold.mechanism.ideal import ideal_deployment_times
    from uqfold.mechanism.recording import Trajectory, trajectory
    from uqfold.mechanism.tabulation import motion_table

__all__ = [
    "DEFAULT_TOLERANCE",
    "ContactLaw",
    "TangentialVelocity",
    "Trajectory",
    "WingParameters",
    "deployment_times",
    "ideal_deployment_times",
    "motion_table",
    "trajectory",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "DEFAULT_TOLERANCE": "uqfold.mechanism.deployment",
        "Trajectory": "uqfold.mechanism.recording",
        "deployment_times": "uqfold.mechanism.deployment",
        "ideal_deployment_times": "uqfold.mechanism.ideal",
        "motion_table": "uqfold.mechanism.tabulation",
        "trajectory": "uqfold.mechanism.recording",
    },
)
