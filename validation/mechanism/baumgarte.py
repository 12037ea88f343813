"""The wing's motion in the paper's own form: nine coordinates and Lagrange multipliers, Eq. (20).

Coordinates q = (x_1, y_1, theta_1, x_2, y_2, theta_2, x_3, y_3, theta_3) are held together by the
constraints (10), which Baumgarte's terms keep from drifting apart. Nothing of uqfold's reduced form
is used here.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence

import numpy as np

from uqfold.mechanism import WingParameters
from validation.mechanism.bodies import Bodies


class Multibody:
    """Eqs. (10) to (20) for one wing, as `follow` takes them.

    The drift of the constraints depends on the stabilization coefficients alpha and beta (1/s), the
    motion does not.
    """

    slider = 6

    def __init__(self, p: WingParameters, alpha: float = 50.0, beta: float = 50.0) -> None:
        self.p, self.alpha, self.beta = p, alpha, beta
        self.bodies = Bodies(p)
        m, J = self.bodies.mass, self.bodies.inertia
        # masses and constraints' derivatives of Eq. (20); those by theta_1 come with the pose
        self.matrix = np.diag([*np.column_stack([m, m, J]).ravel(), 0.0, 0.0, 0.0, 0.0])
        for row, column in ((9, 0), (10, 1), (11, 7), (12, 8)):
            self.matrix[row, column] = self.matrix[column, row] = 1.0

    def start(self) -> np.ndarray:
        """Return coordinates and velocities (18,) at rest."""
        return np.array([*self.bodies.start(), *[0.0] * 9])

    def penetration(self, y: Sequence[float], which: int) -> tuple[float, float]:
        """Return the penetration (2) of a joint (m) and its rate (m/s)."""
        return self.bodies.penetration(y[:9], y[9:], which)

    def constraints(self, y: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the constraints (10), (4,), and their rates."""
        crank = cmath.rect(self.p.l_1 / 2, y[2])
        rate = 1j * y[11] * crank
        return (
            np.array([y[0] - crank.real, y[1] - crank.imag, y[7] + self.p.c, y[8]]),
            np.array([y[9] - rate.real, y[10] - rate.imag, y[16], y[17]]),
        )

    def rates(self, t: float, state: np.ndarray, onset: Sequence[float | None]) -> np.ndarray:
        """Return the rates (18,) by Eq. (20), given the onset rate of each contact that is on."""
        y = state.tolist()
        Q = self.bodies.forces(t, y[:9], y[9:], onset)
        crank = cmath.rect(self.p.l_1 / 2, y[2])
        matrix = self.matrix.copy()
        matrix[9, 2] = matrix[2, 9] = crank.imag
        matrix[10, 2] = matrix[2, 10] = -crank.real
        phi, phi_rate = self.constraints(y)
        gamma = np.array([-crank.real, -crank.imag, 0.0, 0.0]) * y[11] ** 2
        right = gamma - 2.0 * self.alpha * phi_rate - self.beta**2 * phi
        return np.concatenate([state[9:], np.linalg.solve(matrix, np.append(Q, right))[:9]])
