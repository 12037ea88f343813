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
from typing import Any, Literal

HERE = Path(__file__).resolve().parent

Verdict = Literal["holds", "does not hold", "cannot be judged"]


@dataclass(frozen=True)
class Claim:
    """What a script claims, what it is compared with, and how close is close enough and why."""

    name: str
    statement: str
    compared_with: str
    tolerance: str
    command: str


@dataclass(frozen=True)
class Finding:
    """One measured number with the limit that it has to keep; without a limit it is for reading.

    `limit` is an upper bound, or a lower one where `at_least` is set. A finding that something
    outside us states but that nobody can check has no value and no limit, only a remark.
    """

    what: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    at_least: bool = False
    remark: str = ""

    @property
    def verdict(self) -> Verdict | None:
        """Verdict of this number alone; None where it is only quoted."""
        if self.value is None:
            return "cannot be judged"
        if self.limit is None:
            return None
        # a NaN must not pass
        kept = self.value >= self.limit if self.at_least else self.value <= self.limit
        return "holds" if kept else "does not hold"


def verdict_of(findings: Sequence[Finding]) -> Verdict:
    """Verdict of a claim: one broken limit breaks it; where nothing was judged, nothing holds."""
    verdicts = {finding.verdict for finding in findings}
    if "does not hold" in verdicts:
        return "does not hold"
    return "holds" if "holds" in verdicts else "cannot be judged"


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
        print(f"  {as_words(asdict(finding) | {'verdict': finding.verdict})}")
    return 1 if verdict == "does not hold" else 0


def as_words(finding: Mapping[str, Any]) -> str:
    """One line for a finding as read from, or written to, a JSON file."""
    words = [finding["what"]]
    if finding["value"] is not None:
        words[0] += f": {number(finding['value'])}{_unit(finding)}"
    if finding["limit"] is not None:
        bound = "at least" if finding["at_least"] else "at most"
        words.append(f"({bound} {number(finding['limit'])}{_unit(finding)})")
    if finding["verdict"] not in (None, "holds"):
        words.append(f"- {finding['verdict']}")
    if finding["remark"]:
        words.append(f"- {finding['remark']}")
    return " ".join(words)


def number(value: float) -> str:
    """Three significant digits, without a decimal tail for whole numbers."""
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e5 else f"{value:.3g}"


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


def _unit(finding: Mapping[str, Any]) -> str:
    return f" {finding['unit']}" if finding["unit"] else ""


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else str(value)
    return value


def _text(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float) else str(value)
