"""The table of results in docs/mechanism.md, made from the records of the mechanism's cases.

python -m validation.mechanism.results_table            writes the table into the page
python -m validation.mechanism.results_table --check    exit code 1 if the page has another one
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from uqfold.evidence import CaseRecord, read_case_record

CASES = Path(__file__).resolve().parents[1]
PAGE = CASES.parent / "docs" / "mechanism.md"
BEGIN = "<!-- made by: python -m validation.mechanism.results_table -->"
END = "<!-- end of the table -->"
TOPIC = "mechanism"


def results() -> list[CaseRecord]:
    """Records of the topic, of the full tier where one is kept, in order of their names."""
    kept = {path.parent.name: path for path in sorted(CASES.glob("*/quick.json"))}
    kept |= {path.parent.name: path for path in sorted(CASES.glob("*/full.json"))}
    records = [read_case_record(kept[name]) for name in sorted(kept)]
    return [record for record in records if record.topic == TOPIC]


def table(records: Sequence[CaseRecord]) -> str:
    """Give the cases as a Markdown table."""
    lines = ["| claim | compared with | tolerance, and why | measured | verdict |"]
    lines.append("| --- | --- | --- | --- | --- |")
    for record in records:
        cells = [
            f"**{record.name}**: {record.claim}",
            record.compared_with,
            record.tolerance,
            "<br>".join(finding.words for finding in record.findings),
            f"{record.verdict} ({record.tier} tier, {record.date[:10]})",
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
    records = results()
    new = page_with(old, table(records))
    if check:
        print(f"{PAGE.name}: {'as made' if old == new else 'another table than the records give'}")
        return int(old != new)
    PAGE.write_text(new, encoding="utf-8")
    print(f"{PAGE.name}: {len(records)} cases")
    return 0


if __name__ == "__main__":
    sys.exit(main())
