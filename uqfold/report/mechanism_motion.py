"""The mechanism in motion: poses at successive times, and the crank's angle (Fig. 8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from uqfold.report.style import COLUMN_INCHES, figure_settings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CRANK, ROD, SLIDER = "#0072B2", "#D55E00", "#009E73"
"""Colours of the bodies."""
POSES = (0.0, 0.2, 0.3, 0.4, 0.45)
"""Times (s) at which the mechanism is drawn, besides the last one."""


@figure_settings()
def mechanism_motion(table: Mapping[str, ArrayLike], poses: Sequence[float] = POSES) -> Figure:
    """Draw the mechanism at successive times, and the crank's angle over time beside it.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    poses
        Times (s) at which the mechanism is drawn, besides the last one.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 3.5), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    draw_poses(left, table, poses)
    left.set_title("Crank, rod and slider from rest to the lock")
    draw_crank_angle(right, table)
    right.set_title("Crank angle over time")
    return figure


@figure_settings()
def mechanism_poses(table: Mapping[str, ArrayLike], poses: Sequence[float] = POSES) -> Figure:
    """Draw the mechanism at successive times alone, at the width of a column.

    Parameters
    ----------
    table, poses
        As in `mechanism_motion`.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN_INCHES, 3.1), layout="constrained")
    draw_poses(figure.subplots(), table, poses)
    return figure


@figure_settings()
def crank_angle(table: Mapping[str, ArrayLike]) -> Figure:
    """Draw the crank's angle over time, as Fig. 8 does, at the width of a column.

    Parameters
    ----------
    table
        Columns of `uqfold.mechanism.motion_table`.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN_INCHES, 2.6), layout="constrained")
    draw_crank_angle(figure.subplots(), table)
    return figure


def draw_poses(axes: Axes, table: Mapping[str, ArrayLike], poses: Sequence[float]) -> None:
    """Draw crank, rod and slider at the given times (s) and at the last one, the later the darker.

    Only what is reached is drawn: times after the last one of the table are left out.
    """
    time, x_B, y_B, x_C, y_C = (np.asarray(table[k]) for k in ("time", "x_B", "y_B", "x_C", "y_C"))
    shown = [*sorted(t for t in poses if t < time[-1]), float(time[-1])]
    line: Any = {"linewidth": 2.2, "solid_capstyle": "round"}
    for k, t in enumerate(shown):
        i = int(np.argmin(np.abs(time - t)))
        alpha = 0.3 + 0.7 * (k + 1) / len(shown)
        axes.plot([0.0, x_B[i]], [0.0, y_B[i]], color=CRANK, alpha=alpha, **line)
        # the clearances are too small to be seen: the rod ends in the centres of the bearings
        axes.plot([x_C[i], x_B[i]], [y_C[i], y_B[i]], color=ROD, alpha=alpha, **line)
        axes.plot(x_C[i], y_C[i], "s", color=SLIDER, alpha=alpha, markersize=7)
        axes.annotate(
            f"{time[i]:.2f} s" if k + 1 < len(shown) else f"{time[i]:.3f} s",
            (x_B[i], y_B[i]),
            textcoords="offset points",
            xytext=(5, 3),
            fontsize=8,
            color="#444444",
        )
    axes.axhline(y_C[0], color="#BBBBBB", linewidth=0.8, zorder=0.5)
    axes.plot(0.0, 0.0, "o", color="black", markersize=5)
    axes.annotate("A", (0.0, 0.0), textcoords="offset points", xytext=(-3, 7))
    for label, color in (("crank", CRANK), ("rod", ROD), ("slider", SLIDER)):
        axes.plot([], [], color=color, linewidth=2.2, label=label)
    axes.legend(loc="upper left")
    reach = float(np.hypot(x_B, y_B).max())
    axes.set(
        xlabel="X (m)",
        ylabel="Y (m)",
        xlim=(-0.07 * reach, 1.18 * reach),
        ylim=(float(y_C[0]) - 0.07 * reach, 0.13 * reach + float(y_B.max())),
        aspect="equal",
    )


def draw_crank_angle(axes: Axes, table: Mapping[str, ArrayLike]) -> None:
    """Draw the crank's angle over time, and mark the lock."""
    time, angle = np.asarray(table["time"]), np.degrees(np.asarray(table["theta_1"]))
    axes.plot(time, angle, color=CRANK, linewidth=1.5)
    axes.axvline(time[-1], color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    axes.annotate(
        f"lock at {time[-1]:.4f} s",
        (time[-1], 0.06),
        xycoords=("data", "axes fraction"),
        textcoords="offset points",
        xytext=(-5, 0),
        ha="right",
    )
    axes.set(xlabel="time (s)", ylabel=r"crank angle $\theta_1$ (degrees)", xlim=(0.0, None))
