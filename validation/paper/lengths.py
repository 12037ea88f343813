"""Claims on random lengths (Example 6): the closing gap between missions, and the range of T.

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

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.validation import Finding
from validation.paper.claims import (
    Results,
    at_largest_threshold,
    claim,
    fixed_missions,
    spread,
    table_of,
    wide,
)

STABLE_FROM = 0.47
"""T (s) from which the text calls the curves stable."""
EXAMPLE_3 = 0.57
"""T (s) from which tau governs in Example 3, as the text says."""
STABLE = 0.001
"""Distance of R from its plateau below which a curve is stable."""
CLOSE = 0.02
"""Distance of T (s) that still counts as the one in the text."""

LAWS = ("lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier")
VELOCITIES = ("geometric", "material")
ANGLES = (-5, -3, -2, -1, 0, 1, 2, 5, 10, 20, 30, 40)
"""Initial angles (degrees)."""
LOCKS = tuple(round(0.1 * i, 1) for i in range(3, 28))
"""Lock positions (m)."""
MEANS = {"V_q": (140.0, 200.0), "k_d": (550.0, 1100.0), "b": (7e-3, 6e-3)}
"""Means of Tables 6 and 10; both have delta = 0 and C_r = 1.5 mm."""


@claim(
    "closing gap",
    "In Example 6 the final difference between two numbers of missions shrinks as tau grows.",
    "Section 4.6, Fig. 18(b)",
    "at the largest T the difference of R between m = 2 and m = 5 never grows with tau",
)
def closing_gap(results: Results) -> Iterator[Finding]:
    """Yield how the final difference between two numbers of missions changes with tau."""
    frame = fixed_missions(table_of(results, "example-6", "sync"))
    gaps = spread(at_largest_threshold(frame), "missions", "tau")
    yield Finding(
        "largest widening of the final difference between m = 2 and m = 5 as tau grows",
        float(gaps.diff().max()),
        0.0,
        remark=", ".join(f"{gap:.3g} at tau = {tau:g} s" for tau, gap in gaps.items()),
    )


@claim(
    "range of T",
    "In Example 6 the curves stay stable when T is greater than 0.47 s.",
    "Section 4.6, Fig. 18(b)",
    f"by the letter: R stays within {STABLE:g} of its plateau from {STABLE_FROM:g} s or earlier on",
)
def stable_beyond(results: Results) -> Iterator[Finding]:
    """Yield the T from which the curves are stable: what the text says by the letter."""
    found = round(_stable_from(results), 6)
    yield Finding("T from which the curves are stable", found, STABLE_FROM, "s")


@claim(
    "range of T, onset",
    "In Example 6 it is about T = 0.47 s that the curves become stable (a stricter reading, ours).",
    "Section 4.6, Fig. 18(b)",
    f"R stays within {STABLE:g} of its plateau from a T within {CLOSE:g} s of {STABLE_FROM:g} s",
)
def onset(results: Results) -> Iterator[Finding]:
    """Yield where the curves become stable, and what was tried to mend it."""
    found = _stable_from(results)
    yield Finding(
        f"distance from T = {STABLE_FROM:g} s of the T at which the curves become stable",
        abs(found - STABLE_FROM),
        CLOSE,
        "s",
        remark=f"here they are stable from T = {found:g} s",
    )
    frame = table_of(results, "example-6", "lock-scan")
    times = frame.pivot(index=["theta_1_initial", "x_lock"], columns="problem", values="time")
    finite = times[np.isfinite(times).all(axis=1)]
    ratios = finite["wing"] / finite["example-3"]
    yield Finding(
        "largest ratio of the deployment times at the means of Tables 10 and 6",
        float(ratios.max()),
        remark=f"over {len(ratios)} initial poses and lock positions, which the text leaves "
        f"open; smallest {ratios.min():.3g}; the text's marks, {STABLE_FROM:g} s against "
        f"{EXAMPLE_3:g} s in Example 3, have the ratio {STABLE_FROM / EXAMPLE_3:.2g}",
    )
    rows = scanned()
    wings = sum(row["wings"] for row in rows)
    smallest = min(row["smallest ratio"] for row in rows)
    yield Finding(
        "largest ratio of the deployment times of Tables 10 and 6, with clearances",
        max(row["largest ratio"] for row in rows),
        remark=f"over {wings:,} wings: {len(LAWS)} contact laws, both tangential velocities, "
        f"initial angles from {ANGLES[0]} to {ANGLES[-1]} degrees, locks from {LOCKS[0]:g} to "
        f"{LOCKS[-1]:g} m; smallest {smallest:.2g}; nothing else was scanned",
    )


def _stable_from(results: Results) -> float:
    """Return the T from which on R stays near its plateau."""
    frame = fixed_missions(table_of(results, "example-6", "sync"))
    curves = 1.0 - wide(frame, "threshold")
    away = (curves.sub(curves.iloc[:, -1], axis=0)).abs().max()
    last_away = away.index[away > STABLE].max()
    return float(min((T for T in away.index if last_away < T), default=math.inf))


@cache
def scanned() -> list[dict[str, object]]:
    """Return, by contact law and velocity, times and their ratio over all angles and locks."""
    return [_scan(law, velocity) for law, velocity in product(LAWS, VELOCITIES)]


def _scan(law: str, velocity: str) -> dict[str, object]:
    times = []
    for angle, lock in product(ANGLES, LOCKS):
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
        both = {name: np.array(means) for name, means in MEANS.items()}
        times.append(deployment_times(wing, **both))
    found = np.array(times)
    found = found[np.isfinite(found).all(axis=1)]
    ratio = found[:, 1] / found[:, 0]
    studied = (found[:, 0] > 0.50) & (found[:, 0] < 0.57)
    return {
        "contact law": law,
        "tangential velocity": velocity,
        "wings": len(found),
        "smallest ratio": float(ratio.min()),
        "largest ratio": float(ratio.max()),
        "longest time of Table 10 where that of Table 6 is 0.50 to 0.57 s (s)": float(
            found[studied, 1].max()
        ),
    }
