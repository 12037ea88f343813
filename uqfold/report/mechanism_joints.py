"""What happens in the joints: contact forces, penetrations, and the journals in their bearings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from uqfold.report.mechanism_motion import CRANK, ROD
from uqfold.report.style import figure_settings
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

JOINTS = (("B", "joint B, crank and rod", CRANK), ("C", "joint C, rod and slider", ROD))
FIRST_IMPACTS = (0.010, 0.040)
"""Stretch (s) in which the contacts are told apart."""
LEAST_FORCE = 10.0
"""Lower end (N) of the axis of forces."""


@figure_settings()
def contact_forces(table: Mapping[str, ArrayLike]) -> Figure:
    """Draw the normal forces of both joints: first impacts, and the whole motion.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    """
    highest = max(float(np.max(np.asarray(table[f"normal_force_{joint}"]))) for joint in "BC")

    def draw(axes: Axes, joint: str, color: str, width: float) -> None:
        # without contact there is no force: the curve leaves the axis
        force = np.maximum(np.asarray(table[f"normal_force_{joint}"]), 0.1 * LEAST_FORCE)
        axes.plot(np.asarray(table["time"]), force, color=color, linewidth=width)
        axes.set_yscale("log")
        axes.set_ylim(LEAST_FORCE, 2.0 * highest)

    return _joint_panels(table, "normal force (N)", draw)


@figure_settings()
def joint_penetrations(table: Mapping[str, ArrayLike]) -> Figure:
    """Draw the penetrations of both joints: first impacts, and the whole motion.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    """

    def draw(axes: Axes, joint: str, color: str, width: float) -> None:
        depth = 1e3 * np.asarray(table[f"penetration_{joint}"])
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.plot(np.asarray(table["time"]), depth, color=color, linewidth=width)

    return _joint_panels(table, "penetration (mm)\nabove 0 in contact", draw)


@figure_settings()
def journal_paths(table: Mapping[str, ArrayLike]) -> Figure:
    """Draw the paths of the journals' centres, and how penetration and its rate go together.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 3.3), layout="constrained")
    panels = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.1))
    time = np.asarray(table["time"])
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    for axes, (joint, name, _) in zip(panels, JOINTS, strict=False):
        x, y = (1e3 * np.asarray(table[f"e_{joint}_{part}"]) for part in "xy")
        points = np.column_stack([x, y])
        lines = LineCollection(
            list(np.stack([points[:-1], points[1:]], axis=1)),
            cmap="viridis",
            linewidths=0.8,
            # thousands of pieces: as shapes they would make a file of half a megabyte
            rasterized=True,
        )
        lines.set_array(time[:-1])
        axes.add_collection(lines)
        size = 1e3 * float(clearance(table, joint))
        axes.plot(size * np.cos(angle), size * np.sin(angle), color="black", linewidth=0.8)
        axes.plot(0.0, 0.0, "+", color="black")
        span = (-1.2 * size, 1.2 * size)
        axes.set(aspect="equal", xlim=span, ylim=span, xlabel="$e_x$ (mm)", ylabel="$e_y$ (mm)")
        axes.set_title(name)
    figure.colorbar(
        lines, ax=list(panels[:2]), label="time (s)", orientation="horizontal", aspect=40
    )
    depth = 1e3 * np.asarray(table["penetration_B"])
    # rate of the penetration, from the points in between
    rate = np.gradient(1e-3 * depth, time)
    early = (time > 0.0) & (time < 0.2)
    panels[2].plot(depth[early], rate[early], color=CRANK, linewidth=0.6)
    panels[2].axvline(0.0, color="black", linewidth=0.8)
    panels[2].set(xlabel="penetration (mm)\nabove 0 in contact", ylabel="its rate (m/s)")
    panels[2].set_title("joint B, first 0.2 s")
    return figure


def clearance(table: Mapping[str, ArrayLike], joint: str) -> FloatArray:
    """Give the radial clearance (m) of a joint: distance of the centres less penetration, Eq. (2).

    It is constant; the row with the largest distance loses the fewest digits.
    """
    distance = np.hypot(np.asarray(table[f"e_{joint}_x"]), np.asarray(table[f"e_{joint}_y"]))
    i = int(np.argmax(distance))
    return np.asarray(distance[i] - np.asarray(table[f"penetration_{joint}"])[i])


def _joint_panels(
    table: Mapping[str, ArrayLike],
    label: str,
    draw: Callable[[Axes, str, str, float], None],
) -> Figure:
    """Lay out one row of panels per joint: first impacts, and the whole motion."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    grid = figure.subplots(2, 2, sharey=True)
    end = float(np.asarray(table["time"])[-1])
    stretches = ((FIRST_IMPACTS, "first impacts", 1.0), ((0.0, end), "whole motion", 0.6))
    for row, (joint, name, color) in zip(grid, JOINTS, strict=True):
        for axes, (span, words, width) in zip(row, stretches, strict=True):
            draw(axes, joint, color, width)
            axes.set(xlim=span, title=f"{name}: {words}")
        row[0].set_ylabel(label)
    for axes in grid[1]:
        axes.set_xlabel("time (s)")
    return figure
