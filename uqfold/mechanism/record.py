"""Points of a motion as they are recorded."""

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.events import State

RECORD_WIDTH = 18
"""Numbers recorded per time step: t, q (5), v (5), a (5), damping of the contacts of B and C."""


NO_RECORD = np.empty((0, RECORD_WIDTH))
"""Room for no point."""


@kernel
def write_point(record: NDArray[np.float64], i: int, state: State) -> None:
    """Put a state in row i of `record` (m, RECORD_WIDTH), if it has one."""
    if i >= record.shape[0]:
        return
    point = record[i]
    point[0] = state.t
    for k in range(5):
        point[1 + k] = state.q[k]
        point[6 + k] = state.v[k]
        point[11 + k] = state.a[k]
    point[16] = state.damping_B
    point[17] = state.damping_C
