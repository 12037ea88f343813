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
            "verdict": one.verdict_words,
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


def _off(table: pd.DataFrame) -> pd.DataFrame:
    """Let the methods' failure probabilities lie 0.03 further from the references."""
    if "reference_pf" not in table:
        return table
    known = table["reference_pf"].notna() & (table["pf"] < 0.9)
    pf = table["pf"].where(~known, np.maximum(table["pf"], table["reference_pf"]) + 0.03)
    return _consistent(table.assign(pf=pf, error=(pf / table["reference_pf"] - 1.0).abs()))


def _with_troughs(table: pd.DataFrame) -> pd.DataFrame:
    """Let the larger deviation start 0.002 higher at every number of missions and tau."""
    changed = table.copy()
    if not {"problem", "pf", "missions", "tau", "threshold"} <= set(changed):
        return changed
    curves = changed["missions"] + ", " + changed["tau"].fillna(-1.0).astype(str)
    for smaller, larger in SMALLER.values():
        own, other = changed["problem"] == smaller, changed["problem"] == larger
        # tables that compare both conditions in one row have no curve of their own to change
        both = set(curves[own].dropna()) & set(curves[other].dropna())
        for curve in sorted(both):
            here = curves == curve
            first = here & (changed["threshold"] == changed.loc[own & here, "threshold"].min())
            changed.loc[other & first, "pf"] = changed.loc[own & first, "pf"].iloc[0] - 0.002
    return _consistent(changed)


def _later(seconds: float) -> Callable[[Any], Any]:
    """Give a change that lets everything happen later."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        if "threshold" not in table:
            return table
        return table.assign(threshold=table["threshold"] + seconds)

    return change


FAULTS: dict[str, Callable[[Any], Any]] = {
    "upside down": _upside_down,
    "conditions swapped": _reversed("problem"),
    "tau swapped": _reversed("tau"),
    "off": _off,
    "troughs": _with_troughs,
    "later": _later(0.085),
    "much later": _later(0.2),
}
"""Name -> change of one table: contradictions, and remedies where a claim does not hold."""
