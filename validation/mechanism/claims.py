"""A claim about the mechanism, what was measured for it, and the verdict.

Each script of this folder states one claim and writes `<script>.json` beside itself (claim,
verdict and measurements) and a CSV file with the rows behind it. `results_table.py` turns the JSON
files into the table of docs/mechanism.md.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from uqfold.comparison.findings import Finding, verdict_of

__all__ = ["HERE", "Claim", "Finding", "read_rows", "report", "verdict_of", "write_rows"]

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Claim:
    """What a script claims, what it is compared with, and how close is close enough and why."""

    name: str
    statement: str
    compared_with: str
    tolerance: str
    command: str


def report(claim: Claim, findings: Sequence[Finding], folder: Path = HERE) -> int:
    """Write `<name>.json`, print it for people, and give the exit code: 1 for a broken claim."""
    verdict = verdict_of(findings)
    rows = [
        {key: _plain(value) for key, value in asdict(finding).items()}
        | {"verdict": finding.verdict}
        for finding in findings
    ]
    content = asdict(claim) | {"verdict": verdict, "findings": rows}
    path = folder / f"{claim.name}.json"
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{claim.name}: {verdict}\n  {claim.statement}")
    for finding in findings:
        print(f"  {finding.words}")
    return 1 if verdict == "does not hold" else 0


def write_rows(path: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Write rows with the same keys as CSV."""
    rows = list(rows)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: _text(value) for key, value in row.items()} for row in rows)


def read_rows(path: Path) -> list[dict[str, str]]:
    """Read the rows of a CSV file as text."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else str(value)
    return value


def _text(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float) else str(value)
