"""The paper's claims, judged by the committed tables of the studies, and contradictions to plant.

No study is run here; `python studies/<name>/study.py` makes its tables again.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

from uqfold.validation import Measurement, Table, Work
from validation.paper import accuracy, deviations, lengths, means, orders
from validation.paper.claims import PaperClaim, Results

STUDIES = Path(__file__).resolve().parents[2] / "studies"
TEXTS = ("problem", "label", "missions", "status", "message")
"""Columns that are texts, whatever they look like."""

CLAIMS: dict[str, PaperClaim] = {
    one.said.key: one
    for room in (accuracy, orders, means, deviations, lengths)
    for one in vars(room).values()
    if isinstance(one, PaperClaim)
}
"""Every claim by its key, in the order of the paper."""

Change = Callable[[pd.DataFrame], pd.DataFrame]


@cache
def read_results(root: Path = STUDIES) -> dict[str, dict[str, pd.DataFrame]]:
    """Read study -> table -> rows from the CSV files of all studies."""
    results: dict[str, dict[str, pd.DataFrame]] = {}
    for path in sorted(root.glob("*/results/*.csv")):
        rows = pd.read_csv(path, dtype=dict.fromkeys(TEXTS, str))
        results.setdefault(path.parent.parent.name, {})[path.stem] = rows
    return results


def judge(results: Results) -> Measurement:
    """Judge all claims."""
    found = {key: one.findings(results) for key, one in CLAIMS.items()}
    title = "Deployment times over what the text leaves open in Example 6"
    return Measurement(
        [finding for findings in found.values() for finding in findings],
        [Table.of(title, lengths.scanned())],
        claims=[CLAIMS[key].claim(findings) for key, findings in found.items()],
    )


def measure(work: Work) -> Measurement:
    """Judge all claims; the tiers do not differ."""
    results = read_results()
    if work.fault is None:
        return judge(results)
    change = FAULTS[work.fault]
    return judge(
        {
            study: {name: change(table) for name, table in tables.items()}
            for study, tables in results.items()
        }
    )


def upside_down(table: pd.DataFrame) -> pd.DataFrame:
    """Take reliability for the failure probability."""
    flipped = {name: 1.0 - table[name] for name in ("pf", "reference_pf") if name in table}
    return _consistent(table.assign(**flipped))


def reversed_in(column: str) -> Change:
    """Hand the values of a column out in reverse order."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        if column not in table:
            return table
        values = table[column].dropna().unique()
        values = np.sort(values) if table[column].dtype.kind == "f" else values
        swapped = dict(zip(values, values[::-1], strict=True))
        return table.assign(**{column: table[column].map(swapped).fillna(table[column])})

    return change


def off(table: pd.DataFrame) -> pd.DataFrame:
    """Let the methods' failure probabilities lie 0.03 further from the references."""
    if "reference_pf" not in table:
        return table
    known = table["reference_pf"].notna() & (table["pf"] < 0.9)
    pf = table["pf"].where(~known, np.maximum(table["pf"], table["reference_pf"]) + 0.03)
    return _consistent(table.assign(pf=pf, error=(pf / table["reference_pf"] - 1.0).abs()))


def one_run_more(table: pd.DataFrame) -> pd.DataFrame:
    """Count one evaluation more."""
    return table.assign(n_evals=table["n_evals"] + 1) if "n_evals" in table else table


def paired_the_other_way(table: pd.DataFrame) -> pd.DataFrame:
    """Let differences of paired systems have the other sign, a hundred times as large."""
    if "difference" not in table:
        return table
    return table.assign(difference=-100.0 * table["difference"])


def with_troughs(table: pd.DataFrame) -> pd.DataFrame:
    """Let the larger deviation start 0.002 higher at every number of missions and tau."""
    if not {"problem", "pf", "missions", "tau", "threshold"} <= set(table):
        return table
    changed = table.copy()
    curves = changed["missions"] + ", " + changed["tau"].fillna(-1.0).astype(str)
    for smaller, larger in deviations.SMALLER.values():
        own, other = changed["problem"] == smaller, changed["problem"] == larger
        # tables that compare both conditions in one row have no curve of their own to change
        both = set(curves[own].dropna()) & set(curves[other].dropna())
        for curve in sorted(both):
            here = curves == curve
            first = here & (changed["threshold"] == changed.loc[own & here, "threshold"].min())
            changed.loc[other & first, "pf"] = changed.loc[own & first, "pf"].iloc[0] - 0.002
    return _consistent(changed)


def later(seconds: float) -> Change:
    """Let everything happen later."""
    return lambda table: (
        table.assign(threshold=table["threshold"] + seconds) if "threshold" in table else table
    )


def _consistent(table: pd.DataFrame) -> pd.DataFrame:
    """Let the reliability follow a changed failure probability."""
    return table.assign(reliability=1.0 - table["pf"]) if "reliability" in table else table


FAULTS: dict[str, Change] = {
    "upside down": upside_down,
    "conditions swapped": reversed_in("problem"),
    "tau swapped": reversed_in("tau"),
    "off": off,
    "one run more": one_run_more,
    "paired the other way": paired_the_other_way,
    "troughs": with_troughs,
    "later": later(0.085),
    "much later": later(0.2),
}
"""Name -> change of one table: contradictions, and remedies where a claim does not hold."""
