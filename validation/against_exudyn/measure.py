"""Deployment times against exudyn, a general multibody code, on the same mechanism.

Exudyn calls a Python function for the contact forces several times per step, so a few wings have to
do: the means of Tables 1, 6 and 10 with both tangential velocities, a mean of Table 8, and corners
of Tables 6 and 10 at the slow and the fast end. Each runs with two steps, whose difference shows
what exudyn's steps are worth.

The times by exudyn are stored; the full tier computes them anew.

    python -m validation.against_exudyn.measure    writes the stored times anew (6 minutes)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.against_scipy.measure import TOLERANCE
from validation.mechanism.parameter_sets import parameter_sets
from validation.mechanism.stored_times import expected_times, late_onset

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
STORED = Path(__file__).with_name("exudyn_times.csv")


def uqfold_time(wing: WingParameters, fault: str | None = None) -> float:
    """Deployment time (s) by uqfold."""
    moved = late_onset(wing) if fault == "late onset" else wing
    return float(deployment_times(moved, tolerance=TOLERANCE)[0])


def exudyn_times(wing: WingParameters, steps: Sequence[float] = STEPS) -> list[float]:
    """Deployment times (s) by exudyn, one per step."""
    from validation.mechanism.exudyn_wing import ExudynWing

    return [ExudynWing(wing).deploy(h, wing.t_max) for h in steps]


def stored_times() -> dict[str, list[float]]:
    """Exudyn's times per parameter set, as stored, for both steps."""
    rows = pd.read_csv(STORED, index_col="set")
    return dict(zip(rows.index, rows.to_numpy().tolist(), strict=True))


def measure(work: Work) -> Measurement:
    """Compare with stored times; in the full tier with times that exudyn computes now."""
    sets = parameter_sets()
    computations = {name: partial(exudyn_times, sets[name]) for name in SETS}
    expected, findings = expected_times(
        work, computations, stored_times(),
        "largest change of exudyn's times since they were stored", -1, AGREEMENT,
    )  # fmt: skip
    rows = pd.DataFrame(
        {
            "set": name,
            "uqfold (s)": uqfold_time(sets[name], work.fault),
            "exudyn (s)": fine,
            "exudyn, change by its step (s)": coarse - fine,
        }
        for name, (coarse, fine) in expected.items()
    )
    rows["difference (s)"] = rows["uqfold (s)"] - rows["exudyn (s)"]
    differences = rows["difference (s)"].abs()
    changes = rows["exudyn, change by its step (s)"].abs()
    findings = [
        Finding("parameter sets", len(rows)),
        Finding("largest difference", differences.max(), AGREEMENT, "s"),
        Finding("median difference", differences.median(), unit="s"),
        Finding("largest change when exudyn's step is halved", changes.max(), unit="s"),
        *findings,
    ]
    return Measurement(findings, [Table.of("Deployment times by uqfold and by exudyn", rows)])


if __name__ == "__main__":
    times = {name: exudyn_times(parameter_sets()[name]) for name in SETS}
    named = pd.DataFrame.from_dict(times, "index", columns=[f"step {h:g} s (s)" for h in STEPS])
    named.to_csv(STORED, index_label="set", lineterminator="\n")
