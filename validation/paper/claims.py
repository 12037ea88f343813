"""The paper's claims, judged by the results of the studies, and contradictions to plant in these.

The results are those that lie beside the studies (``uqfold study run`` makes them again); nothing
is run here. What a claim needs of them, and how they judge it, stands in
``uqfold.comparison.claims``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.claims import CLAIMS, judged
from uqfold.comparison.claims.deviations import SMALLER
from uqfold.evidence import Measurement, Table
from uqfold.evidence.work import Work

if TYPE_CHECKING:
    import pandas as pd

STUDIES = Path(__file__).resolve().parents[2] / "studies"


TEXTS = ("problem", "label", "missions", "status", "message")
"""Columns that are texts, whatever they look like."""


@cache
def read_results(root: Path = STUDIES) -> dict[str, dict[str, pd.DataFrame]]:
    """Read study -> table -> rows from the CSV files of all studies."""
    import pandas as pd

    results: dict[str, dict[str, pd.DataFrame]] = {}
    for path in sorted(root.glob("*/results/*.csv")):
        rows = pd.read_csv(path, dtype=dict.fromkeys(TEXTS, str))
        results.setdefault(path.parent.parent.name, {})[path.stem] = rows
    return results


def measure_claims(work: Work, keys: Sequence[str]) -> Measurement:
    """Judge some claims; the tiers do not differ.

    Parameters
    ----------
    work
        The order; knows the contradictions and remedies of `FAULTS`.
    keys
        Keys of the claims.
    """
    results: Any = read_results()
    if work.fault is not None:
        change = FAULTS[work.fault]
        results = {
            study: {name: change(table) for name, table in tables.items()}
            for study, tables in results.items()
        }
    found = [judged(CLAIMS[key], results) for key in keys]
    findings = [
        replace(finding, what=f"{one.claim.key}: {finding.what}")
        for one in found
        for finding in one.findings
    ]
    rows = [
        {
            "claim": one.claim.statement,
            "where": one.claim.source,
            "rule": one.claim.rule,
            "verdict": one.verdict,
        }
        for one in found
    ]
    return Measurement.of(findings, [Table.of("claims", "The paper's claims one by one", rows)])


def _upside_down(table: pd.DataFrame) -> pd.DataFrame:
    """Take reliability for the failure probability."""
    changed = table.copy()
    for name in ("pf", "reference_pf"):
        if name in changed:
            changed[name] = 1.0 - changed[name]
    return _consistent(changed)


def _consistent(table: pd.DataFrame) -> pd.DataFrame:
    """Let the reliability follow a changed failure probability."""
    return table.assign(reliability=1.0 - table["pf"]) if "reliability" in table else table


def _reversed(column: str) -> Callable[[Any], Any]:
    """Give a change that hands the values of a column out in reverse order."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        if column not in table:
            return table
        values = table[column].dropna().unique()
        values = np.sort(values) if table[column].dtype.kind == "f" else values
        swapped = dict(zip(values, values[::-1], strict=True))
        return table.assign(**{column: table[column].map(swapped).fillna(table[column])})

    return change


def _exact(table: pd.DataFrame) -> pd.DataFrame:
    """Put the references in the place of the method's answers."""
    if "reference_pf" not in table:
        return table
    known = table["reference_pf"].notna()
    exact = table.assign(
        pf=table["reference_pf"].where(known, table["pf"]),
        error=table["error"].where(~known, 0.0),
    )
    return _consistent(exact)


def _with_troughs(table: pd.DataFrame) -> pd.DataFrame:
    """Let the smaller deviation start 0.002 lower at every number of missions."""
    changed = table.copy()
    if "problem" not in changed or "pf" not in changed:
        return changed
    for smaller, larger in SMALLER.values():
        own, other = changed["problem"] == smaller, changed["problem"] == larger
        for missions in changed.loc[own, "missions"].unique():
            of_m = changed["missions"] == missions
            started = changed[other & of_m & (changed["pf"] < 0.9975)]
            if started.empty:
                continue
            first = started["threshold"].min()
            here = changed["threshold"] == first
            pf = started.loc[started["threshold"] == first, "pf"].iloc[0] + 0.002
            changed.loc[own & of_m & here, "pf"] = pf
    return _consistent(changed)


def _later(table: pd.DataFrame) -> pd.DataFrame:
    """Let everything happen 0.085 s later."""
    return table.assign(threshold=table["threshold"] + 0.085) if "threshold" in table else table


FAULTS: dict[str, Callable[[Any], Any]] = {
    "upside down": _upside_down,
    "conditions swapped": _reversed("problem"),
    "tau swapped": _reversed("tau"),
    "exact": _exact,
    "troughs": _with_troughs,
    "later": _later,
}
"""Name -> change of one table: contradictions, and remedies where a claim does not hold."""
