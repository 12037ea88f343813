"""The motion of one wing as a table of named columns, for figures and for other programs."""

import numpy as np

from uqfold.mechanism.deployment import DEFAULT_TOLERANCE, FloatArray
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.recording import trajectory

JOINTS = ("B", "C")


def motion_table(
    parameters: WingParameters, *, tolerance: float = DEFAULT_TOLERANCE
) -> dict[str, FloatArray]:
    """Return motion, contacts and energies of one simulated wing as columns.

    Parameters
    ----------
    parameters : WingParameters
        The wing.
    tolerance : float, optional
        Local error allowed per time step (m), as in `trajectory`.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        One row per time step, in SI units with angles in radians:

        - ``time``; ``theta_1``, ``theta_2``, the angles of crank and rod;
        - ``x_B``, ``y_B``, ``x_C``, ``y_C``, the centres of the bearings on crank and slider;
        - ``e_B_x`` to ``e_C_y``, the eccentricities of the journals in them, Eq. (1);
        - ``penetration_B``, ``penetration_C``, Eq. (2), negative while a journal is clear;
        - ``normal_force_B`` to ``tangential_force_C``, Eqs. (5) and (7);
        - ``kinetic_energy``, ``elastic_energy``, ``work_drive``, ``work_drag``, ``work_gravity``,
          ``contact_loss``, ``friction_loss``, both joints together.

        The last row is the lock, or t_max without one.

    Raises
    ------
    ValueError, TypeError
        As `trajectory`.
    """
    m = trajectory(parameters, tolerance=tolerance)
    theta_1, x_2, y_2, theta_2, x_3 = m.coordinates.T
    half = 0.5 * parameters.l_2
    rod_x, rod_y = half * np.cos(theta_2), half * np.sin(theta_2)
    x_B, y_B = parameters.l_1 * np.cos(theta_1), parameters.l_1 * np.sin(theta_1)
    y_C = np.full_like(x_3, -parameters.c)
    table = {
        "time": m.time,
        "theta_1": theta_1,
        "theta_2": theta_2,
        "x_B": x_B,
        "y_B": y_B,
        "x_C": x_3,
        "y_C": y_C,
        "e_B_x": x_2 + rod_x - x_B,
        "e_B_y": y_2 + rod_y - y_B,
        "e_C_x": x_2 - rod_x - x_3,
        "e_C_y": y_2 - rod_y - y_C,
    }
    for name in ("penetration", "normal_force", "tangential_force"):
        for joint, column in zip(JOINTS, getattr(m, name).T, strict=True):
            table[f"{name}_{joint}"] = column
    return table | {
        "kinetic_energy": m.kinetic_energy,
        "elastic_energy": m.elastic_energy.sum(axis=1),
        "work_drive": m.work_drive,
        "work_drag": m.work_drag,
        "work_gravity": m.work_gravity,
        "contact_loss": m.contact_loss.sum(axis=1),
        "friction_loss": m.friction_loss.sum(axis=1),
    }
