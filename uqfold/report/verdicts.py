"""Verdicts of validation cases in words, for pages and the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import pandas as pd
from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from uqfold.plots.wording import seconds_text
from uqfold.report.page.cells import TONES, Cell
from uqfold.report.table import STYLES, joined, text_columns
from uqfold.validation.findings import Verdict
from uqfold.validation.record import CaseRecord

_PRINTED = ("topic", "case", "verdict", "limits kept", "time")


def cases_table(records: Sequence[CaseRecord]) -> pd.DataFrame:
    """Return one row of cells per case: what was judged, with which verdict."""
    return pd.DataFrame(
        {
            "case": record.name,
            "title": record.case.title,
            "topic": record.case.topic,
            "kind": record.case.kind,
            "verdict": record.verdict,
            "limits kept": limits_text([record]),
            "faults noticed": faults_text([record]),
            "tier": record.tier,
            "time": Cell(seconds_text(record.seconds), record.seconds),
            "date": record.date[:10],
        }
        for record in records
    )


def print_verdicts(console: Console, records: Sequence[CaseRecord]) -> None:
    """Print the verdict of every case, and why one does not hold."""
    for line in joined(text_columns(cases_table(records), _PRINTED)):
        console.print(line)
    said = f"{counted(len(records), 'case')}: {_listed(record.verdict for record in records)}"
    for record in records:
        if record.claims:
            of_claims = _listed(record.claims.values())
            said += f"; {counted(len(record.claims), 'claim')} of {record.name}: {of_claims}"
    console.print(Text(f"\n{said}; {faults_text(records)} planted faults noticed"))
    for record in records:
        said_why = reasons(record)
        if said_why:
            style = STYLES[TONES[record.verdict]]
            console.print(Text(f"\n{record.name}: {record.verdict}", style))
            console.print(Padding(Text(record.case.claim), (0, 0, 0, 2)))
        for text in said_why:
            console.print(Padding(Text(f"- {text}"), (0, 0, 0, 2)))


def limits_text(records: Sequence[CaseRecord]) -> str:
    """Return how many of the limits that were judged are kept."""
    judged = [one.verdict for record in records for one in record.findings if one.verdict]
    return f"{judged.count('holds')} of {len(judged)}"


def faults_text(records: Sequence[CaseRecord]) -> str:
    """Return how many of the faults that were planted were noticed."""
    planted = [one.caught for record in records for one in record.faults if one.caught is not None]
    return f"{sum(planted)} of {len(planted)}"


def counted(number: int, thing: str) -> str:
    """Return a number of things, for instance ``1 case`` or ``2 cases``."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def reasons(record: CaseRecord) -> list[str]:
    """Return why a case does not hold, or cannot be judged."""
    judged = [one.words for one in record.findings if one.verdict == record.verdict]
    return [*(judged if record.verdict != "holds" else []), *record.broken]


def _listed(verdicts: Iterable[Verdict]) -> str:
    counts = Counter[str](verdicts)
    return ", ".join(f"{counts[one]} {one}" for one in TONES if counts[one])
