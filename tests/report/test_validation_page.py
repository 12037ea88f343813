"""The report on validation cases."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.report.page.reading import Element, read
from tests.report.page.reading import cards as cards_of
from tests.validation.case_folder import DECLARED, make_case
from tests.validation.records import claims_record, full_record
from uqfold.plots.telling import values
from uqfold.report import report_page, write_report
from uqfold.report.page.builder import Page
from uqfold.report.page.markup import inline_html
from uqfold.report.validation_page import validation_page
from uqfold.validation import CaseRecord, Finding, Measurement
from uqfold.validation.case import Fault, load_cases
from uqfold.validation.kept import fingerprint
from uqfold.validation.record import PlantedFault, write_case_record

BROKEN = Measurement([Finding("largest difference", 3e-5, 2e-6, "s"), Finding("wings", 60)])
OPEN = Measurement([Finding("error", 1.0, 1.1, uncertainty=0.5)])


def records() -> list[CaseRecord]:
    return [
        full_record(),
        full_record(name="broken", title="A broken case", measurement=BROKEN),
        full_record(name="open", topic="methods", title="Open", measurement=OPEN),
        full_record(
            name="crashed", topic="methods", title="Crashed", measurement=Measurement(()),
            error="ZeroDivisionError: division by zero", faults=(),
        ),
    ]  # fmt: skip


def built(source: Any) -> Page:
    page = report_page(source)
    assert isinstance(page, Page)
    return page


def cards(page: Page) -> dict[str, tuple[str, str, str]]:
    return {
        title: (card["answer"], read(inline_html(" ".join(card["more"]))).text, card["tone"])
        for title, card in cards_of(page).items()
    }


def section(found: list[CaseRecord], title: str) -> str:
    """Return the Markdown of the section on a case."""
    text = built(found).markdown()
    return text.partition(f"\n### {title}")[2].partition("\n### ")[0]


def test_the_summary_says_what_holds_and_what_does_not_and_why() -> None:
    said = cards(built(records()))
    assert said["What holds?"] == (
        "1 of 4 hold",
        "1 does not hold. 2 cannot be judged. 2 of 4 limits are kept. "
        "3 of 3 faults planted on purpose were noticed.",
        "bad",
    )
    answer, why, tone = said["What does not hold, and why?"]
    assert (answer, tone) == ("2 cases", "bad")
    assert "A broken case: largest difference: 3 × 10⁻⁵ s (at most 2 × 10⁻⁶ s)" in why
    assert "Crashed: could not be measured: ZeroDivisionError: division by zero" in why


def test_where_all_holds_nothing_is_blamed() -> None:
    said = cards(built([full_record()]))
    assert said["What holds?"][::2] == ("1 of 1 hold", "good")
    assert said["What does not hold, and why?"] == ("Nothing", "", "good")


def test_every_claim_of_a_case_is_counted_and_told() -> None:
    found = [claims_record(), full_record(name="other")]
    said = cards(built(found))
    assert said["What holds?"][0] == "2 of 3 hold"
    assert "1 of those that hold: an identity, which is no evidence." in said["What holds?"][1]
    text = built(found).markdown()
    assert "| It falls. | Section 1 | holds (an identity) |" in text
    assert "### A case (1 of 2 hold)" in text
    assert "#### second (does not hold)" in text
    assert "Rule: within 1 % of the end." in text


def test_a_fault_that_went_unnoticed_is_a_failure() -> None:
    missed = full_record(faults=(PlantedFault(Fault("wrong sign", "of friction"), "holds"),))
    answer, why, _ = cards(built([missed]))["What does not hold, and why?"]
    assert answer == "1 case"
    assert "the planted fault 'wrong sign' went unnoticed" in why
    assert "unnoticed: holds" in section([missed], "A case")


def test_many_failures_are_each_named_with_a_reason() -> None:
    found = [
        full_record(name=f"broken_{i}", title=f"Case {i}", measurement=BROKEN) for i in range(6)
    ]
    summary = built(found).markdown().partition("\n## ")[0]
    assert summary.count("largest difference: 3 × 10⁻⁵ s (at most 2 × 10⁻⁶ s)") == 6


def test_the_time_that_cases_took_is_no_elapsed_time() -> None:
    page = validation_page([full_record()])
    assert "the times of the cases add up to 1.2 s" in page.lead


def test_every_case_shows_claim_figure_table_verdict_and_how_it_was_measured() -> None:
    record = full_record()
    text = section(records(), "A case").replace("\\", "")
    for said in (
        record.case.claim, record.case.kind, record.case.compared_with, record.case.uncertainty,
        record.case.source, record.case.tolerance, record.case.verdict_rule,
        record.made["command"], record.made["machine"], record.date, "(holds)", "wrong sign",
        "not planted in this run", "numpy 2.1.0", str(2**70), "at most 2 × 10⁻⁶ s",
        "3.33 × 10⁻⁷ s", "0.5356", "at least 3.8", "± 0.1",
    ):  # fmt: skip
        assert said in text, said
    ((name, figure),) = built([record]).pictures.items()
    assert name == "a-case-1"
    told = values(figure)
    # a gap in the data is a gap in the chart
    assert [len(told[f"series={one}"]) for one in ("mc",)] == [1]
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts] == ["limit"]
    assert axes.get_legend_handles_labels()[1] == ["reference", "mc"]


def test_links_lead_to_the_sections_of_cases() -> None:
    root = read(built(records()).html())
    targets = [one.attributes["href"][1:] for one in root.all("a")]
    sections = {one.attributes.get("id") for one in root.all("section")}
    assert "case-broken" in targets
    assert {one for one in targets if one.startswith("case-")} <= sections
    text = built(records()).markdown()
    assert text.index("](#case-broken)") < text.index('<a id="case-broken"></a>')
    assert '<a id="case-open"></a>' not in text


def test_the_report_carries_the_fingerprint_of_its_records(tmp_path: Path) -> None:
    found = records()
    for name in ("report.html", "report.md"):
        (report, *_) = write_report(found, tmp_path / name)
        assert fingerprint(found) in report.read_text(encoding="utf-8")
    assert fingerprint(found) != fingerprint(found[1:])


def test_folders_and_files_of_records_give_the_same_report(tmp_path: Path) -> None:
    for record in records():
        path = write_case_record(record, tmp_path / "run" / f"{record.name}.json")
    assert "4 claims in 4 cases" in built(tmp_path / "run").lead
    assert "1 claim in 1 case, each with what" in built(path).lead
    # the folder of the cases: of each the most thorough record that is kept
    [case] = load_cases(make_case(tmp_path / "cases", declared=DECLARED))
    for tier in ("quick", "full"):
        write_case_record(full_record(tier=tier), case.kept(tier))  # type: ignore[arg-type]
    assert "1 in the full tier" in built(tmp_path / "cases").lead


def test_what_holds_no_records_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="holds no records: run `uqfold compare` or"):
        report_page(tmp_path)
    with pytest.raises(ValueError, match="no records"):
        report_page([])


HOSTILE = "</script><script>stolen()</script><img src=x onerror=stolen()> [a](javascript:b)"
KEPT = {"schema", "turns_to", "name", "topic", "error", "kind", "tier", "verdict", "log", "seed"}


def spoiled(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: v if k in KEPT else spoiled(v) for k, v in value.items()}
    if isinstance(value, list):
        return [spoiled(one) for one in value]
    special = ("", "inf", "series", "x", "y", "low", "high", "reference")
    return f"{value}{HOSTILE}" if isinstance(value, str) and value not in special else value


def test_records_full_of_markup_give_a_report_full_of_text(tmp_path: Path) -> None:
    path = write_case_record(full_record(), tmp_path / "a.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(spoiled(document)), encoding="utf-8")
    root: Element = read(built(path).html())
    assert root.text.count(HOSTILE) > 30
    assert len(root.all("script")) == 1
    assert root.all("img") == []


@pytest.mark.thorough
def test_nothing_that_records_name_is_imported(tmp_path: Path) -> None:
    record = full_record(tolerance="python -m antigravity")
    write_case_record(record, tmp_path / "a.json")
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
