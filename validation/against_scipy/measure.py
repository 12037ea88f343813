"""Deployment times against SciPy with tight tolerances and events, on equations derived anew.

The equations of `independent.py` (virtual power in complex numbers, no kernel of uqfold) are
integrated by DOP853 with a restart wherever a contact begins or ends, for every wing of
`parameter_sets.py`. First impacts are chaotic: for some wings 1e-6 of the clearance moves the time
by more than the codes differ. So uqfold also runs with the clearance changed by up to ten
millionths either way, and so does SciPy, a few times, where that moves the time by more than
0.5e-6 s. The spread of these times says what agreement can mean for that wing.

The times by SciPy take minutes and are stored; the full tier integrates them anew.

    python -m validation.against_scipy.measure    writes the stored times anew
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.faulty import late_onset
from validation.mechanism.independent import deployment_time
from validation.mechanism.parameter_sets import parameter_sets
from validation.mechanism.stored_times import expected_times, read_rows, write_rows

TOLERANCE = 1e-12
"""Local error per step of uqfold (m)."""

AGREEMENT = 2e-6
"""Largest difference (s) where the motion is not chaotic; a larger spread is called chaotic."""

SHIFTS = range(-10, 11)
SCIPY_SHIFTS = (0, -1, 1, 2)
"""Changes of the clearance in millionths; SciPy, being slow, takes the last ones only for wings
that uqfold's times spread by more than `NEARLY_CHAOTIC` (s)."""

NEARLY_CHAOTIC = 0.5e-6

STORED = Path(__file__).with_name("scipy_times.csv")

Times = Callable[[WingParameters, Sequence[int]], list[float]]


def shifted(wing: WingParameters, shifts: Sequence[int]) -> list[float]:
    """Clearances changed by some millionths (m)."""
    return [wing.C_r * (1.0 + 1e-6 * shift) for shift in shifts]


def uqfold_times(wing: WingParameters, shifts: Sequence[int]) -> list[float]:
    """Deployment times (s) by uqfold."""
    times = deployment_times(wing, C_r=shifted(wing, shifts), tolerance=TOLERANCE)
    return [float(time) for time in times]


def spread(times: Sequence[float]) -> float:
    """Give the largest minus the smallest."""
    return max(times) - min(times)


def scipy_times(wing: WingParameters) -> list[float]:
    """Deployment times (s) by SciPy, the first without a shift."""
    repeats = spread(uqfold_times(wing, SHIFTS)) > NEARLY_CHAOTIC
    shifts = SCIPY_SHIFTS if repeats else SCIPY_SHIFTS[:1]
    return [float(deployment_time(wing.replace(C_r=C_r))) for C_r in shifted(wing, shifts)]


def stored_times() -> dict[str, list[float]]:
    """SciPy's times per parameter set, as stored; the first belongs to the set itself."""
    times: dict[str, list[float]] = {}
    for row in read_rows(STORED):
        times.setdefault(row["set"], []).append(float(row["time (s)"]))
    return times


def compare(
    sets: Mapping[str, WingParameters],
    expected: Mapping[str, Sequence[float]],
    times: Times = uqfold_times,
) -> list[dict[str, Any]]:
    """One row per parameter set: both times (s), their difference, both spreads."""
    rows = []
    for name, wing in sets.items():
        ours = times(wing, SHIFTS)
        time, theirs = ours[SHIFTS.index(0)], expected[name]
        chaotic = max(spread(ours), spread(theirs)) > AGREEMENT
        rows.append(
            {
                "set": name,
                "uqfold (s)": time,
                "scipy (s)": theirs[0],
                "difference (s)": time - theirs[0],
                "uqfold spread (s)": spread(ours),
                "scipy spread (s)": spread(theirs),
                "chaotic": "yes" if chaotic else "no",
            }
        )
    return rows


def judge(rows: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """Compare the differences with the agreement that the spreads allow."""
    regular = [row for row in rows if row["chaotic"] == "no"]
    chaotic = [row for row in rows if row["chaotic"] == "yes"]
    regular_worst = max((abs(row["difference (s)"]) for row in regular), default=math.nan)
    findings = [
        Finding("parameter sets", len(rows)),
        Finding("largest difference, not chaotic", regular_worst, AGREEMENT, "s"),
        Finding(
            "median difference, not chaotic",
            float(np.median([abs(row["difference (s)"]) for row in regular] or [math.nan])),
            unit="s",
        ),
        Finding("chaotic sets", len(chaotic)),
    ]
    if chaotic:
        widest = max(max(row["uqfold spread (s)"], row["scipy spread (s)"]) for row in chaotic)
        share = max(
            abs(row["difference (s)"]) / (row["uqfold spread (s)"] + row["scipy spread (s)"])
            for row in chaotic
        )
        findings += [
            Finding("largest spread of a chaotic set", widest, unit="s"),
            Finding("largest difference over both spreads, chaotic", share, 1.0),
        ]
    return findings


def store() -> None:
    """Compute and store SciPy's times of all parameter sets."""
    rows = []
    for name, wing in parameter_sets().items():
        times = scipy_times(wing)
        rows += [
            {"set": name, "shift (1e-6 C_r)": shift, "time (s)": time}
            for shift, time in zip(SCIPY_SHIFTS, times, strict=False)
        ]
        print(f"{name}: {times[0]:.9f} s", flush=True)
    write_rows(STORED, rows)


def _late_onset(wing: WingParameters, shifts: Sequence[int]) -> list[float]:
    return uqfold_times(late_onset(wing), shifts)


def measure(work: Work) -> Measurement:
    """Compare every sixth set, all sets, or all sets with SciPy's times computed anew."""
    sets = parameter_sets()
    if work.tier == "quick":
        sets = dict(list(sets.items())[::6])
    computations = {name: partial(scipy_times, wing) for name, wing in sets.items()}
    expected, findings = expected_times(
        work, computations, stored_times(), code="SciPy", which=0, agreement=AGREEMENT
    )
    rows = compare(sets, expected, _late_onset if work.fault == "late onset" else uqfold_times)
    table = Table.of("Deployment times by uqfold and by SciPy", rows)
    return Measurement([*judge(rows), *findings], [table])


if __name__ == "__main__":
    store()
