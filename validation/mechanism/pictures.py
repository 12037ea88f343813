"""The pictures of docs/mechanism.md: motion, contact forces, and the journals in their bearings.

python validation/mechanism/pictures.py            writes docs/images/mechanism-*.png
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from uqfold.mechanism import Trajectory, WingParameters, trajectory
from uqfold.report.style import figure_settings

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
WING = WingParameters()
"""Table 1."""

CRANK, ROD, SLIDER = "#0072B2", "#D55E00", "#009E73"
JOINTS = (("joint B, crank and rod", CRANK), ("joint C, rod and slider", ROD))
FIRST_IMPACTS = (0.010, 0.040)
"""Stretch (s) in which the contacts are told apart."""


def eccentricities(m: Trajectory, joint: int) -> tuple[np.ndarray, np.ndarray]:
    """Eccentricity (m) along X and Y, Eq. (1)."""
    theta_1, x_2, y_2, theta_2, x_3 = m.coordinates.T
    half = 0.5 * WING.l_2
    if joint == 0:
        x = x_2 + half * np.cos(theta_2) - WING.l_1 * np.cos(theta_1)
        return x, y_2 + half * np.sin(theta_2) - WING.l_1 * np.sin(theta_1)
    return x_2 - half * np.cos(theta_2) - x_3, y_2 - half * np.sin(theta_2) + WING.c


def motion(m: Trajectory) -> Figure:
    """Mechanism at successive times, and the crank's angle over time (Fig. 8 of the paper)."""
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(8.4, 3.6), width_ratios=(1.25, 1.0), layout="constrained"
    )
    times = [0.0, 0.2, 0.3, 0.4, 0.45, m.deployment_time]
    for k, t in enumerate(times):
        i = int(np.argmin(np.abs(m.time - t)))
        theta_1, x_2, y_2, theta_2, x_3 = m.coordinates[i]
        rod = 0.5 * WING.l_2 * np.array([np.cos(theta_2), np.sin(theta_2)])
        B = WING.l_1 * np.array([np.cos(theta_1), np.sin(theta_1)])
        alpha = 0.25 + 0.75 * k / (len(times) - 1)
        left.plot([0.0, B[0]], [0.0, B[1]], color=CRANK, alpha=alpha, linewidth=2.2)
        left.plot(
            [x_2 - rod[0], x_2 + rod[0]], [y_2 - rod[1], y_2 + rod[1]],
            color=ROD, alpha=alpha, linewidth=2.2,
        )  # fmt: skip
        left.plot(x_3, -WING.c, "s", color=SLIDER, alpha=alpha, markersize=7)
        left.annotate(
            f"{m.time[i]:.2f} s",
            B,
            textcoords="offset points",
            xytext=(5, 3),
            fontsize=8,
            color="#444444",
        )
    left.plot(0.0, 0.0, "ko", markersize=5)
    left.annotate("A", (0.0, 0.0), textcoords="offset points", xytext=(-3, 7))
    for label, color in (("crank", CRANK), ("rod", ROD), ("slider", SLIDER)):
        left.plot([], [], color=color, linewidth=2.2, label=label)
    left.legend(loc="upper left")
    left.set(xlabel="X (m)", ylabel="Y (m)", xlim=(-0.1, 1.75), ylim=(-0.2, 1.35), aspect="equal")
    left.set_title("Crank, rod and slider from rest to the lock")

    right.plot(m.time, np.degrees(m.coordinates[:, 0]), color=CRANK)
    right.axvline(m.deployment_time, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    right.annotate(
        f"lock at {m.deployment_time:.4f} s",
        (m.deployment_time, 4.0), textcoords="offset points", xytext=(-5, 0), ha="right",
    )  # fmt: skip
    right.set(xlabel="time (s)", ylabel=r"crank angle $\theta_1$ (degrees)", ylim=(-1, 58))
    right.set_title(r"Crank angle over time, Table 1")
    return figure


def forces(m: Trajectory) -> Figure:
    """Normal contact forces: first impacts, and the whole motion."""
    figure, axes = plt.subplots(2, 2, figsize=(8.4, 4.8), sharey=True, layout="constrained")
    for joint, (name, color) in enumerate(JOINTS):
        for column, axis in enumerate(axes[joint]):
            # below the axis where there is no contact
            force = np.maximum(m.normal_force[:, joint], 1.0)
            axis.plot(m.time, force, color=color, linewidth=(0.9, 0.5)[column])
            axis.set_yscale("log")
            axis.set(ylim=(10.0, 2.0 * m.normal_force.max()))
            if column == 0:
                axis.set(xlim=FIRST_IMPACTS, ylabel="normal force (N)")
            else:
                axis.set(xlim=(0.0, m.deployment_time))
            axis.set_title(f"{name}: {('first impacts', 'whole motion')[column]}")
            if joint == 1:
                axis.set_xlabel("time (s)")
    return figure


def journals(m: Trajectory) -> Figure:
    """Paths of the journals' centres in their bearings, and the phase portrait of a joint."""
    figure, axes = plt.subplots(
        1, 3, figsize=(8.8, 3.2), width_ratios=(1.0, 1.0, 1.1), layout="constrained"
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    lines = None
    for joint, (name, _) in enumerate(JOINTS):
        axis = axes[joint]
        x, y = (1e3 * part for part in eccentricities(m, joint))
        points = np.column_stack([x, y])
        lines = LineCollection(
            list(np.stack([points[:-1], points[1:]], axis=1)), cmap="viridis", linewidths=0.8
        )
        lines.set_array(m.time[:-1])
        axis.add_collection(lines)
        size = 1e3 * WING.C_r
        axis.plot(size * np.cos(angle), size * np.sin(angle), color="black", linewidth=0.8)
        axis.plot(0.0, 0.0, "+", color="black")
        axis.set(aspect="equal", xlim=(-1.15 * size, 1.15 * size), ylim=(-1.15 * size, 1.15 * size))
        axis.set(xlabel="$e_x$ (mm)", ylabel="$e_y$ (mm)")
        axis.set_title(name)
    if lines is not None:
        figure.colorbar(
            lines, ax=list(axes[:2]), label="time (s)", orientation="horizontal", aspect=40
        )
    x, y = eccentricities(m, 0)
    distance = np.hypot(x, y)
    # rate of the distance, from the points in between
    rate = np.gradient(distance, m.time)
    early = (m.time > 0.0) & (m.time < 0.2)
    axes[2].plot(1e3 * (distance - WING.C_r)[early], rate[early], color=CRANK, linewidth=0.6)
    axes[2].axvline(0.0, color="black", linewidth=0.8)
    axes[2].set(xlabel="penetration (mm), above 0 in contact", ylabel="its rate (m/s)")
    axes[2].set_title("joint B, first 0.2 s")
    return figure


PICTURES: dict[str, Callable[[Trajectory], Figure]] = {
    "mechanism-motion.png": motion,
    "mechanism-forces.png": forces,
    "mechanism-journals.png": journals,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw all pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder for the pictures")
    folder = parser.parse_args(arguments).out
    folder.mkdir(parents=True, exist_ok=True)
    m = trajectory(WING, tolerance=1e-9)
    with figure_settings():
        for name, draw in PICTURES.items():
            figure = draw(m)
            figure.savefig(folder / name)
            plt.close(figure)
            print(folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
