"""The table of results in docs/mechanism.md, made from the JSON files of the cases.

python validation/mechanism/results_table.py            writes the table into the page
python validation/mechanism/results_table.py --check    exit code 1 if the page has another one
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from claims import HERE

from uqfold.comparison.findings import Finding

PAGE = HERE.parents[1] / "docs" / "mechanism.md"
BEGIN = "<!-- made by: python validation/mechanism/results_table.py -->"
END = "<!-- end of the table -->"

CASES = (
    "against_scipy",
    "against_exudyn",
    "baumgarte_form",
    "ideal_partner",
    "accuracy",
    "convergence_order",
    "energy_audit",
    "limits",
    "slider_crank",
)


def results(folder: Path = HERE) -> list[dict[str, Any]]:
    """Results of all cases, in order."""
    return [json.loads((folder / f"{name}.json").read_text(encoding="utf-8")) for name in CASES]


def table(cases: Sequence[dict[str, Any]]) -> str:
    """Give the cases as a Markdown table."""
    lines = ["| claim | compared with | tolerance, and why | measured | verdict |"]
    lines.append("| --- | --- | --- | --- | --- |")
    for case in cases:
        value = [_finding(finding).words for finding in case["findings"]]
        name = f"**{case['name']}**"
        cells = [
            f"{name}: {case['statement']}",
            case["compared_with"],
            case["tolerance"],
            "<br>".join(value),
            case["verdict"],
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def page_with(text: str, rows: str) -> str:
    """Replace what stands between the marks."""
    head, _, rest = text.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not end:
        raise ValueError(f"{PAGE} has no table between {BEGIN!r} and {END!r}")
    return f"{head}{BEGIN}\n\n{rows}\n\n{END}{tail}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Write or check the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing, compare")
    check = parser.parse_args(arguments).check
    old = PAGE.read_text(encoding="utf-8")
    new = page_with(old, table(results()))
    if check:
        print(f"{PAGE}: {'as made' if old == new else 'another table than the results give'}")
        return int(old != new)
    PAGE.write_text(new, encoding="utf-8")
    print(f"{PAGE}: {len(CASES)} cases")
    return 0


def _finding(written: dict[str, Any]) -> Finding:
    """Read a finding; NaN and infinity come as text."""
    value = written["value"]
    fields = {name: written[name] for name in ("what", "limit", "unit", "at_least", "remark")}
    return Finding(value=None if value is None else float(value), **fields)


if __name__ == "__main__":
    sys.exit(main())
