"""Running validation cases for the command line: measure, keep, compare, say what came out."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

import uqfold
from uqfold.cli.compare import say, stdout_console
from uqfold.cli.invocation import Invocation
from uqfold.cli.streams import EXIT_FAILED, EXIT_INTERRUPTED, shown_path
from uqfold.report.progress import ComparisonProgressBar
from uqfold.report.reports import KEPT_REPORT, kept_records, write_kept_report
from uqfold.report.validation_page import validation_page
from uqfold.report.verdicts import kept_text, print_verdicts, stale_text
from uqfold.validation.case import Case, Tier
from uqfold.validation.changes import Changes, changes
from uqfold.validation.check import KEPT_TIERS, discrepancies, kept_record, report_discrepancies
from uqfold.validation.record import CaseRecord, read_case_records, write_case_record
from uqfold.validation.runner import Validation
from uqfold.validation.side_by_side import for_workers, side_by_side
from uqfold.writing import check_writable

EXIT_CHANGED, EXIT_BROKEN = 1, 2


@dataclass
class ValidationSession:
    """Cases under way: how thoroughly, where records go, and whether faults are planted."""

    cases: Sequence[Case]
    tier: Tier
    folder: Path
    invocation: Invocation
    faults: bool = False
    update: bool = False
    records: list[CaseRecord] = field(default_factory=list, init=False)
    changes: dict[str, Changes] = field(default_factory=dict, init=False)

    def run(self) -> int:
        """Measure all cases and report; return the exit code of the program."""
        check_writable(self.folder)
        interrupted = False
        try:
            self._measure()
        except KeyboardInterrupt:
            resume = shlex.join(["uqfold", *self.invocation.words])
            done = f"{len(self.records)} of {len(self.cases)} cases are finished and kept"
            say(f"interrupted: {done}; to go on: {resume}")
            interrupted = True
        if self.records:
            self._report()
        if interrupted:
            return EXIT_INTERRUPTED
        if any(found.broken for found in self.changes.values()):
            return EXIT_BROKEN
        # with --update they are the kept ones from now on
        changed = any(found.verdicts for found in self.changes.values())
        return EXIT_CHANGED if changed and not self.update else 0

    def _measure(self) -> None:
        names = [case.name for case in self.cases]
        with ComparisonProgressBar(names, Console(stderr=True), unit="parts") as bar:

            def progress(name: str, done: int, total: int | None) -> None:
                self.invocation.interrupts.check()
                bar(name, done, total)

            validation = Validation(self.tier, self.folder, self.faults, progress)
            left = {case.name: case for case in self.cases}
            several = for_workers(self.cases, self.tier)
            for case, record in side_by_side(validation, several, self.invocation.interrupts.check):
                bar(case.name, 0, None)
                self._keep(left.pop(case.name), record)
            for case in left.values():
                record = validation.run(case)
                # what was interrupted may look finished where a library swallowed it
                self.invocation.interrupts.check()
                self._keep(case, record)

    def _keep(self, case: Case, record: CaseRecord) -> None:
        self.records.append(record)
        self.changes[case.name] = changes(kept_record(case, self.tier), record)
        if self.update and self.tier in KEPT_TIERS:
            write_case_record(record, case.kept(self.tier))

    def _report(self) -> None:
        """Print what came out, and write the report on all records of the folder."""
        names = [case.name for case in self.cases]
        self.records.sort(key=lambda record: names.index(record.name))
        out = stdout_console(quiet=False)
        print_verdicts(out, self.records)
        lines = [f"\nkept records: {kept_text(list(self.changes.values()))}"]
        lines += [
            f"  {name}: {text}" for name, found in self.changes.items() for text in found.words
        ]
        lines += [text for text in [stale_text(self.records)] if text]
        lines.append(f"\nrecords: {shown_path(self.folder)}")
        report = self.folder / "report.html"
        written = validation_page(read_case_records(self.folder), self.changes).write(report)
        if self.update:
            written += write_kept_report(self.cases[0].folder.parent)[:1]
        lines += [f"report: {shown_path(path)}" for path in written]
        for text in lines:
            out.print(text, highlight=False, markup=False, soft_wrap=True)


def default_cases() -> Path:
    """Return the folder of the cases: here, or beside the installed package (a clone)."""
    here = Path("validation")
    return here if here.is_dir() else Path(uqfold.__file__).resolve().parents[1] / "validation"


def print_cases(cases: Sequence[Case]) -> None:
    """Print what each case claims."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for head in ("topic", "case", "kind", "faults", "title"):
        table.add_column(head, no_wrap=head != "title")
    for case in cases:
        one = case.declared
        table.add_row(one.topic, one.name, one.kind, str(len(case.faults)), Text(one.title))
    stdout_console(quiet=False).print(table)


def stale_cases(cases: Sequence[Case], tier: Tier) -> list[Case]:
    """Return the cases whose kept record does not belong to them or to the code, and say so."""
    stale = [case for case in cases if discrepancies(case, [tier])]
    say(f"{len(stale)} of {len(cases)} cases have no current record of the {tier} tier")
    return stale


def check_cases(cases: Sequence[Case]) -> int:
    """Say whether cases, kept records and code belong together; return the exit code."""
    found = {case.name: discrepancies(case) for case in cases}
    root = cases[0].folder.parent
    kept = kept_records(root)
    if {one.name for one in kept} <= set(found):
        found[KEPT_REPORT] = report_discrepancies(root / KEPT_REPORT, kept)
    for name, lines in found.items():
        for text in lines:
            say(f"{name}: {text}")
    wrong = any(found.values())
    if not wrong:
        say(f"{len(cases)} cases: records, code and claims belong together")
    return EXIT_FAILED if wrong else 0
