"""Running validation cases for the command line: measure, keep, compare, say what came out."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

import uqfold
from uqfold.cli.compare import EXIT_FAILED, EXIT_INTERRUPTED, stdout_console
from uqfold.cli.interrupts import Interrupts
from uqfold.cli.streams import shown_path
from uqfold.evidence.case import Case
from uqfold.evidence.changes import Changes, changes, kept_record
from uqfold.evidence.check import KEPT_TIERS, discrepancies, report_discrepancies
from uqfold.evidence.record import CaseRecord, Tier
from uqfold.evidence.record_file import read_case_records, write_case_record
from uqfold.evidence.runner import Validation
from uqfold.evidence.side_by_side import for_workers, side_by_side
from uqfold.report.layout import Cell, Grid
from uqfold.report.page.write import write_page
from uqfold.report.progress import ComparisonProgressBar
from uqfold.report.reports import KEPT_REPORT, kept_records, write_kept_report
from uqfold.report.validation_page import validation_page
from uqfold.report.verdicts import VerdictTable, kept_text
from uqfold.writing import check_writable

EXIT_CHANGED, EXIT_BROKEN = 1, 2


@dataclass
class ValidationSession:
    """Cases measured from the command line.

    Attributes
    ----------
    cases
        What to measure.
    tier
        How thoroughly.
    folder
        Where records go.
    interrupts
        Tells whether Ctrl-C was pressed.
    faults
        Whether to plant the cases' faults.
    update
        Whether to replace the records that are kept beside the cases.
    resume
        The words that go on with this run, for whoever interrupted it.
    """

    cases: Sequence[Case]
    tier: Tier
    folder: Path
    interrupts: Interrupts
    faults: bool = False
    update: bool = False
    resume: str = ""
    records: list[CaseRecord] = field(default_factory=list, init=False)
    changes: dict[str, Changes] = field(default_factory=dict, init=False)

    def run(self) -> int:
        """Measure all cases and report; give the exit code of the program."""
        code = 0
        check_writable(self.folder)
        try:
            self._measure()
        except KeyboardInterrupt:
            done = f"{len(self.records)} of {len(self.cases)} cases are finished and kept"
            _say(f"interrupted: {done}; to go on: {self.resume}")
            code = EXIT_INTERRUPTED
        if self.records:
            names = [case.name for case in self.cases]
            self.records.sort(key=lambda record: names.index(record.name))
            out = stdout_console(quiet=False)
            out.print(VerdictTable(self.records))
            out.print(f"\nkept records: {kept_text(list(self.changes.values()))}", highlight=False)
            for name, found in self.changes.items():
                for text in found.words:
                    out.print(f"  {name}: {text}", highlight=False, markup=False, soft_wrap=True)
            out.print(f"\nrecords: {shown_path(self.folder)}", highlight=False)
            for path in self._write_reports():
                out.print(f"report: {shown_path(path)}", highlight=False)
        if code == 0 and any(found.broken for found in self.changes.values()):
            code = EXIT_BROKEN
        elif code == 0 and any(found.verdicts for found in self.changes.values()):
            # with --update they are the kept ones from now on
            code = 0 if self.update else EXIT_CHANGED
        return code

    def _measure(self) -> None:
        names = [case.name for case in self.cases]
        with ComparisonProgressBar(names, Console(stderr=True), unit="parts") as bar:

            def progress(name: str, done: int, total: int | None) -> None:
                self.interrupts.check()
                bar(name, done, total)

            validation = Validation(self.tier, self.folder, self.faults, progress)
            left = {case.name: case for case in self.cases}
            several = for_workers(self.cases, self.tier)
            for case, record in side_by_side(validation, several, self.interrupts.check):
                bar(case.name, 0, None)
                self._keep(left.pop(case.name), record)
            for case in left.values():
                record = validation.run(case)
                # what was interrupted may look finished where a library swallowed it
                self.interrupts.check()
                self._keep(case, record)

    def _keep(self, case: Case, record: CaseRecord) -> None:
        self.records.append(record)
        self.changes[case.name] = changes(kept_record(case, self.tier), record)
        if self.update and self.tier in KEPT_TIERS:
            write_case_record(record, case.folder, self.tier)

    def _write_reports(self) -> list[Path]:
        """Write the report on all records of the folder, and on the kept ones if these changed."""
        report = self.folder / "report.html"
        page = validation_page(read_case_records(self.folder), self.changes)
        written = write_page(page, report)[:1]
        if self.update:
            written += write_kept_report(self.cases[0].folder.parent)[:1]
        return written


def default_cases() -> Path:
    """Give the folder of the cases: here, or beside the installed package (a clone)."""
    here = Path("validation")
    return here if here.is_dir() else Path(uqfold.__file__).resolve().parents[1] / "validation"


def print_cases(cases: Sequence[Case]) -> None:
    """Print what each case claims."""
    grid = Grid(
        ("topic", "case", "kind", "faults", "title"),
        [
            [Cell(one.topic), Cell(one.name), Cell(one.kind), Cell(str(len(one.faults))),
             Cell(one.title)]
            for one in cases
        ],
        numeric=(3,),
        gap=2,
    )  # fmt: skip
    out = stdout_console(quiet=False)
    out.print(grid.head_line())
    for text in grid.lines():
        out.print(text)


def stale_cases(cases: Sequence[Case], tier: Tier) -> list[Case]:
    """Give the cases whose kept record does not belong to them or to the code, and say how many."""
    stale = [case for case in cases if discrepancies(case, [tier])]
    _say(f"{len(stale)} of {len(cases)} cases have no current record of the {tier} tier")
    return stale


def check_cases(cases: Sequence[Case]) -> int:
    """Say whether cases, kept records and code belong together; give the exit code."""
    found = {case.name: discrepancies(case) for case in cases}
    root = cases[0].folder.parent
    kept = kept_records(root)
    if {one.name for one in kept} <= set(found):
        report = root / KEPT_REPORT
        found[report.name] = report_discrepancies(report, kept)
    for name, lines in found.items():
        for text in lines:
            _say(f"{name}: {text}")
    wrong = sum(bool(lines) for lines in found.values())
    if not wrong:
        _say(f"{len(cases)} cases: records, code and claims belong together")
    return EXIT_FAILED if wrong else 0


def resume_command(words: Sequence[str]) -> str:
    """Give the command that goes on."""
    return shlex.join(["uqfold", *words])


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
