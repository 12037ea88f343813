"""Deployment times against other codes on the same mechanism and contact law.

* ``scipy``: equations derived anew by virtual power, no kernel of uqfold, integrated by DOP853 with
  a restart wherever a contact begins or ends; every wing of `parameter_sets.py`.
* ``multipliers``: the paper's own form, Eqs. (17) to (20), in nine coordinates with Baumgarte's
  terms, integrated in the same way.
* ``exudyn``: a general multibody code, whose steps are not cut at events. It calls a Python
  function for the contact forces several times per step, so a few wings have to do.

First impacts are chaotic: for some wings a millionth of the clearance moves the time by more than
the codes differ. So each code has several times for a wing, which differ in what should not matter:
uqfold and SciPy in millionths of the clearance, the multipliers in the stabilization coefficients,
exudyn in its step. The spread of these times says what agreement can mean for that wing.

The others' times take minutes and are stored; the full tier computes them anew.

    python -m validation.against_other_codes.measure    writes the stored times anew (20 minutes)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.baumgarte import Multibody
from validation.mechanism.independent import deployment_time, follow
from validation.mechanism.parameter_sets import parameter_sets

TOLERANCE = 1e-12
"""Local error per step of uqfold (m)."""
SHIFTS = range(-10, 11)
"""Changes of the clearance in millionths."""
NEARLY_CHAOTIC = 0.5e-6
"""Spread of uqfold's times (s) from which SciPy, being slow, takes more than one."""
COEFFICIENTS = ((50.0, 50.0), (0.0, 0.0), (5.0, 5.0), (500.0, 500.0), (20.0, 200.0))
"""alpha and beta (1/s)."""
STEPS = (4e-6, 8e-6)
"""Steps of exudyn (s)."""
FEW = (
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
STORED = Path(__file__).with_name("times.csv")


def uqfold_times(wing: WingParameters) -> list[float]:
    """Return deployment times (s) by uqfold, one per shift."""
    shifted = [wing.C_r * (1.0 + 1e-6 * shift) for shift in SHIFTS]
    return deployment_times(wing, C_r=shifted, tolerance=TOLERANCE).tolist()


def scipy_times(wing: WingParameters) -> list[float]:
    """Return times (s) by SciPy, more than one for wings that are nearly chaotic."""
    shifts = (0, -1, 1, 2) if spread(uqfold_times(wing)) > NEARLY_CHAOTIC else (0,)
    shifted = [wing.replace(C_r=wing.C_r * (1.0 + 1e-6 * shift)) for shift in shifts]
    return [float(deployment_time(one)) for one in shifted]


def multiplier_times(wing: WingParameters) -> list[float]:
    """Return times (s) by Lagrange multipliers, one per pair of coefficients."""
    return [follow(Multibody(wing, *pair))[2] for pair in COEFFICIENTS]


def exudyn_times(wing: WingParameters, steps: tuple[float, ...] = STEPS) -> list[float]:
    """Return times (s) by exudyn, one per step."""
    from validation.mechanism.exudyn_wing import ExudynWing

    return [ExudynWing(wing).deploy(h, wing.t_max) for h in steps]


class Code(NamedTuple):
    """Another code: its times for a wing, the largest difference (s), and the wings."""

    times: Callable[[WingParameters], list[float]]
    agreement: float
    wings: tuple[str, ...] = FEW


CODES = {
    "scipy": Code(scipy_times, 2e-6, tuple(parameter_sets())),
    "multipliers": Code(multiplier_times, 2e-6),
    "exudyn": Code(exudyn_times, 1e-5),
}


def spread(times: list[float]) -> float:
    """Return the largest minus the smallest."""
    return max(times) - min(times)


def stored_times(code: str) -> dict[str, list[float]]:
    """Return a code's times for each of its wings as stored; the first is compared."""
    rows = pd.read_csv(STORED)
    own = rows[rows["code"] == code].groupby("wing", sort=False)["time (s)"]
    return {str(wing): times.tolist() for wing, times in own}


def late_onset(wing: WingParameters) -> WingParameters:
    """Return the wing whose damping is that of an onset velocity 2 % too large, by Eq. (5)."""
    return wing.replace(C_e=math.sqrt(1.0 - (1.0 - wing.C_e**2) / 1.02))


def compare(name: str, work: Work) -> tuple[list[Finding], list[dict[str, Any]]]:
    """Compare uqfold with one code; return findings, and one row per wing."""
    code, wings, expected = CODES[name], parameter_sets(), stored_times(name)
    findings = []
    if work.fault == "stale reference":
        # of a model that has changed since: later by a ten-thousandth
        expected = {wing: [1.0001 * time for time in times] for wing, times in expected.items()}
    elif work.tier == "full":
        anew = work.parts({f"{name}, {one}": partial(code.times, wings[one]) for one in code.wings})
        before, expected = expected, dict(zip(code.wings, anew.values(), strict=True))
        change = max(abs(expected[wing][0] - before[wing][0]) for wing in code.wings)
        what = f"{name}: largest change since its times were stored"
        findings.append(Finding(what, change, code.agreement, "s"))
    found = []
    for wing in code.wings:
        ours = uqfold_times(late_onset(wings[wing]) if work.fault == "late onset" else wings[wing])
        found.append(
            {
                "code": name,
                "wing": wing,
                "uqfold (s)": ours[SHIFTS.index(0)],
                "other (s)": expected[wing][0],
                "uqfold spread (s)": spread(ours),
                "other spread (s)": spread(expected[wing]),
            }
        )
    rows = pd.DataFrame(found)
    rows["difference (s)"] = rows["uqfold (s)"] - rows["other (s)"]
    difference = rows["difference (s)"].abs()
    spreads = rows[["uqfold spread (s)", "other spread (s)"]]
    chaotic = spreads.max(axis=1) > code.agreement
    findings += [
        Finding(f"{name}: wings", len(rows)),
        Finding(f"{name}: largest difference, not chaotic", difference[~chaotic].max(),
                code.agreement, "s"),
        Finding(f"{name}: median difference, not chaotic", difference[~chaotic].median(), unit="s"),
        Finding(f"{name}: largest spread of its own times, not chaotic",
                spreads["other spread (s)"][~chaotic].max(), unit="s"),
        Finding(f"{name}: chaotic wings", chaotic.sum()),
    ]  # fmt: skip
    if chaotic.any():
        over = (difference / spreads.sum(axis=1))[chaotic].max()
        findings.append(Finding(f"{name}: largest difference over both spreads, chaotic", over, 1))
    return findings, rows.to_dict("records")


def measure(work: Work) -> Measurement:
    """Compare with stored times; in the full tier with times computed now."""
    compared = [compare(name, work) for name in CODES]
    findings = [finding for found, _ in compared for finding in found]
    rows = [row for _, of_code in compared for row in of_code]
    return Measurement(findings, [Table.of("Deployment times by uqfold and by other codes", rows)])


if __name__ == "__main__":
    pd.DataFrame(
        {"code": name, "wing": wing, "time (s)": time}
        for name, code in CODES.items()
        for wing in code.wings
        for time in code.times(parameter_sets()[wing])
    ).to_csv(STORED, index=False, lineterminator="\n")
