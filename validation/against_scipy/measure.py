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

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.independent import deployment_time
from validation.mechanism.parameter_sets import parameter_sets
from validation.mechanism.stored_times import expected_times, late_onset

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


def shifted(wing: WingParameters, shifts: Sequence[int]) -> list[float]:
    """Clearances changed by some millionths (m)."""
    return [wing.C_r * (1.0 + 1e-6 * shift) for shift in shifts]


def uqfold_times(wing: WingParameters) -> list[float]:
    """Deployment times (s) by uqfold, one per shift."""
    return deployment_times(wing, C_r=shifted(wing, SHIFTS), tolerance=TOLERANCE).tolist()


def scipy_times(wing: WingParameters) -> list[float]:
    """Deployment times (s) by SciPy, the first without a shift."""
    repeats = spread(uqfold_times(wing)) > NEARLY_CHAOTIC
    shifts = SCIPY_SHIFTS if repeats else SCIPY_SHIFTS[:1]
    return [float(deployment_time(wing.replace(C_r=C_r))) for C_r in shifted(wing, shifts)]


def spread(times: Sequence[float]) -> float:
    """Return the largest minus the smallest."""
    return max(times) - min(times)


def stored_times() -> dict[str, list[float]]:
    """SciPy's times per parameter set, as stored; the first belongs to the set itself."""
    rows = pd.read_csv(STORED)
    return {str(name): own.tolist() for name, own in rows.groupby("set", sort=False)["time (s)"]}


def measure(work: Work) -> Measurement:
    """Compare every sixth set, all sets, or all sets with SciPy's times computed anew."""
    sets = dict([*parameter_sets().items()][:: work.pick(6, 1)])
    computations = {name: partial(scipy_times, wing) for name, wing in sets.items()}
    expected, stored = expected_times(
        work, computations, stored_times(),
        "largest change of SciPy's times since they were stored", 0, AGREEMENT,
    )  # fmt: skip
    found = []
    for name, wing in sets.items():
        ours = uqfold_times(late_onset(wing) if work.fault == "late onset" else wing)
        found.append(
            {
                "set": name,
                "uqfold (s)": ours[SHIFTS.index(0)],
                "scipy (s)": expected[name][0],
                "uqfold spread (s)": spread(ours),
                "scipy spread (s)": spread(expected[name]),
            }
        )
    rows = pd.DataFrame(found)
    spreads = rows[["uqfold spread (s)", "scipy spread (s)"]]
    rows["difference (s)"] = rows["uqfold (s)"] - rows["scipy (s)"]
    rows["chaotic"] = spreads.max(axis=1) > AGREEMENT
    differences, chaotic = rows["difference (s)"].abs(), rows["chaotic"]
    findings = [
        Finding("parameter sets", len(rows)),
        Finding("largest difference, not chaotic", differences[~chaotic].max(), AGREEMENT, "s"),
        Finding("median difference, not chaotic", differences[~chaotic].median(), unit="s"),
        Finding("chaotic sets", chaotic.sum()),
    ]
    if chaotic.any():
        widest, share = spreads[chaotic].max(axis=None), differences / spreads.sum(axis=1)
        findings += [
            Finding("largest spread of a chaotic set", widest, unit="s"),
            Finding("largest difference over both spreads, chaotic", share[chaotic].max(), 1.0),
        ]
    table = Table.of("Deployment times by uqfold and by SciPy", rows)
    return Measurement([*findings, *stored], [table])


if __name__ == "__main__":
    pd.DataFrame(
        {"set": name, "shift (1e-6 C_r)": shift, "time (s)": time}
        for name, wing in parameter_sets().items()
        for shift, time in zip(SCIPY_SHIFTS, scipy_times(wing), strict=False)
    ).to_csv(STORED, index=False, lineterminator="\n")
