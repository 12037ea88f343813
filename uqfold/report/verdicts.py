"""Verdicts of validation cases on the terminal: one line per case, then what does not hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from uqfold.plots.wording import seconds_text
from uqfold.validation.changes import Changes
from uqfold.validation.record import CaseRecord

VERDICT_STYLES = {
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
        judged = [finding for finding in record.judged if finding.verdict is not None]
        kept = sum(finding.verdict == "holds" for finding in judged)
        table.add_row(
            Text(record.case.topic, "dim"),
            record.name,
            Text(record.verdict, VERDICT_STYLES[record.verdict]),
            f"{kept} of {len(judged)}",
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


def counts_text(records: Sequence[CaseRecord]) -> str:
    """Return the number of cases by verdict, and of planted faults that were caught."""
    counts: Counter[str] = Counter(record.verdict for record in records)
    words = [f"{counts[verdict]} {verdict}" for verdict in VERDICT_STYLES if counts[verdict]]
    text = f"{len(records)} cases: {', '.join(words)}"
    for record in records:
        if record.claims:
            of_claims = Counter(record.claims.values())
            listed = ", ".join(f"{count} {verdict}" for verdict, count in of_claims.items())
            text += f"; {len(record.claims)} claims of {record.name}: {listed}"
    planted = [one for record in records for one in record.faults if one.caught is not None]
    if planted:
        caught = sum(one.caught is True for one in planted)
        text += f"; {caught} of {len(planted)} planted faults caught"
    return text


def stale_text(records: Sequence[CaseRecord]) -> str:
    """Return which cases quote a full record of other code; empty if none does."""
    stale = [one.name for one in records if one.stored is not None and not one.stored.current]
    if not stale:
        return ""
    quoted = f"{len(stale)} of {len(records)} cases quote a full record measured with other code"
    return f"{quoted} ({', '.join(stale)}): uqfold validate --full --stale --update"


def reasons(record: CaseRecord) -> list[str]:
    """Return why a case does not hold, or cannot be judged."""
    said = [record.error] if record.error else []
    if record.verdict != "holds" and not record.error:
        stored = record.stored
        of_full = len(stored.findings) if stored is not None and stored.current else 0
        own = len(record.judged) - of_full
        for i, one in enumerate(record.judged):
            if one.verdict == record.verdict:
                full = f"full tier, {stored.date[:10]}: " if stored is not None and i >= own else ""
                said.append(f"{full}{one.words}")
    said += [f"the planted fault {one.fault.name!r} went unnoticed" for one in record.missed_faults]
    return said
