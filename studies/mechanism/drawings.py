"""Drawings of one folding wing: poses, joints, and the deployment as an animated picture."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

CRANK, ROD, SLIDER = "#0072B2", "#D55E00", "#009E73"
JOINTS = (("B", "joint B, crank and rod", CRANK), ("C", "joint C, rod and slider", ROD))
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
    """Draw the normal forces of both joints: first impacts, and the whole motion."""
    columns = [f"normal_force_{joint}" for joint, *_ in JOINTS]
    # without contact there is no force: the curve leaves the axis
    values = table[columns].clip(lower=0.1 * LEAST_FORCE)
    limits = (LEAST_FORCE, 2.0 * values.max(axis=None))
    return joint_panels(table["time"], values, "normal force (N)", yscale="log", ylim=limits)


def penetrations(table: pd.DataFrame) -> Figure:
    """Draw the penetrations of both joints: first impacts, and the whole motion."""
    values = 1e3 * table[[f"penetration_{joint}" for joint, *_ in JOINTS]]
    figure = joint_panels(table["time"], values, "penetration (mm)\nabove 0 in contact")
    for axes in figure.axes:
        axes.axhline(0.0, color="black", linewidth=0.6, zorder=0.5)
    return figure


def joint_panels(time: pd.Series, values: pd.DataFrame, label: str, **settings: Any) -> Figure:
    """Draw one row of panels per joint, a column of `values` each: impacts, and whole motion."""
    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    grid = figure.subplots(2, 2, sharey=True)
    stretches = ((FIRST_IMPACTS, "first impacts", 1.0), ((0.0, time.max()), "whole motion", 0.6))
    for row, column, (_, name, color) in zip(grid, values, JOINTS, strict=True):
        for axes, (span, words, width) in zip(row, stretches, strict=True):
            axes.plot(time, values[column], color=color, linewidth=width)
            axes.set(xlim=span, title=f"{name}: {words}", **settings)
        row[0].set_ylabel(label)
    for axes in grid[1]:
        axes.set_xlabel("time (s)")
    return figure


def journals(table: pd.DataFrame) -> Figure:
    """Draw the paths of the journals' centres, and how penetration and its rate go together."""
    figure = Figure(figsize=(8.0, 3.3), layout="constrained")
    panels = figure.subplots(1, 3, width_ratios=(1.0, 1.0, 1.1))
    time = table["time"].to_numpy()
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    for axes, (joint, name, _) in zip(panels, JOINTS, strict=False):
        points = 1e3 * table[[f"e_{joint}_x", f"e_{joint}_y"]].to_numpy()
        pieces = np.stack([points[:-1], points[1:]], axis=1)
        lines = LineCollection(pieces, array=time[:-1], cmap="viridis", linewidths=0.8)
        axes.add_collection(lines)
        size = 1e3 * clearance(table, joint)
        axes.plot(size * np.cos(angle), size * np.sin(angle), color="black", linewidth=0.8)
        axes.plot(0.0, 0.0, "+", color="black")
        span = (-1.2 * size, 1.2 * size)
        axes.set(aspect="equal", xlim=span, ylim=span, xlabel="$e_x$ (mm)", ylabel="$e_y$ (mm)")
        axes.set_title(name)
    figure.colorbar(
        lines, ax=list(panels[:2]), label="time (s)", orientation="horizontal", aspect=40
    )
    depth = table["penetration_B"].to_numpy()
    # rate of the penetration, from the points in between
    rate = np.gradient(depth, time)
    early = (time > 0.0) & (time < 0.2)
    panels[2].plot(1e3 * depth[early], rate[early], color=CRANK, linewidth=0.6)
    panels[2].axvline(0.0, color="black", linewidth=0.8)
    panels[2].set(xlabel="penetration (mm)\nabove 0 in contact", ylabel="its rate (m/s)")
    panels[2].set_title("joint B, first 0.2 s")
    return figure


def clearance(table: pd.DataFrame, joint: str) -> float:
    """Return the radial clearance (m) of a joint: distance of centres less penetration, Eq. (2).

    It is constant; the row with the largest distance loses the fewest digits.
    """
    distance = np.hypot(table[f"e_{joint}_x"], table[f"e_{joint}_y"])
    i = distance.idxmax()
    return float(distance[i] - table[f"penetration_{joint}"][i])


class Film:
    """The motion at equal steps of time, then standing still, as animated parts of an SVG picture.

    Animation is that of SVG itself (SMIL): no script, and it moves where it is shown as an image.
    A program that knows no animation shows the pose halfway.
    """

    def __init__(self, table: pd.DataFrame, slowdown: float, frames: int = 400) -> None:
        self.table, self.end = table, float(table["time"].iloc[-1])
        still = np.full(round(0.15 * frames), self.end)
        self.time = np.concatenate([np.linspace(0.0, self.end, frames), still])
        self.seconds = slowdown * self.end / (frames - 1) * (self.time.size - 1)

    def column(self, name: str, offset: float, scale: float) -> np.ndarray:
        """Return a column at the frames, moved into the picture."""
        return offset + scale * np.interp(self.time, self.table["time"], self.table[name])

    def part(self, tag: str, moving: Mapping[str, np.ndarray], fixed: str, inner: str = "") -> str:
        """Return an element some of whose attributes move."""
        middle = self.time.size // 2
        still = " ".join(f'{name}="{values[middle]:.2f}"' for name, values in moving.items())
        for name, values in moving.items():
            if np.ptp(values) >= 0.01:
                listed = ";".join(f"{value:.2f}" for value in values)
                inner += (
                    f'<animate attributeName="{name}" dur="{self.seconds:.3f}s" '
                    f'repeatCount="indefinite" values="{listed}"/>'
                )
        return f"<{tag} {still} {fixed}>{inner}</{tag}>"


def animation(table: pd.DataFrame, slowdown: float = 12.0) -> str:
    """Return the deployment as an animated SVG picture, each joint magnified beside it."""
    film, scale, (x_A, y_A) = Film(table, slowdown), 270.0, (40.0, 375.0)
    x_B, y_B = film.column("x_B", x_A, scale), film.column("y_B", y_A, -scale)
    x_C, y_C = film.column("x_C", x_A, scale), film.column("y_C", y_A, -scale)
    ground, bar = y_C[0] + 9.0, 'stroke-width="6" stroke-linecap="round"'
    parts = [
        '<rect width="760" height="430" fill="white"/>',
        f'<line x1="8" y1="{ground:g}" x2="480" y2="{ground:g}" stroke="#999999"/>',
        film.part("line", {"x2": x_B, "y2": y_B}, f'x1="40" y1="375" stroke="{CRANK}" {bar}'),
        film.part(
            "line", {"x1": x_C, "y1": y_C, "x2": x_B, "y2": y_B}, f'stroke="{ROD}" {bar}'
        ),
        film.part(
            "rect", {"x": x_C - 11.0},
            f'y="{y_C[0] - 9.0:g}" width="22" height="18" fill="{SLIDER}"',
        ),
        f'<circle cx="{x_A:g}" cy="{y_A:g}" r="5"/>',
        _text(x_A, y_A - 12.0, "A"),
        film.part("text", {"x": x_B + 8.0, "y": y_B - 6.0}, "", "B"),
        film.part("text", {"x": x_C - 5.0, "y": y_C + 26.0}, "", "C"),
        '<rect x="500" y="375" width="240" height="8" fill="#E6E6E6"/>',
        film.part(
            "rect", {"width": 240.0 * film.time / film.end},
            'x="500" y="375" height="8" fill="#444444"',
        ),
        _text(620.0, 365.0, f"0 to {film.end:.3f} s, {slowdown:g} times slower"),
    ]  # fmt: skip
    for k, (joint, name, color) in enumerate(JOINTS):
        x, y, radius, gap = 640.0, 95.0 + 150.0 * k, 44.0, clearance(table, joint)
        e_x = film.column(f"e_{joint}_x", x, radius / gap)
        e_y = film.column(f"e_{joint}_y", y, -radius / gap)
        parts += [
            f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="#F4F4F4" stroke="#666666"/>',
            film.part("circle", {"cx": e_x, "cy": e_y}, f'r="6" fill="{color}"'),
            _text(x, y - radius - 12.0, name),
            _text(x, y + radius + 18.0, f"clearance {1e3 * gap:.3g} mm"),
        ]
    body = "\n".join(parts)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 430" width="760" height="430" '
        'font-family="DejaVu Sans, Arial, sans-serif" font-size="13">\n'
        f"<title>Deployment of one folding wing</title>\n{body}\n</svg>\n"
    )


def _text(x: float, y: float, words: str) -> str:
    return f'<text x="{x:g}" y="{y:g}" text-anchor="middle">{escape(words)}</text>'
