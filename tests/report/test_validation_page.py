"""The report on validation cases."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.evidence.records import full_record
from tests.report.page.reading import Element, read
from uqfold.evidence import (
    CaseRecord,
    Finding,
    Measurement,
    PlantedFault,
    StoredResult,
    write_case_record,
)
from uqfold.evidence.check import fingerprint, report_discrepancies
from uqfold.report import report_page, write_report
from uqfold.report.page import page_html
from uqfold.report.page.blocks import Cards, plain

BROKEN = Measurement.of([Finding("largest difference", 3e-5, 2e-6, "s"), Finding("wings", 60)])
OPEN = Measurement.of([Finding("error", 1.0, 1.1, uncertainty=0.5)])


def records() -> list[CaseRecord]:
    return [
        full_record(),
        full_record(name="broken", title="A broken case", measurement=BROKEN, stored=None),
        full_record(name="open", topic="methods", title="Open", measurement=OPEN, stored=None),
        full_record(
            name="crashed", topic="methods", title="Crashed", measurement=Measurement(()),
            error="ZeroDivisionError: division by zero", stored=None, faults=(),
        ),
    ]  # fmt: skip


def page_of(found: list[CaseRecord]) -> Element:
    return read(page_html(report_page(found)))


def section(root: Element, anchor: str) -> Element:
    (found,) = [one for one in root.all("section") if one.attributes.get("id") == anchor]
    return found


def cards(found: list[CaseRecord]) -> dict[str, tuple[str, str, str]]:
    block = report_page(found).summary[0]
    assert isinstance(block, Cards)
    return {
        card.title: (plain(card.answer), " ".join(map(plain, card.more)), card.tone)
        for card in block.cards
    }


def test_the_summary_says_what_holds_and_what_does_not_and_why() -> None:
    said = cards(records())
    assert said["What was checked?"][0] == "4 claims"
    assert "3 of 3 faults planted on purpose were noticed" in said["What was checked?"][1]
    assert said["What holds?"] == (
        "1 of 4 hold",
        "1 does not hold. 2 cannot be judged. 3 of 5 limits are kept; 1 cannot be judged.",
        "bad",
    )  # fmt: skip
    answer, why, tone = said["What does not hold, and why?"]
    assert (answer, tone) == ("2 cases", "bad")
    assert "A broken case: largest difference: 3e-05 s (at most 2e-06 s)" in why
    assert "Crashed: ZeroDivisionError: division by zero" in why


def test_where_all_holds_nothing_is_blamed() -> None:
    said = cards([full_record()])
    assert said["What holds?"][::2] == ("1 of 1 hold", "good")
    assert said["What does not hold, and why?"] == ("Nothing", "", "good")


def test_a_fault_that_went_unnoticed_is_a_failure() -> None:
    missed = full_record(faults=(PlantedFault("wrong sign", "the sign of friction", "holds"),))
    said = cards([missed])
    assert said["What does not hold, and why?"][0] == "1 case"
    assert (
        "the planted fault 'wrong sign' went unnoticed" in said["What does not hold, and why?"][1]
    )
    assert "unnoticed: holds" in section(page_of([missed]), "case-a_case").text


def test_many_failures_get_a_table_with_every_reason() -> None:
    found = [
        full_record(name=f"broken_{i}", title=f"Case {i}", measurement=BROKEN, stored=None)
        for i in range(6)
    ]
    summary = section(page_of(found), "summary")
    assert summary.text.count("largest difference: 3e-05 s (at most 2e-06 s)") == 7
    assert "and 5 more, in the table below." in summary.text


def test_every_case_shows_claim_figure_table_verdict_and_how_it_was_measured() -> None:
    case = section(page_of(records()), "case-a_case")
    text = " ".join(case.text.split())
    record = full_record()
    for said in (
        record.claim, record.kind, record.compared_with, record.uncertainty, record.source,
        record.tolerance, record.verdict_rule, record.command, record.machine, record.date,
        "holds", "wrong sign", "not planted in this run", "numpy 2.1.0", str(2**70),
        "at most 2 × 10−6 s", "0.535", "table 10, <b>material</b>", "at least 3.8", "± 0.1",
    ):  # fmt: skip
        assert said in text
    assert case.all("h3")[0].text.strip().startswith("A case")
    (chart,) = [one for one in case.all("svg") if one.attributes["class"] == "chart"]
    groups = [one for one in chart.all("g") if "data-key" in one.attributes]
    assert [one.attributes["data-label"] for one in groups] == ["reference", "Monte Carlo"]
    assert "dashed" in groups[0].attributes["class"]
    # a gap in the data is a gap in the chart
    assert [len([p for p in one.all("path") if p.all("title")]) for one in groups] == [2, 1]
    assert [one.text for one in chart.all("g") if one.attributes.get("class") == "mark"] == [
        "limit"
    ]


def test_results_of_the_full_tier_are_dated_and_old_code_is_said() -> None:
    now = section(page_of([full_record()]), "case-a_case").text
    assert "The full tier, measured 2025-12-31" in now
    assert "they count too" in now
    stale = StoredResult("2025-12-31T00:00:00+00:00", False, ("uqfold/mechanism",),
                         (Finding("more", 3.0, 2.0),), 60.0, "x86_64")  # fmt: skip
    text = section(page_of([full_record(stored=stale)]), "case-a_case").text
    assert "with other code (uqfold/mechanism), so they are only quoted" in text


def test_the_report_carries_the_fingerprint_of_its_records(tmp_path: Path) -> None:
    found = records()
    for name in ("report.html", "report.md"):
        (report, *_) = write_report(found, tmp_path / name)
        assert report_discrepancies(report, found) == []
        assert report_discrepancies(report, found[1:]) != []
    assert fingerprint(found) != fingerprint(found[1:])


def test_folders_and_files_of_records_give_the_same_report(tmp_path: Path) -> None:
    for record in records():
        path = write_case_record(record, tmp_path / "run")
    assert len(read(page_html(report_page(tmp_path / "run"))).all("tr")) > 10
    assert page_html(report_page(path)).count("<h3 id=") == 1
    # the folder of the cases: of each the most thorough record that is kept
    for tier in ("quick", "full"):
        folder = tmp_path / "cases" / "a_case"
        write_case_record(full_record(tier=tier, stored=None), folder, tier)
    (folder / "case.toml").write_text("", encoding="utf-8")
    assert "1 in the full tier" in plain(report_page(tmp_path / "cases").lead)


def test_what_holds_no_records_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="holds no records: run `uqfold compare` or"):
        report_page(tmp_path)
    with pytest.raises(ValueError, match="no records"):
        report_page([])


HOSTILE = "</script><script>stolen()</script><img src=x onerror=stolen()>"
KEPT = {"schema", "turns_to", "name", "error", "kind", "tier", "verdict", "date", "scale", "style"}


def spoiled(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: v if k in KEPT else spoiled(v) for k, v in value.items()}
    if isinstance(value, list):
        return [spoiled(one) for one in value]
    special = ("inf", "-inf", "nan", "number", "text")
    return f"{value}{HOSTILE}" if isinstance(value, str) and value not in special else value


def test_records_full_of_markup_give_a_report_full_of_text(tmp_path: Path) -> None:
    path = write_case_record(full_record(), tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(spoiled(document)), encoding="utf-8")
    root = read(page_html(report_page(path)))
    assert root.text.count(HOSTILE) > 30
    assert len(root.all("script")) == 1
    assert root.all("img") == []


def test_nothing_that_records_name_is_imported(tmp_path: Path) -> None:
    write_case_record(full_record(command="python -m antigravity"), tmp_path)
    code = (
        "import sys, uqfold.report\n"
        f"uqfold.report.write_report({str(tmp_path)!r}, {str(tmp_path / 'r.html')!r})\n"
        "print([m for m in sys.modules if m in ('antigravity', 'numba', 'openturns')\n"
        "       or m.startswith('validation')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert done.stdout.strip() == "[]"
