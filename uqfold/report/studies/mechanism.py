"""The figures of the mechanism, drawn from the table of a trajectory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import NUMBER, TABLE_NAME, Key, Kind, choice, list_of
from uqfold.comparison.studies.steps.trajectory import NAMES
from uqfold.report.mechanism_animation import mechanism_animation
from uqfold.report.mechanism_joints import contact_forces, joint_penetrations, journal_paths
from uqfold.report.mechanism_motion import POSES, crank_angle, mechanism_poses

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_VIEWS: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "crank-angle": crank_angle,
    "forces": contact_forces,
    "penetrations": joint_penetrations,
    "journals": journal_paths,
}

_TABLE = Key("table", TABLE_NAME, "A trajectory.")


def draw_motion(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw one view of a trajectory: settings are the values of the keys of `MOTION`."""
    return _VIEWS[settings["view"]](tables[settings["table"]])


def draw_poses(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the mechanism at successive times: settings are the keys of `MECHANISM`."""
    return mechanism_poses(tables[settings["table"]], settings["times"])


def animate(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> str:
    """Give the motion as an animated SVG: settings are the values of the keys of `ANIMATION`."""
    return mechanism_animation(tables[settings["table"]], settings["slowdown"])


MOTION = Kind(
    "motion",
    "Crank angle, joint forces, penetrations or paths of the journals over one deployment.",
    (_TABLE, Key("view", choice(*_VIEWS), "What to draw.")),
    draw_motion,
    needs=NAMES,
)
MECHANISM = Kind(
    "mechanism",
    "The mechanism at successive times.",
    (_TABLE, Key("times", list_of(NUMBER), "Times (s), besides that of the lock.", POSES)),
    draw_poses,
    needs=NAMES,
)
ANIMATION = Kind(
    "animation",
    "The deployment as an animated SVG picture with both joints magnified.",
    (_TABLE, Key("slowdown", NUMBER, "How many times slower than the motion.", 12.0)),
    animate,
    needs=NAMES,
    picture="svg",
)
