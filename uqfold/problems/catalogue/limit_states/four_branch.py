"""Series system of two curved and two plane branches around the origin.

With s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), again standard normals, failure is
|s| >= 3 + 0.2 t^2 or |t| >= 3.5. More on it in `uqfold.problems.four_branch`.
"""

from __future__ import annotations

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.problems.four_branch_system import FourBranchLimitState


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(t: float) -> float:
        return 1.0 if abs(t) >= 3.5 else 2.0 * normal_cdf(-(3.0 + 0.2 * t * t))

    return over_normal(given, -3.5, 3.5)


ENTRY = Entry(
    source="Katsuki S, Frangopol DM (1994), Hyperspace division method for structural reliability, "
    f"J. Eng. Mech. 120, 2405-2427; {WAARTS}: series system",
    kinds=("series", "design points"),
    limit_state=FourBranchLimitState(),
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00222279506619,
    error=6.7e-15,
    how="integral over t, of the tails of s",
    published={
        "otbenchmark": "0.2222795066194439887212863444e-2",
        "uqtestfuns, after Waarts (2000)": "2.185961e-3",
        "ERA-Software": "2.2e-3",
    },
)
