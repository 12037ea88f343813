"""Times that other codes take long to compute: CSV files, and what to compare with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from uqfold.validation import Finding, Work
from validation.mechanism.faulty import stale


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows with the same keys."""
    pd.DataFrame(rows).to_csv(path, index=False, lineterminator="\n")


def read_rows(path: Path) -> list[dict[str, str]]:
    """Read rows as text."""
    return pd.read_csv(path, dtype=str, keep_default_na=False).to_dict("records")


def expected_times(
    work: Work,
    computations: Mapping[str, Callable[[], list[float]]],
    stored: Mapping[str, list[float]],
    *,
    code: str,
    which: int,
    agreement: float,
) -> tuple[Mapping[str, list[float]], list[Finding]]:
    """Return the times to compare with: as stored, or in the full tier computed anew.

    Parameters
    ----------
    work
        The order; knows the fault ``stale reference``.
    computations
        Name of each wing -> what computes its times (s).
    stored
        The same times as stored.
    code
        Whose times they are.
    which
        Index of the one that is compared.
    agreement
        Largest change (s) since they were stored.
    """
    if work.fault == "stale reference":
        return stale(stored), []
    if work.tier != "full":
        return stored, []
    computed = work.parts(computations)
    changes = [abs(computed[name][which] - stored[name][which]) for name in computations]
    what = f"largest change of {code}'s times since they were stored"
    return computed, [Finding(what, max(changes), agreement, "s")]
