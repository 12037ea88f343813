"""Dynamics of the folding wing with joint clearances: deployment times and trajectories.

`deployment_times` and `trajectory` follow the motion in a compiled reduced form, and
`ideal_deployment_times` follows it without clearance.

The room knows no probability. Numba is loaded, and kernels are compiled or taken from the cache,
with the first use of what simulates; `WingParameters` alone needs neither.
"""

from uqfold.lazy import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
