from pathlib import Path

from tests.evidence.case_folder import DECLARED, MEASURE, make_case
from tests.evidence.records import full_record
from uqfold.evidence import read_case_record, write_case_record
from uqfold.evidence.case import Case, load_case
from uqfold.evidence.check import discrepancies, fingerprint, report_discrepancies
from uqfold.evidence.runner import Validation


def kept_case(cases: Path, out: Path) -> Case:
    case = load_case(make_case(cases))
    for tier in ("quick", "full"):
        record = Validation(tier, out, faults=True).run(case)  # type: ignore[arg-type]
        write_case_record(record, case.folder, tier)
    return case


def test_what_belongs_together(cases: Path, tmp_path: Path) -> None:
    assert discrepancies(kept_case(cases, tmp_path)) == []


def test_missing_and_damaged_records(cases: Path, tmp_path: Path) -> None:
    case = kept_case(cases, tmp_path)
    (case.folder / "full.json").unlink()
    (case.folder / "quick.json").write_text("{}")
    damaged, missing = discrepancies(case)
    assert "quick.json is no readable record" in damaged
    assert missing == "no record of the full tier is kept"


def test_other_code_and_another_claim(cases: Path, tmp_path: Path) -> None:
    case = kept_case(cases, tmp_path)
    (case.folder / "measure.py").write_text(MEASURE + "\n")
    (case.folder / "case.toml").write_text(DECLARED.replace("[7]", "[8]"))
    found = discrepancies(load_case(case.folder))
    assert [line for line in found if "the case has changed since: seeds" in line]
    assert [line for line in found if f"with other code ({cases.name}/a_case)" in line]
    assert [line for line in found if "uqfold validate a_case --full --update" in line]


def test_records_of_another_tier_and_missed_faults(cases: Path, tmp_path: Path) -> None:
    blind = MEASURE.replace('3.0 if work.fault == "too large" else 1.0', "1.0")
    case = load_case(make_case(cases, measure=blind))
    record = Validation("quick", tmp_path, faults=True).run(case)
    for tier in ("quick", "full"):
        write_case_record(record, case.folder, tier)
    found = discrepancies(case)
    assert "full.json holds a record of the quick tier" in found
    assert "quick.json: the planted fault 'too large' went unnoticed" in found


def test_a_report_carries_what_it_was_made_from(tmp_path: Path) -> None:
    first, second = full_record(), full_record(name="another")
    mark = fingerprint([first, second])
    assert mark == fingerprint([second, first])
    assert mark != fingerprint([first])
    read = read_case_record(write_case_record(first, tmp_path))
    report = tmp_path / "report.md"
    assert report_discrepancies(report, [first]) == ["there is no report"]
    report.write_text(f"<!-- {fingerprint([read])} -->")
    assert report_discrepancies(report, [read]) == []
    assert report_discrepancies(report, [read, second]) == [
        "the report was made from other records"
    ]
