"""Deployment times against exudyn, a general multibody code, on the same mechanism.

Exudyn calls a Python function for the contact forces several times per step, so a few wings have to
do: the means of Tables 1, 6 and 10 with both tangential velocities, a mean of Table 8, and corners
of Tables 6 and 10 at the slow and the fast end. Each runs with two steps, whose difference shows
what exudyn's steps are worth.

    python validation/mechanism/against_exudyn.py               compares with the stored times
    python validation/mechanism/against_exudyn.py --simulate    computes those anew (6 min; needs
                                                                the extra `validation`)
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from against_scipy import TOLERANCE
from claims import HERE, Claim, Finding, read_rows, report, write_rows
from parameter_sets import parameter_sets

from uqfold.mechanism import WingParameters, deployment_times

AGREEMENT = 1e-5
"""Largest difference (s)."""

STEPS = (8e-6, 4e-6)
"""Steps of exudyn (s)."""

SETS = (
    "table 1",
    "table 6",
    "table 10",
    "table 1, material",
    "table 6, material",
    "table 10, material",
    "table 8 condition 3",
    "table 6 corner +--++",
    "table 6 corner -++-+",
    "table 10 corner +--+--+",
)

CLAIM = Claim(
    name="against_exudyn",
    statement="A general multibody code gives the same deployment times for the same mechanism "
    "and contact law.",
    compared_with="exudyn 1.13 (bodies, revolute and prismatic joint, trapezoidal rule of index 2; "
    "contact law as a user force)",
    tolerance="1e-5 s: exudyn's fixed steps are not cut at events, so its own times carry a few "
    "microseconds",
    command="python validation/mechanism/against_exudyn.py",
)

STORED = HERE / "exudyn_times.csv"


def uqfold_time(wing: WingParameters) -> float:
    """Deployment time (s) by uqfold."""
    return float(deployment_times(wing, tolerance=TOLERANCE)[0])


def exudyn_times(wing: WingParameters, steps: Sequence[float] = STEPS) -> list[float]:
    """Deployment times (s) by exudyn, one per step."""
    from exudyn_wing import ExudynWing

    return [ExudynWing(wing).deploy(h, wing.t_max) for h in steps]


def stored_times() -> dict[str, list[float]]:
    """Exudyn's times per parameter set, as stored, for both steps."""
    return {
        row["set"]: [float(row[f"step {h:g} s (s)"]) for h in STEPS] for row in read_rows(STORED)
    }


def compare(
    sets: Mapping[str, WingParameters],
    expected: Mapping[str, Sequence[float]],
    time: Callable[[WingParameters], float] = uqfold_time,
) -> list[dict[str, Any]]:
    """One row per parameter set: both times (s), their difference, what exudyn's step changes."""
    rows = []
    for name, theirs in expected.items():
        ours = time(sets[name])
        rows.append(
            {
                "set": name,
                "uqfold (s)": ours,
                "exudyn (s)": theirs[-1],
                "difference (s)": ours - theirs[-1],
                "exudyn, change by its step (s)": theirs[0] - theirs[-1],
            }
        )
    return rows


def judge(rows: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """Compare the largest difference with the agreement asked for."""
    differences = np.abs([row["difference (s)"] for row in rows])
    changes = np.abs([row["exudyn, change by its step (s)"] for row in rows])
    return [
        Finding("parameter sets", len(rows)),
        Finding("largest difference", float(differences.max()), AGREEMENT, "s"),
        Finding("median difference", float(np.median(differences)), unit="s"),
        Finding("largest change when exudyn's step is halved", float(changes.max()), unit="s"),
    ]


def simulate(names: Sequence[str]) -> None:
    """Compute and store exudyn's times."""
    rows = []
    for name in names:
        times = exudyn_times(parameter_sets()[name])
        named = zip(STEPS, times, strict=True)
        rows.append({"set": name} | {f"step {h:g} s (s)": time for h, time in named})
        print(f"{name}: {', '.join(f'{time:.9f}' for time in times)} s", flush=True)
    write_rows(STORED, rows)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--simulate", action="store_true", help="compute exudyn's times anew")
    if parser.parse_args(arguments).simulate:
        simulate(SETS)
    rows = compare(parameter_sets(), stored_times())
    write_rows(HERE / "against_exudyn.csv", rows)
    return report(CLAIM, judge(rows))


if __name__ == "__main__":
    sys.exit(main())
