"""Write ``docs/no_false_confidence.md`` from the record of the validation case of that name.

    python docs/no_false_confidence.py           # write it anew
    python docs/no_false_confidence.py --check   # exit 1 if the page is not the present one

The record is the full one where there is one, and the quick one otherwise; no model is run.
"""

import sys
from pathlib import Path

import pandas as pd

from uqfold.report import literal
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import typeset
from uqfold.validation.record import CaseRecord, read_case_record

ROOT = Path(__file__).resolve().parents[1]
CASE = ROOT / "validation" / "no_false_confidence"
PAGE = ROOT / "docs" / "no_false_confidence.md"


def kept() -> CaseRecord:
    """Return the record that the page tells."""
    full = CASE / "full.json"
    return read_case_record(full if full.exists() else CASE / "quick.json")


def written(record: CaseRecord) -> str:
    """Return the page of a record."""
    page = Page("No false confidence", literal(record.case.claim))
    page.text(f"That is the claim; the verdict on it: **{record.verdict}**.")
    page.text(
        f"Measured by `{record.made['command']}`; this page is made from its record by "
        "`python docs/no_false_confidence.py`. Errors are relative to the smaller of pf and "
        "reliability. A cell of the table of problems counts the answers called `converged`, of "
        "how many, and gives the largest error among them."
    )
    found = pd.DataFrame(
        {
            "finding": [one.what for one in record.findings],
            "measured": [typeset(one.measured) for one in record.findings],
            "limit": [typeset(one.bound) or "quoted only" for one in record.findings],
        }
    )
    page.table(found, "Findings")
    for table in record.measurement.tables:
        page.table(pd.DataFrame(list(table.rows), columns=list(table.columns)), table.title)
    return page.markdown()


def main(arguments: list[str]) -> int:
    """Write the page, or check it."""
    text = written(kept())
    if "--check" in arguments:
        return int(PAGE.read_text(encoding="utf-8") != text)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
