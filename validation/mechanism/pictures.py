"""The pictures of docs/mechanism.md: motion, contact forces, and the journals in their bearings.

python validation/mechanism/pictures.py            writes docs/images/mechanism-*
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from uqfold.mechanism import WingParameters, motion_table
from uqfold.report.mechanism_animation import mechanism_animation
from uqfold.report.mechanism_joints import contact_forces, journal_paths
from uqfold.report.mechanism_motion import mechanism_motion
from uqfold.report.style import figure_settings

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
WING = WingParameters()
"""Table 1."""
TOLERANCE = 1e-9

PICTURES: dict[str, Callable[[Mapping[str, np.ndarray]], Figure]] = {
    "mechanism-motion.png": mechanism_motion,
    "mechanism-forces.png": contact_forces,
    "mechanism-journals.png": journal_paths,
}
ANIMATION = "mechanism-animation.svg"


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw all pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder for the pictures")
    folder = parser.parse_args(arguments).out
    folder.mkdir(parents=True, exist_ok=True)
    table = motion_table(WING, tolerance=TOLERANCE)
    with figure_settings():
        for name, draw in PICTURES.items():
            draw(table).savefig(folder / name)
            print(folder / name)
    (folder / ANIMATION).write_text(mechanism_animation(table), encoding="utf-8")
    print(folder / ANIMATION)
    return 0


if __name__ == "__main__":
    sys.exit(main())
