"""Running validation cases for the command line: measure, keep, compare, say what came out."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd
from rich.console import Console

from uqfold.cli.invocation import Invocation, say_json
from uqfold.cli.streams import EXIT_FAILED, EXIT_INTERRUPTED, say, shown_path, stdout_console
from uqfold.report.progress import ComparisonProgressBar
from uqfold.report.reports import KEPT_REPORT, write_kept_report
from uqfold.report.table import joined, text_columns
from uqfold.report.validation_page import validation_page
from uqfold.report.verdicts import counted, print_verdicts
from uqfold.validation.case import Case, Tier
from uqfold.validation.kept import changes, discrepancies, kept_records
from uqfold.validation.record import (
    CaseRecord,
    existing_record,
    read_case_records,
    write_case_record,
)
from uqfold.validation.runner import Validation
from uqfold.writing import check_writable

EXIT_CHANGED, EXIT_BROKEN = 1, 2


def measure_cases(
    cases: Sequence[Case],
    validation: Validation,
    invocation: Invocation,
    *,
    update: bool,
    as_json: bool,
) -> int:
    """Measure cases, report, and keep the records if asked to; return the exit code."""
    check_writable(validation.folder)
    records: list[CaseRecord] = []
    found: dict[str, tuple[str, ...]] = {}
    wake = invocation.interrupts.check
    bar = ComparisonProgressBar([case.name for case in cases], Console(stderr=True), unit="parts")

    def progress(name: str, done: int, total: int | None) -> None:
        wake()
        bar(name, done, total)

    measuring = replace(validation, progress=progress)
    interrupted = False
    try:
        with bar:
            for case in cases:
                record = measuring.run(case)
                # what was interrupted may look finished where a library swallowed it
                wake()
                records.append(record)
                found[case.name] = changes(existing_record(case.kept(record.tier)), record)
                if update:
                    write_case_record(record, case.kept(record.tier))
    except KeyboardInterrupt:
        resume = shlex.join(["uqfold", *invocation.words])
        done = f"{len(records)} of {len(cases)} cases are finished and kept"
        say(f"interrupted: {done}; to go on: {resume}")
        interrupted = True
    if records:
        page = validation_page(read_case_records(validation.folder))
        reports = page.write(validation.folder / "report.html")
        if update:
            reports += write_kept_report(cases[0].folder.parent)[:1]
        _print_outcome(records, found, [validation.folder, *reports], as_json=as_json)
    if interrupted:
        return EXIT_INTERRUPTED
    if any(record.broken for record in records):
        return EXIT_BROKEN
    # with --update they are the kept ones from now on
    return EXIT_CHANGED if not update and any(found.values()) else 0


def _print_outcome(
    records: Sequence[CaseRecord],
    found: Mapping[str, Sequence[str]],
    written: Sequence[Path],
    *,
    as_json: bool,
) -> None:
    """Print verdicts, which of them are not the kept ones, and what has been written."""
    if as_json:
        cases = [
            {
                "name": one.name,
                "verdict": one.verdict,
                "broken": list(one.broken),
                "changed": list(found[one.name]),
            }
            for one in records
        ]
        say_json({"cases": cases, "written": list(map(shown_path, written))})
        return
    out = stdout_console(quiet=False)
    print_verdicts(out, records)
    told = {
        one.name: [
            *(f"broken: {text}" for text in one.broken),
            *(f"changed: {text}" for text in found[one.name]),
        ]
        for one in records
    }
    same = sum(not lines for lines in told.values())
    kept = f"{same} of {len(records)} cases have the kept verdicts"
    folder, *reports = map(shown_path, written)
    lines = [
        f"\nkept records: {'every verdict is the kept one' if same == len(records) else kept}",
        *(f"  {name}: {text}" for name, texts in told.items() for text in texts),
        f"\nrecords: {folder}",
        *(f"report: {path}" for path in reports),
    ]
    for text in lines:
        out.print(text, highlight=False, markup=False, soft_wrap=True)


def print_cases(cases: Sequence[Case], *, as_json: bool) -> None:
    """Print what each case claims."""
    listed = pd.DataFrame(
        {
            "topic": case.declared.topic,
            "case": case.name,
            "kind": case.declared.kind,
            "faults": len(case.faults),
            "title": case.declared.title,
        }
        for case in cases
    )
    if as_json:
        say_json(listed.to_dict("records"))
        return
    for line in joined(text_columns(listed)):
        stdout_console(quiet=False).print(line, soft_wrap=True)


def stale_cases(cases: Sequence[Case], tier: Tier) -> list[Case]:
    """Return the cases whose kept record does not belong to them or to the code, and say so."""
    stale = [case for case in cases if discrepancies(case, [tier])]
    say(f"{len(stale)} of {len(cases)} cases have no current record of the {tier} tier")
    return stale


def check_cases(cases: Sequence[Case], *, as_json: bool) -> int:
    """Say whether cases, kept records and code belong together; return the exit code."""
    found = {case.name: discrepancies(case) for case in cases}
    root = cases[0].folder.parent
    kept = kept_records(root)
    if kept and {one.name for one in kept} <= set(found):
        report = root / KEPT_REPORT
        drawn = report.read_text(encoding="utf-8") if report.is_file() else ""
        if validation_page(kept).markdown() != drawn:
            again = shlex.join(["uqfold", "report", shown_path(root), "--out", shown_path(report)])
            wrong = f"the report is not what this code draws from the records, remake it: {again}"
            found[KEPT_REPORT] = [wrong]
    failed = any(found.values())
    if as_json:
        say_json(found)
    for name, lines in found.items():
        for text in lines:
            say(f"{name}: {text}")
    if not failed:
        say(f"{counted(len(cases), 'case')}: records, code and claims belong together")
    return EXIT_FAILED if failed else 0
