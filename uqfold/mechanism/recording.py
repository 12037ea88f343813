"""Motion of one wing with its contact forces and an energy audit."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.mechanism.compiled import entry_point, fingerprint, kernel
from uqfold.mechanism.deployment import (
    DEFAULT_TOLERANCE,
    GIVEN_UP,
    FloatArray,
    check_wing,
    checked_tolerance,
    deploy_rows,
    warn_of_rough,
)
from uqfold.mechanism.events import State, Step, within
from uqfold.mechanism.loads import drive_force
from uqfold.mechanism.motion import (
    Five,
    directions,
    eccentricities,
    eccentricity_rates,
    joint_force,
)
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.record import NO_RECORD, RECORD_WIDTH
from uqfold.mechanism.stiff import deploy_stiff
from uqfold.mechanism.wing import WingConstants, Wings, wing_constants

# Nodes and weights of the four-point Gauss rule on [0, 1]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Motion of one wing from rest to the lock, at the n points that the time steps ended on.

    Joints are B, then C. Every force is the one on the bearing, along the normal n (from the
    centre of the bearing to that of the journal) and along t, which is n turned by +90 degrees.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time (s).
    coordinates, velocities : ndarray, shape (n, 5)
        theta_1, x_2, y_2, theta_2, x_3 (rad and m), and their rates.
    penetration : ndarray, shape (n, 2)
        Penetration (m), Eq. (2), negative while the journal is clear of the bearing.
    normal_force, tangential_force : ndarray, shape (n, 2)
        Contact forces (N), Eqs. (5) and (7).
    kinetic_energy : ndarray, shape (n,)
        Kinetic energy of all bodies (J).
    elastic_energy : ndarray, shape (n, 2)
        Energy stored in each contact, 2/5 K Delta^2.5 (J).
    work_drive, work_drag, work_gravity : ndarray, shape (n,)
        Work done on the wing since the start (J).
    contact_loss, friction_loss : ndarray, shape (n, 2)
        Energy taken out since the start by the damping part of the normal force and by friction,
        per joint (J).
    deployment_time : float
        Time of the lock (s), the last in `time`; +inf where `time` ends at t_max without a lock.
    """

    time: FloatArray
    coordinates: FloatArray
    velocities: FloatArray
    penetration: FloatArray
    normal_force: FloatArray
    tangential_force: FloatArray
    kinetic_energy: FloatArray
    elastic_energy: FloatArray
    work_drive: FloatArray
    work_drag: FloatArray
    work_gravity: FloatArray
    contact_loss: FloatArray
    friction_loss: FloatArray
    deployment_time: float

    @property
    def energy_residual(self) -> FloatArray:
        """Work done minus energy stored and lost (J), shape (n,); 0 but for the steps' error."""
        stored = self.kinetic_energy + self.elastic_energy.sum(axis=1)
        lost = self.contact_loss.sum(axis=1) + self.friction_loss.sum(axis=1)
        residual: FloatArray = self.work_drive + self.work_drag + self.work_gravity - stored - lost
        return residual


def trajectory(parameters: WingParameters, *, tolerance: float = DEFAULT_TOLERANCE) -> Trajectory:
    """Motion of one wing, taken with the time steps of `deployment_times`.

    Parameters
    ----------
    parameters : WingParameters
        The wing.
    tolerance : float, optional
        Local error allowed per time step (m), in the position of the joints, from 1e-16 to 1e-4.

    Returns
    -------
    Trajectory
        Motion, contact forces and energies up to the lock, or to t_max without one.

    Raises
    ------
    ValueError
        If the tolerance is out of its bounds.
    TypeError
        If an argument has another type.

    Warns
    -----
    RuntimeWarning
        If even implicit steps could not follow the motion with its error under control.
    """
    check_wing(parameters)
    tolerance = checked_tolerance(tolerance)
    wing = Wings(parameters).table()
    times = np.empty(1)
    steps = deploy_rows(wing, tolerance, times, NO_RECORD)
    if times[0] == GIVEN_UP:
        _, rough, steps = deploy_stiff(wing, tolerance, NO_RECORD)
        record = np.empty((steps + 1, RECORD_WIDTH))
        times[0] = deploy_stiff(wing, tolerance, record)[0]
        if rough:
            warn_of_rough(1, 1)
    else:
        record = np.empty((steps + 1, RECORD_WIDTH))
        deploy_rows(wing, tolerance, times, record)
    contact = np.empty((steps + 1, 2, 4))
    energy = np.zeros((steps + 1, 8))
    _audit(wing, record, _NODES, _WEIGHTS, contact, energy)
    return Trajectory(
        time=record[:, 0],
        coordinates=record[:, 1:6],
        velocities=record[:, 6:11],
        penetration=contact[:, :, 0],
        normal_force=contact[:, :, 1],
        tangential_force=contact[:, :, 2],
        elastic_energy=contact[:, :, 3],
        kinetic_energy=energy[:, 7],
        work_drive=energy[:, 0],
        work_drag=energy[:, 1],
        work_gravity=energy[:, 2],
        contact_loss=energy[:, 3:5],
        friction_loss=energy[:, 5:7],
        deployment_time=float(times[0]),
    )


@kernel
def _joint_audit(
    w: WingConstants,
    e: tuple[float, float],
    e_rate: tuple[float, float],
    roll: float,
    C_r: float,
    stiffness: float,
    damping: float,
) -> tuple[float, float, float, float, float, float]:
    """Penetration, normal and tangential force, elastic energy, power lost normally, by friction.

    The arguments are those of `joint_force`.
    """
    distance = math.hypot(e[0], e[1])
    penetration = distance - C_r
    if damping < 0.0 or penetration <= 0.0:
        return penetration, 0.0, 0.0, 0.0, 0.0, 0.0
    f_x, f_y, tangential = joint_force(
        w, e[0], e[1], e_rate[0], e_rate[1], roll, C_r, stiffness, damping
    )
    n_x = e[0] / distance
    n_y = e[1] / distance
    normal = f_x * n_x + f_y * n_y
    spring = stiffness * penetration**1.5
    rate = e_rate[0] * n_x + e_rate[1] * n_y
    # friction takes power by the velocity at which the surfaces slide, whichever one it is set by
    slip = e_rate[1] * n_x - e_rate[0] * n_y + roll
    elastic = 0.4 * spring * penetration
    return penetration, normal, tangential, elastic, (normal - spring) * rate, tangential * slip


@kernel
def _joints_audit(
    w: WingConstants, q: Five, v: Five, damping_B: float, damping_C: float
) -> tuple[
    tuple[float, float, float, float, float, float],
    tuple[float, float, float, float, float, float],
]:
    """`_joint_audit` of B and of C."""
    d = directions(q)
    e = eccentricities(w, q, d)
    r = eccentricity_rates(w, v, d)
    roll_B = w.R_j_B * v[3] - w.R_b * v[0]
    roll_C = w.R_j_C * v[3]
    return (
        _joint_audit(w, (e[0], e[1]), (r[0], r[1]), roll_B, w.C_r_B, w.K_B, damping_B),
        _joint_audit(w, (e[2], e[3]), (r[2], r[3]), roll_C, w.C_r_C, w.K_C, damping_C),
    )


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def audit(wings, record, nodes, weights, contact, energy):  # type: ignore[no-untyped-def]
        """Fill `contact` (n, 2, 4) and `energy` (n, 8) from the recorded motion of the one wing.

        `contact` holds penetration, normal force, tangential force and elastic energy per joint;
        `energy` the work of drive, drag and gravity, the losses by damping in B and C and by
        friction in B and C, all summed up from 0 by Gauss rules, and the kinetic energy.
        """
        w = wing_constants(wings[0])
        # not read here; source matters as a part of the cache key only
        gaps = (0.0 * source, 0.0, 0.0, 0.0)
        for i in range(record.shape[0]):
            q, v, a = _five(record[i], 1), _five(record[i], 6), _five(record[i], 11)
            z_B, z_C = record[i, 16], record[i, 17]
            B, C = _joints_audit(w, q, v, z_B, z_C)
            for k in range(4):
                contact[i, 0, k] = B[k]
                contact[i, 1, k] = C[k]
            energy[i, 7] = 0.5 * (
                v[0] * v[0] / w.inverse_J_A
                + (v[1] * v[1] + v[2] * v[2]) / w.inverse_m_2
                + v[3] * v[3] / w.inverse_J_2
                + v[4] * v[4] / w.inverse_m_3
            )
            if i + 1 == record.shape[0]:
                break
            t = record[i, 0]
            h = record[i + 1, 0] - t
            start = State(t, q, v, a, directions(q), gaps, z_B, z_C)
            following = record[i + 1]
            step = Step(
                start, h, _five(following, 1), _five(following, 6), _five(following, 11), gaps
            )
            for k in range(7):
                energy[i + 1, k] = energy[i, k]
            if h <= 0.0:
                continue
            for j in range(nodes.shape[0]):
                q, v = within(step, nodes[j])
                _, s_1, _, s_2 = directions(q)
                x_1_rate = -w.half_l_1 * s_1 * v[0]
                B, C = _joints_audit(w, q, v, z_B, z_C)
                share = h * weights[j]
                energy[i + 1, 0] += share * drive_force(t + nodes[j] * h, w.k_d) * v[4]
                energy[i + 1, 1] += share * (w.D_1 * abs(s_1) * x_1_rate + w.D_2 * abs(s_2) * v[1])
                energy[i + 1, 2] += share * (w.G_1 * x_1_rate + w.G_2 * v[1] + w.G_3 * v[4])
                energy[i + 1, 3] += share * B[4]
                energy[i + 1, 4] += share * C[4]
                energy[i + 1, 5] += share * B[5]
                energy[i + 1, 6] += share * C[5]

    return audit


@kernel
def _five(row: FloatArray, first: int) -> Five:
    """Five numbers of a row as a tuple."""
    return row[first], row[first + 1], row[first + 2], row[first + 3], row[first + 4]


_audit = _build(fingerprint())
