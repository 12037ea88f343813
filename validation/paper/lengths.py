"""Random lengths (Example 6): the range of T, and what was scanned to mend it.

The wing of Table 10 locks in about two thirds of the time of that of Table 6, but the marks that
the text names for both have the ratio 0.82. The study scans initial angle and lock position with
ideal joints; `scanned` gives wings their clearances, and varies contact law and tangential velocity
too. Nothing else was tried: not the drive's profile, the masses, or the aerodynamic coefficients.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from itertools import product

import numpy as np
import pandas as pd

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding
from validation.paper.results import Results, fixed_missions, wide

EXAMPLE_3 = 0.57
"""T (s) from which tau governs in Example 3, as the text says."""
LAWS = ("lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier")
VELOCITIES = ("geometric", "material")
ANGLES = (-5, -3, -2, -1, 0, 1, 2, 5, 10, 20, 30, 40)
"""Initial angles (degrees)."""
LOCKS = tuple(round(0.1 * i, 1) for i in range(3, 28))
"""Lock positions (m)."""
MEANS = {"V_q": (140.0, 200.0), "k_d": (550.0, 1100.0), "b": (7e-3, 6e-3)}
"""Means of Tables 6 and 10; both have delta = 0 and C_r = 1.5 mm."""


def stable_beyond(results: Results, mark: float, stable: float) -> Iterator[Finding]:
    """Yield the T from which the curves are stable: what the text says by the letter."""
    found = _stable_from(results, stable)
    yield Finding("T from which the curves are stable", found, mark, "s")


def onset(results: Results, mark: float, stable: float, close: float) -> Iterator[Finding]:
    """Yield where the curves become stable, and what was tried to mend it."""
    found = _stable_from(results, stable)
    yield Finding(
        f"distance from T = {mark:g} s of the T at which the curves become stable",
        abs(found - mark),
        close,
        "s",
        remark=f"here they are stable from T = {found:g} s",
    )
    times = results["example-6/lock-scan"].pivot(
        index=["theta_1_initial", "x_lock"], columns="problem", values="time"
    )
    finite = times[np.isfinite(times).all(axis=1)]
    ratios = finite["wing"] / finite["example-3"]
    yield Finding(
        "largest ratio of the deployment times at the means of Tables 10 and 6",
        float(ratios.max()),
        remark=f"over {len(ratios)} initial poses and lock positions, which the text leaves "
        f"open; smallest {ratios.min():.3g}; the text's marks, {mark:g} s against "
        f"{EXAMPLE_3:g} s in Example 3, have the ratio {mark / EXAMPLE_3:.2g}",
    )
    rows = scanned()
    yield Finding(
        "largest ratio of the deployment times of Tables 10 and 6, with clearances",
        float(rows["largest ratio"].max()),
        remark=f"over {rows['wings'].sum():,} wings: {len(LAWS)} contact laws, both tangential "
        f"velocities, initial angles from {ANGLES[0]} to {ANGLES[-1]} degrees, locks from "
        f"{LOCKS[0]:g} to {LOCKS[-1]:g} m; smallest {rows['smallest ratio'].min():.2g}; nothing "
        "else was scanned",
    )


def _stable_from(results: Results, stable: float) -> float:
    """Return the T from which on R stays near its plateau, inf if it never does."""
    curves = wide(fixed_missions(results["example-6/sync"]), "threshold")
    away = curves.sub(curves.iloc[:, -1], axis=0).abs().max() > stable
    later = away.index[away.index > away.index[away].max()]
    return round(float(later.min()), 6)


@cache
def scanned() -> pd.DataFrame:
    """Return, by contact law and velocity, times and their ratio over all angles and locks."""
    means = {name: np.array(pair) for name, pair in MEANS.items()}
    found = []
    for law, velocity, angle, lock in product(LAWS, VELOCITIES, ANGLES, LOCKS):
        try:
            wing = WingParameters(
                contact_law=law,
                tangential_velocity=velocity,
                theta_1_initial=math.radians(angle),
                x_lock=lock,
                C_r=1.5e-3,
            )
        except ValueError:
            # no such wing: the slider starts ahead of its lock, or the arms are too short
            continue
        found.append((law, velocity, *deployment_times(wing, **means)))
    wings = pd.DataFrame(found, columns=["contact law", "tangential velocity", "six", "ten"])
    wings = wings[np.isfinite(wings[["six", "ten"]]).all(axis=1)]
    studied = wings["six"].between(0.50, 0.57, inclusive="neither")
    wings = wings.assign(ratio=wings["ten"] / wings["six"], studied=wings["ten"].where(studied))
    by_law = wings.groupby(["contact law", "tangential velocity"], sort=False)
    longest = "longest time of Table 10 where that of Table 6 is 0.50 to 0.57 s (s)"
    columns = {
        "wings": ("ratio", "size"),
        "smallest ratio": ("ratio", "min"),
        "largest ratio": ("ratio", "max"),
        longest: ("studied", "max"),
    }
    return by_law.agg(**columns).reset_index()
