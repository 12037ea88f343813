"""Verdicts of validation cases on the terminal: one line per case, then what does not hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from uqfold.evidence.changes import Changes
from uqfold.evidence.record import CaseRecord
from uqfold.report.layout import Cell, Grid, hanging, line
from uqfold.report.wording import seconds_text

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

VERDICT_STYLES = {
    "holds": "green",
    "does not hold": "bold red",
    "cannot be judged": "yellow",
}
"""Verdict -> style on a terminal."""


@dataclass(frozen=True)
class VerdictTable:
    """Verdicts of some cases, ready for ``rich.console.Console.print``."""

    records: Sequence[CaseRecord]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """Render the table in the width of the console."""
        width = options.max_width
        grid = Grid(
            ("topic", "case", "verdict", "judged", "time"),
            [_cells(record) for record in self.records],
            numeric=(3, 4),
            gap=2,
        )
        yield grid.head_line()
        yield from grid.lines()
        yield line("")
        yield line(counts_text(self.records))
        for record in self.records:
            yield from _reasons(record, width)


def kept_text(changes: Sequence[Changes]) -> str:
    """Say whether the verdicts are the kept ones."""
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
    """Give the number of cases by verdict, and of planted faults that were caught."""
    counts: Counter[str] = Counter(record.verdict for record in records)
    words = [f"{counts[verdict]} {verdict}" for verdict in VERDICT_STYLES if counts[verdict]]
    planted = [fault for one in records for fault in one.faults if fault.caught is not None]
    text = f"{len(records)} cases: {', '.join(words)}"
    if planted:
        caught = sum(fault.caught is True for fault in planted)
        text += f"; {caught} of {len(planted)} planted faults caught"
    return text


def reasons(record: CaseRecord) -> list[str]:
    """Say why a case does not hold, or cannot be judged."""
    said = [record.error] if record.error else []
    if record.verdict != "holds" and not record.error:
        stored = record.stored
        of_full = len(stored.findings) if stored is not None and stored.current else 0
        own = len(record.judged) - of_full
        for i, one in enumerate(record.judged):
            if one.verdict == record.verdict:
                full = f"full tier, {stored.date[:10]}: " if stored is not None and i >= own else ""
                said.append(f"{full}{one.words}")
    said += [f"the planted fault {one.name!r} went unnoticed" for one in record.missed_faults]
    return said


def _cells(record: CaseRecord) -> list[Cell]:
    judged = [finding for finding in record.judged if finding.verdict is not None]
    kept = sum(finding.verdict == "holds" for finding in judged)
    return [
        Cell(record.topic, "dim"),
        Cell(record.name),
        Cell(record.verdict, VERDICT_STYLES[record.verdict]),
        Cell(f"{kept} of {len(judged)}"),
        Cell(seconds_text(record.seconds)),
    ]


def _reasons(record: CaseRecord, width: int) -> Iterator[Text]:
    said = reasons(record)
    if said:
        yield line("")
        yield line(f"{record.name}: {record.verdict}", VERDICT_STYLES[record.verdict])
        yield from hanging("  ", record.claim, width)
    for text in said:
        yield from hanging("  - ", text, width)
