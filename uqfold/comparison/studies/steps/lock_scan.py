"""Deployment times of wings over what the text leaves open: initial pose and lock position."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.grids import NUMBERS
from uqfold.comparison.studies.keys import TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.problems.wing import IdealDeploymentTime

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "theta_1_initial": float,
    "x_lock": float,
    "time": float,
}


def lock_scan(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Give the deployment time at the means of the inputs for every pose and lock position.

    The wings have ideal joints, which changes a time by about a millisecond.

    Parameters
    ----------
    settings
        Values of the keys of `LOCK_SCAN`.
    context
        The problems.

    Returns
    -------
    pandas.DataFrame
        One row per problem, initial angle (degrees) and lock position (m) that a wing can have;
        the time (s) is infinite where it never gets there.

    Raises
    ------
    TypeError
        If a problem is none of the folding wing.
    """
    import pandas as pd

    rows = []
    for name in settings["problem"]:
        problem = context.problems[name]
        ideal = problem.low_fidelity
        if not isinstance(ideal, IdealDeploymentTime):
            raise TypeError(f"analysis lock-scan: {name!r} is no problem of the folding wing")
        means = problem.inputs.means[None, :]
        for angle in settings["theta_1_initial"]:
            for lock in settings["x_lock"]:
                try:
                    wing = ideal.parameters.replace(
                        theta_1_initial=math.radians(angle), x_lock=lock
                    )
                except ValueError:
                    # no such wing: the slider starts ahead of its lock, or the arms are too short
                    continue
                time = replace(ideal, parameters=wing)(means)
                rows.append((name, angle, lock, float(time[0])))
    return pd.DataFrame(rows, columns=list(COLUMNS))


LOCK_SCAN = Kind(
    "lock-scan",
    "Deployment time of ideal wings at the means of their inputs over initial pose and lock.",
    (
        Key("problem", list_of(TEXT), "Problems of the folding wing."),
        Key("theta_1_initial", NUMBERS, "Initial angles of the crank (degrees)."),
        Key("x_lock", NUMBERS, "Lock positions (m)."),
    ),
    lock_scan,
    COLUMNS,
    RowIdentity(("problem", "theta_1_initial", "x_lock")),
)
