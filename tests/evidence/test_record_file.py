import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.evidence.records import full_record
from uqfold.comparison.findings import Finding
from uqfold.evidence import (
    Measurement,
    RecordError,
    Table,
    read_case_record,
    read_case_records,
    write_case_record,
)
from uqfold.evidence.schema import check_document


def test_a_record_comes_back_as_written(tmp_path: Path) -> None:
    record = full_record()
    path = write_case_record(record, tmp_path)
    assert path == tmp_path / "a_case.json"
    again = read_case_record(path)
    nothing = again.measurement.tables[0].rows[1][1]
    assert nothing is None  # NaN in a table means nothing
    assert write_case_record(again, tmp_path / "again").read_bytes() == path.read_bytes()
    assert again.findings == record.findings
    assert (again.seeds, again.faults, again.stored) == (record.seeds, record.faults, record.stored)
    assert again.measurement.figures == record.measurement.figures
    assert again.measurement.tables[0].rows[0] == ("table 6", 0.53558, math.inf)


def test_the_file_is_strict_json_of_the_published_schema(tmp_path: Path) -> None:
    def refuse(word: str) -> None:
        raise AssertionError(word)

    text = write_case_record(full_record(), tmp_path).read_text(encoding="utf-8")
    document = json.loads(text, parse_constant=refuse)
    check_document(document, "uqfold-validation-1")
    # rows and series stand in one line each
    assert '["table 6", 0.53558, "inf"]' in text


def test_findings_keep_every_bit_and_their_nan(tmp_path: Path) -> None:
    findings = (Finding("a", math.nan, 1.0), Finding("b", 0.1 + 0.2, math.inf))
    record = full_record(measurement=Measurement(findings), stored=None)
    again = read_case_record(write_case_record(record, tmp_path))
    assert again.verdict == "does not hold"
    assert math.isnan(again.findings[0].value or 0.0)
    assert again.findings[1] == findings[1]


def test_numbers_of_tables_are_shortened(tmp_path: Path) -> None:
    table = Table.of("t", "T", [{"x": 1 / 3}])
    record = full_record(measurement=Measurement(full_record().findings, (table,)))
    path = write_case_record(record, tmp_path)
    assert read_case_record(path).measurement.tables[0].rows == ((0.333333333,),)


def _set(path: str, value: Any) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        *steps, last = [int(step) if step.isdigit() else step for step in path.split("/")]
        for step in steps:
            document = document[step]
        document[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_set("schema", "uqfold-validation/9"), "its schema is 'uqfold-validation/9', not"),
        (lambda d: d.pop("claim"), "the field 'claim' is missing"),
        (_set("claims", "x"), "'claims' is no field here: do you mean 'claim'?"),
        (_set("claim", ""), "claim: it is empty"),
        (_set("kind", "exact solutions"), "kind: 'exact solutions' is none of: .*'exact solution'"),
        (_set("name", "../../etc"), "name: '../../etc' does not match"),
        (_set("seeds/0", -1), r"seeds\[0\]: -1 is less than the minimum of 0"),
        (_set("seeds/0", "1"), r"seeds\[0\]: '1' is not of type 'integer'"),
        (_set("date", "yesterday"), "date: 'yesterday' does not match"),
        (_set("verdict", "does not hold"), "verdict of the case is 'does not hold', but .*'holds'"),
        (_set("findings/0/verdict", None), "the finding 'largest difference' is None, but"),
        (_set("findings/0/value", "1e-9"), r"findings\[0\].value"),
        (_set("stored/verdict", "cannot be judged"), "verdict of the stored result"),
        (_set("tables/0/rows/0", ["a"]), "table 'times': row 0 has 1 cells"),
        (_set("tables/0/rows/0/1", "x"), "row 0: 'x' in a column of numbers"),
        (_set("figures/0/series/0/y", [0.1]), "series 'reference': 2 x for 1 y"),
        (_set("figures/0/y/scale", "logarithmic"), r"figures\[0\].y.scale: 'logarithmic' is none"),
    ],
)
def test_what_is_wrong_is_named(
    tmp_path: Path, change: Callable[[Any], None], message: str
) -> None:
    path = write_case_record(full_record(), tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    change(document)
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        read_case_record(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [("[]", "no JSON object"), ("{", "Expecting"), ('{"a": NaN}', "NaN is not JSON")],
)
def test_other_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=rf"other.json is no readable record.*{message}"):
        read_case_record(path)


def test_a_record_is_checked_before_it_is_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="claim: it is empty"):
        write_case_record(full_record(claim=""), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_nothing_that_a_record_names_is_imported(tmp_path: Path) -> None:
    (tmp_path / "trap.py").write_text("raise SystemExit(9)", encoding="utf-8")
    record = full_record(source="trap", command="python trap.py", title="trap:measure")
    before = set(sys.modules)
    read_case_record(write_case_record(record, tmp_path))
    assert "trap" not in set(sys.modules) - before


def test_a_folder_is_read_in_order_of_topic_and_name(tmp_path: Path) -> None:
    for name, topic in (("b", "examples"), ("c", "mechanism"), ("a", "mechanism")):
        write_case_record(full_record(name=name, topic=topic), tmp_path)
    assert [record.name for record in read_case_records(tmp_path)] == ["b", "a", "c"]
    with pytest.raises(RecordError, match="holds no records"):
        read_case_records(tmp_path / "empty")
