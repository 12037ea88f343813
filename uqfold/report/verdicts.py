"""Verdicts of validation cases in words, for pages and the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from uqfold.plots.wording import seconds_text
from uqfold.validation.findings import Verdict
from uqfold.validation.kept import Changes
from uqfold.validation.record import CaseRecord

VERDICT_STYLES: dict[Verdict, str] = {
    "holds": "green",
    "does not hold": "bold red",
    "cannot be judged": "yellow",
}
"""Verdict -> style on a terminal."""


def print_verdicts(console: Console, records: Sequence[CaseRecord]) -> None:
    """Print the verdict of every case, and why one does not hold."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in ("topic", "case", "verdict"):
        table.add_column(name, no_wrap=True)
    for name in ("judged", "time"):
        table.add_column(name, justify="right", no_wrap=True)
    for record in records:
        table.add_row(
            Text(record.case.topic, "dim"),
            record.name,
            Text(record.verdict, VERDICT_STYLES[record.verdict]),
            limits_text(record),
            seconds_text(record.seconds),
        )
    console.print(table)
    console.print(Text(f"\n{counts_text(records)}"))
    for record in records:
        said = reasons(record)
        if said:
            style = VERDICT_STYLES[record.verdict]
            console.print(Text(f"\n{record.name}: {record.verdict}", style))
            console.print(Padding(Text(record.case.claim), (0, 0, 0, 2)))
        for text in said:
            console.print(Padding(Text(f"- {text}"), (0, 0, 0, 2)))


def limits_text(record: CaseRecord) -> str:
    """Return how many of the limits that were judged are kept."""
    judged = [one.verdict for one in record.findings if one.verdict is not None]
    return f"{judged.count('holds')} of {len(judged)}"


def faults_text(records: Sequence[CaseRecord]) -> str:
    """Return how many of the planted faults were noticed."""
    planted = [one.caught for record in records for one in record.faults if one.caught is not None]
    return f"{sum(planted)} of {len(planted)}" if planted else "not planted"


def kept_text(changes: Sequence[Changes]) -> str:
    """Return whether the verdicts are the kept ones, in words."""
    broken = sum(bool(one.broken) for one in changes)
    changed = sum(bool(one.verdicts) and not one.broken for one in changes)
    same = len(changes) - broken - changed
    if same == len(changes):
        return "every verdict is the kept one"
    words = [f"{same} of {len(changes)} cases have the kept verdicts"]
    words += [f"{changed} changed"] if changed else []
    words += [f"{broken} broke"] if broken else []
    return ", ".join(words)


def counted(number: int, thing: str) -> str:
    """Return a number of things, for instance ``1 case`` or ``2 cases``."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def counts_text(records: Sequence[CaseRecord]) -> str:
    """Return the number of cases by verdict, and of planted faults that were noticed."""
    text = f"{counted(len(records), 'case')}: {_listed([record.verdict for record in records])}"
    for record in records:
        if record.claims:
            of_claims = _listed(list(record.claims.values()))
            text += f"; {counted(len(record.claims), 'claim')} of {record.name}: {of_claims}"
    noticed = faults_text(records)
    return text if noticed == "not planted" else f"{text}; {noticed} planted faults noticed"


def reasons(record: CaseRecord) -> list[str]:
    """Return why a case does not hold, or cannot be judged."""
    said = [record.error] if record.error else []
    if record.verdict != "holds":
        said += [one.words for one in record.findings if one.verdict == record.verdict]
    return said + [
        f"the planted fault {one.fault.name!r} went unnoticed" for one in record.missed_faults
    ]


def _listed(verdicts: Sequence[Verdict]) -> str:
    counts = Counter(verdicts)
    return ", ".join(f"{counts[one]} {one}" for one in VERDICT_STYLES if counts[one])
