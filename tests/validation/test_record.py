import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.validation.records import claims_record, full_record
from uqfold.validation import (
    Finding,
    Measurement,
    RecordError,
    read_case_record,
    read_case_records,
    record_schema,
)
from uqfold.validation.case import Fault
from uqfold.validation.record import PlantedFault, write_case_record


def test_every_claim_of_a_case_has_its_own_verdict() -> None:
    record = claims_record()
    assert record.claims == {"first": "holds", "second": "does not hold"}
    assert record.verdict == "does not hold"
    with pytest.raises(ValueError, match="'third': a finding belongs to no claim of these"):
        Measurement([Finding("rise", 0.0, 1.0, claim="third")])


def test_a_measurement_that_ended_in_an_error_judges_nothing() -> None:
    record = full_record(error="ValueError: no data", measurement=Measurement(()))
    assert record.verdict == "cannot be judged"


def test_faults_that_went_unnoticed() -> None:
    missed = PlantedFault(Fault("biased", "1e-5 s late"), "holds")
    unjudged = PlantedFault(Fault("coarse", "100 times the tolerance"), "cannot be judged")
    record = full_record(faults=(*full_record().faults, missed, unjudged))
    assert [fault.caught for fault in record.faults] == [True, None, False, False]
    assert record.broken == (
        "the planted fault 'biased' went unnoticed",
        "the planted fault 'coarse' went unnoticed",
    )


@pytest.mark.parametrize("record", [full_record(), claims_record()])
def test_a_record_comes_back_as_written(record: Any, tmp_path: Path) -> None:
    path = write_case_record(record, tmp_path / "a.json")
    again = read_case_record(path)
    assert again == record
    assert write_case_record(again, tmp_path / "again.json").read_bytes() == path.read_bytes()
    assert '"verdict"' in path.read_text("utf-8")


def test_the_file_is_strict_json_in_short_lines(tmp_path: Path) -> None:
    def refuse(word: str) -> None:
        raise AssertionError(word)

    text = write_case_record(full_record(), tmp_path / "a.json").read_text(encoding="utf-8")
    document = json.loads(text, parse_constant=refuse)
    assert set(document) <= set(record_schema()["properties"])
    assert '["table 6", 0.53558, "inf"]' in text


def test_findings_keep_every_bit_and_their_nan(tmp_path: Path) -> None:
    findings = (Finding("a", math.nan, 1.0), Finding("b", 0.1 + 0.2, math.inf))
    record = full_record(measurement=Measurement(findings))
    again = read_case_record(write_case_record(record, tmp_path / "a.json"))
    assert again.verdict == "does not hold"
    assert math.isnan(again.findings[0].value or 0.0)
    assert again.findings[1] == findings[1]


def _set(path: str, value: Any) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        *steps, last = [int(step) if step.isdigit() else step for step in path.split("/")]
        for step in steps:
            document = document[step]
        document[last] = value

    return change


FIRST = "measurement/findings/0"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_set("schema", "uqfold-validation/1"), "its schema is 'uqfold-validation/1', not"),
        (lambda d: d["case"].pop("claim"), r"the field case.claim is missing"),
        (_set("case/claims", "x"), "case.claims is not a field here: do you mean 'claim'?"),
        (_set("note", "x"), "it holds unknown fields, or verdicts"),
        (_set("case/claim", ""), "case.claim: String should have at least 1 character"),
        (_set("case/kind", "exact solutions"), "case.kind: Input should be .*'exact solution'"),
        (_set("case/name", "../../etc"), r"case.name: String should match pattern"),
        (_set("case/seeds/0", -1), r"case.seeds\[0\]: Input should be greater than or equal to 0"),
        (_set("case/seeds/0", "1"), r"case.seeds\[0\]: Input should be a valid integer"),
        (_set("tier", "default"), "tier: Input should be 'quick' or 'full', not 'default'"),
        (_set("seconds", -1.0), "seconds: Input should be greater"),
        (_set("verdict", "does not hold"), "verdicts that its findings do not give"),
        (_set(f"{FIRST}/verdict", None), "verdicts that its findings do not give"),
        (_set(f"{FIRST}/value", "1e-9"), "it holds unknown fields, or verdicts"),
        (_set(f"{FIRST}/value", "x"), r"measurement.findings\[0\].value: Input should be a valid"),
        (_set(f"{FIRST}/what", ""), r"measurement.findings\[0\]: .*what = ''"),
        (_set("measurement/tables/0/rows/0", ["a"]), r"rows\[0\] has 1 cells for 3 columns"),
        (_set("measurement/points/0/log", "z"), r"measurement.points\[0\].log: Input should be"),
    ],
)
def test_what_is_wrong_is_named(
    tmp_path: Path, change: Callable[[Any], None], message: str
) -> None:
    path = write_case_record(full_record(), tmp_path / "a.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    change(document)
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        read_case_record(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[]", "no JSON object"),
        ("{", "Expecting"),
        ('{"a": NaN}', "NaN is not JSON"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a": 1e400}', "1e400 is too large"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=rf"other.json is not a readable record.*{message}"):
        read_case_record(path)


def test_nothing_that_a_record_names_is_imported(tmp_path: Path) -> None:
    (tmp_path / "trap.py").write_text("raise SystemExit(9)", encoding="utf-8")
    record = full_record(source="trap", title="trap:measure")
    before = set(sys.modules)
    read_case_record(write_case_record(record, tmp_path / "a.json"))
    assert "trap" not in set(sys.modules) - before


def test_a_folder_is_read_in_order_of_topic_and_name(tmp_path: Path) -> None:
    for name, topic in (("b", "examples"), ("c", "mechanism"), ("a", "mechanism")):
        write_case_record(full_record(name=name, topic=topic), tmp_path / f"{name}.json")
    assert [record.name for record in read_case_records(tmp_path)] == ["b", "a", "c"]
    with pytest.raises(RecordError, match="holds no records"):
        read_case_records(tmp_path / "empty")
