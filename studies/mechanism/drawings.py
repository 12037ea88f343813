"""Drawings of one folding wing: poses, joints, and the deployment as an animated picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Template
from matplotlib.figure import Figure

CRANK, ROD, SLIDER = "#0072B2", "#D55E00", "#009E73"
JOINTS = (("B", "joint B, crank and rod", CRANK), ("C", "joint C, rod and slider", ROD))
TEMPLATE = Path(__file__).parent / "animation.svg.jinja"
FIRST_IMPACTS = (0.010, 0.040)
"""Stretch (s) in which the contacts are told apart."""
LEAST_FORCE = 10.0
"""Lower end (N) of the axis of forces."""


def crank_angle(table: pd.DataFrame) -> Figure:
    """Draw the crank's angle over time, as Fig. 8 does, and mark the lock."""
    figure = Figure(figsize=(3.5, 2.6), layout="constrained")
    axes, end = figure.subplots(), table["time"].iloc[-1]
    axes.plot(table["time"], np.degrees(table["theta_1"]), color=CRANK, linewidth=1.5)
    axes.axvline(end, color="#888888", linewidth=0.8, linestyle=(0, (4, 2)))
    axes.annotate(
        f"lock at {end:.4f} s", (end, 0.06), xycoords=("data", "axes fraction"),
        textcoords="offset points", xytext=(-5, 0), ha="right",
    )  # fmt: skip
    axes.set(xlabel="time (s)", ylabel=r"crank angle $\theta_1$ (degrees)", xlim=(0.0, None))
    return figure


def poses(table: pd.DataFrame, times: Sequence[float] = (0.0, 0.2, 0.3, 0.4, 0.45)) -> Figure:
    """Draw crank, rod and slider at some times (s) and at the lock, the later the darker."""
    figure = Figure(figsize=(3.5, 3.1), layout="constrained")
    axes = figure.subplots()
    time, x_B, y_B, x_C, y_C = (table[name] for name in ("time", "x_B", "y_B", "x_C", "y_C"))
    shown = [*(t for t in times if t < time.iloc[-1]), time.iloc[-1]]
    line: Any = {"linewidth": 2.2, "solid_capstyle": "round"}
    for k, t in enumerate(shown):
        i = int((time - t).abs().idxmin())
        alpha = 0.3 + 0.7 * (k + 1) / len(shown)
        axes.plot([0.0, x_B[i]], [0.0, y_B[i]], color=CRANK, alpha=alpha, **line)
        # the clearances are too small to be seen: the rod ends in the centres of the bearings
        axes.plot([x_C[i], x_B[i]], [y_C[i], y_B[i]], color=ROD, alpha=alpha, **line)
        axes.plot(x_C[i], y_C[i], "s", color=SLIDER, alpha=alpha, markersize=7)
        axes.annotate(
            f"{time[i]:.2f} s" if k + 1 < len(shown) else f"{time[i]:.3f} s", (x_B[i], y_B[i]),
            textcoords="offset points", xytext=(5, 3), fontsize=8, color="#444444",
        )  # fmt: skip
    axes.axhline(y_C[0], color="#BBBBBB", linewidth=0.8, zorder=0.5)
    axes.plot(0.0, 0.0, "o", color="black", markersize=5)
    axes.annotate("A", (0.0, 0.0), textcoords="offset points", xytext=(-3, 7))
    for label, color in (("crank", CRANK), ("rod", ROD), ("slider", SLIDER)):
        axes.plot([], [], color=color, linewidth=2.2, label=label)
    axes.legend(loc="upper left")
    axes.set(xlabel="X (m)", ylabel="Y (m)", xlim=(-0.1, 1.78), ylim=(-0.21, 1.42), aspect="equal")
    return figure


def forces(table: pd.DataFrame) -> Figure:
    """Draw the normal forces of both joints, a row each: first impacts, and the whole motion."""
    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    grid = figure.subplots(2, 2, sharey=True, sharex="col")
    time = table["time"]
    stretches = ((FIRST_IMPACTS, "first impacts", 1.0), ((0.0, time.max()), "whole motion", 0.6))
    for row, (joint, name, color) in zip(grid, JOINTS, strict=True):
        # without contact there is no force: the curve leaves the axis
        force = table[f"normal_force_{joint}"].clip(lower=0.1 * LEAST_FORCE)
        for axes, (span, words, width) in zip(row, stretches, strict=True):
            axes.plot(time, force, color=color, linewidth=width)
            axes.set(xlim=span, yscale="log", title=f"{name}: {words}")
        row[0].set(ylabel="normal force (N)", ylim=(LEAST_FORCE, None))
    for axes in grid[1]:
        axes.set_xlabel("time (s)")
    return figure


def clearance(table: pd.DataFrame, joint: str) -> float:
    """Return the radial clearance (m) of a joint: distance of centres less penetration, Eq. (2).

    It is constant; the row with the largest distance loses the fewest digits.
    """
    distance = np.hypot(table[f"e_{joint}_x"], table[f"e_{joint}_y"])
    i = distance.idxmax()
    return float(distance[i] - table[f"penetration_{joint}"][i])


def animation(table: pd.DataFrame, slowdown: float = 12.0, frames: int = 400) -> str:
    """Return the deployment as an animated SVG picture, each joint magnified beside it.

    The motion at equal steps of time, `slowdown` times slower, then standing still.
    """
    end = float(table["time"].iloc[-1])
    time = np.append(np.linspace(0.0, end, frames), np.full(round(0.15 * frames), end))

    def placed(name: str, offset: float, scale: float) -> np.ndarray:
        return offset + scale * np.interp(time, table["time"], table[name])

    joints = []
    for k, (joint, name, color) in enumerate(JOINTS):
        x, y, radius, gap = 640, 95 + 150 * k, 44, clearance(table, joint)
        joints.append({
            "x": x, "y": y, "radius": radius, "name": name, "color": color,
            "clearance": f"{1e3 * gap:.3g}", "e_x": placed(f"e_{joint}_x", x, radius / gap),
            "e_y": placed(f"e_{joint}_y", y, -radius / gap),
        })  # fmt: skip
    return Template(TEMPLATE.read_text(encoding="utf-8"), autoescape=True).render(
        x_B=placed("x_B", 40.0, 270.0), y_B=placed("y_B", 375.0, -270.0),
        x_C=placed("x_C", 40.0, 270.0), y_C=placed("y_C", 375.0, -270.0),
        progress=240.0 * time / end, joints=joints, end=end, slowdown=slowdown,
        seconds=slowdown * end / (frames - 1) * (time.size - 1),
    )  # fmt: skip
