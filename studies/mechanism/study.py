"""The mechanism: one wing from rest to the lock.

How does one folding wing of Table 1 move, and what do the clearances of its two joints do on the
way?

The text gives the crank's angle over time as Fig. 8, but neither the initial pose nor the position
of the lock; ours (crank along X at rest, slider locked at 1.0 m) are argued in docs/mechanism.md.
Joint B joins crank and rod, joint C rod and slider. The first impacts are chaotic: which of them is
the strongest depends on the last digits, the time of the lock hardly does.
"""

import sys
from pathlib import Path

import drawings
import numpy as np
import pandas as pd

import uqfold
from uqfold.mechanism import WingParameters, motion_table

sys.path.append(str(Path(__file__).parents[1]))
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-3)
PROBLEMS: dict[str, uqfold.Problem] = {}

COLUMNS = [
    "time", "theta_1", "x_B", "y_B", "x_C", "y_C",
    *(f"{name}_{joint}" for name in ("penetration", "normal_force") for joint in "BC"),
    *(f"e_{joint}_{axis}" for joint in "BC" for axis in "xy"),
]  # fmt: skip
"""What is drawn, in SI units."""


def tables(run: Run) -> None:
    """Simulate the wing of Table 1; keep five digits of what is drawn."""
    motion = drawn(pd.DataFrame(motion_table(WingParameters(), tolerance=1e-8)))
    run.keep("table-1", motion, step=range(len(motion)))


def drawn(motion: pd.DataFrame) -> pd.DataFrame:
    """Return every step of the first impacts, fewer later on and between impacts, and the lock."""
    time, step = motion["time"], np.arange(len(motion))
    every = np.select([time < 0.04, time < 0.2, time > 0.46], [1, 2, 2], 10)
    kept = motion[(step % every == 0) | (step == step[-1])]
    return kept[COLUMNS].map(lambda value: float(f"{value:.5g}"))


def page(run: Run) -> "uqfold.report.Page":
    """Show Fig. 8, the wing in motion, and what happens in its joints."""
    page, table = new_page(run, __doc__), run.rows("table-1")
    page.section("Figures")
    page.figure(
        drawings.crank_angle(table),
        "Fig. 8: angle of the crank over time",
        "The crank is fastest before the rod stands upright, and turns back a little before the "
        "lock.",
        name="fig-8",
    )
    page.figure(drawings.poses(table), "The mechanism at successive times", name="poses")
    if run.out is not None:
        path = run.out / "figures" / "animation.svg"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(drawings.animation(table), encoding="utf-8")
    page.text(
        "![The deployment, slowed down](figures/animation.svg)\n\nThe picture moves in a browser. "
        "Circles show where each journal is within its clearance."
    )
    page.figure(drawings.forces(table), "Normal forces in the joints", name="forces")
    return finish(page, run, {})


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
