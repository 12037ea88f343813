"""The motion of one wing, from rest to the lock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.document import Place, nearest
from uqfold.comparison.studies.keys import NUMBER, TEXT, Key, Kind, RowIdentity, Value
from uqfold.comparison.studies.registry import StepContext
from uqfold.mechanism import WingParameters

if TYPE_CHECKING:
    import pandas as pd

NAMES = (
    "time",
    "theta_1",
    "theta_2",
    "x_B",
    "y_B",
    "x_C",
    "y_C",
    "e_B_x",
    "e_B_y",
    "e_C_x",
    "e_C_y",
    "penetration_B",
    "penetration_C",
    "normal_force_B",
    "normal_force_C",
    "tangential_force_B",
    "tangential_force_C",
    "kinetic_energy",
    "elastic_energy",
    "work_drive",
    "work_drag",
    "work_gravity",
    "contact_loss",
    "friction_loss",
)
"""Columns of `uqfold.mechanism.motion_table`."""
DIGITS = 7
"""Significant digits of the table."""


def trajectory_table(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Simulate one wing.

    Parameters
    ----------
    settings
        Values of the keys of `TRAJECTORY`.
    context
        Not used: the motion belongs to no problem.

    Returns
    -------
    pandas.DataFrame
        Number of the time step, then columns `NAMES` in SI units, rounded to `DIGITS`
        significant digits.
    """
    import pandas as pd

    from uqfold.mechanism import motion_table

    table = motion_table(settings["parameters"], tolerance=settings["tolerance"])
    columns = {name: [float(f"{value:.{DIGITS}g}") for value in table[name]] for name in NAMES}
    return pd.DataFrame({"step": range(len(table["time"])), **columns})


def _parameters(content: Any, place: Place) -> WingParameters:
    if not isinstance(content, dict):
        raise place.error(f"{content!r} is no table of parameters")
    known = [name for name in dir(WingParameters()) if not name.startswith("_")]
    for name, value in content.items():
        read = TEXT if isinstance(value, str) else NUMBER
        read.read(value, place.at(name))
        if name not in known:
            raise place.at(name).error(f"no such parameter of the wing; {nearest(name, known)}")
    try:
        return WingParameters(**content)
    except (TypeError, ValueError) as error:
        raise place.error(str(error)) from error


def _tolerance(content: Any, place: Place) -> float:
    value: float = NUMBER.read(content, place)
    if not value > 0.0:
        raise place.error(f"{value:g}: give a number above 0")
    return value


TRAJECTORY = Kind(
    "trajectory",
    "Motion of one wing with its joint forces and energies, in SI units; the last row is the lock.",
    (
        Key(
            "parameters",
            Value("table: parameter -> value in SI units", _parameters),
            "What differs from Table 1; see `uqfold.mechanism.WingParameters`.",
            WingParameters(),
        ),
        Key("tolerance", Value("number above 0", _tolerance), "Error per time step (m).", 7e-7),
    ),
    trajectory_table,
    {"step": int, **dict.fromkeys(NAMES, float)},
    RowIdentity(("step",)),
)
