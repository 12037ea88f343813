"""Records: exact round trip, strict JSON, clear errors, nothing half written."""

import csv
import hashlib
import json
import math
import os
import re
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

import uqfold
from tests.comparison.fakes import GRID, METHODS, toy_frame, toy_problem
from uqfold.comparison import (
    RecordsError,
    comparison_header,
    criteria_of,
    read_records,
    record_schema,
    run_comparison,
    write_records,
)
from uqfold.comparison.columns import ATTRIBUTE, COLUMNS, rows_to_frame
from uqfold.comparison.form import ROWS, encoded
from uqfold.problems.criterion import Binomial, criteria
from uqfold.provenance import source_digest
from uqfold.typing import FloatArray

HARD_NUMBERS = {
    "threshold": -5e-324,
    "pf": 0.1 + 0.2,
    "reliability": 1.0 - 2.0**-53,
    "beta": math.inf,
    "std_error": math.nan,
    "ci_low": -0.0,
    "ci_high": 1.7976931348623157e308,
    "error": 1 / 3,
    "seed": 2**127 + 1,
    "message": 'a "quoted", µ\nsecond line',
}


@pytest.fixture(scope="module")
def a_row() -> dict[str, Any]:
    (row,) = toy_frame(criteria(12.0), {"exact": METHODS["exact"]}).to_dict("records")
    return dict(row)


@pytest.fixture
def frame() -> pd.DataFrame:
    whole = toy_frame()
    first, *others = whole.to_dict("records")
    written = rows_to_frame([{**first, **HARD_NUMBERS}, *others])
    written.attrs[ATTRIBUTE] = {**whole.attrs[ATTRIBUTE], "seed": 2**127 + 1}
    return written


def texts(frame: pd.DataFrame) -> list[str]:
    """Return the rows as text, which tells -0.0 from 0.0 and equals itself for NaN."""
    return [repr(row) for row in frame.to_dict("records")]


def without_constants(text: str) -> Any:
    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_round_trip_is_exact_to_the_last_bit(frame: pd.DataFrame, tmp_path: Path) -> None:
    _, path = write_records(frame, tmp_path)
    for read in (read_records(path), read_records(tmp_path), read_records(str(path))):
        assert read.attrs[ATTRIBUTE] == comparison_header(frame)
        assert texts(read) == texts(frame)
    pd.testing.assert_frame_equal(read, frame, check_exact=True)


def test_what_was_read_is_written_again_in_the_same_bytes(tmp_path: Path) -> None:
    first = write_records(toy_frame(), tmp_path / "first")
    second = write_records(read_records(tmp_path / "first"), tmp_path / "second")
    assert [one.read_bytes() for one in first] == [one.read_bytes() for one in second]


def test_records_of_the_earlier_schema_are_read(frame: pd.DataFrame, tmp_path: Path) -> None:
    """Records of 0.1.0 are read; they know neither digests of the source nor what finished."""
    _, path = write_records(frame[frame["label"] != "broken"], tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    earlier = {
        name: value
        for name, value in document.items()
        if name not in ("source", "finished", "sha256")
    }
    earlier["schema"] = "uqfold-comparison/2"
    path.write_text(json.dumps(earlier), encoding="utf-8")
    read = read_records(path)
    assert texts(read) == texts(frame[frame["label"] != "broken"])
    assert read.attrs[ATTRIBUTE]["finished"] == ["exact", "biased", "sampled"]
    earlier["sha256"] = hashlib.sha256(json.dumps(earlier, sort_keys=True).encode()).hexdigest()
    path.write_text(json.dumps(earlier), encoding="utf-8")
    assert texts(read_records(path)) == texts(read)
    earlier["rows"][0]["pf"] = 0.5
    path.write_text(json.dumps(earlier), encoding="utf-8")
    with pytest.raises(RecordsError, match="does not have the digest"):
        read_records(path)


def test_records_of_earlier_versions_keep_their_statuses(
    frame: pd.DataFrame, tmp_path: Path
) -> None:
    # they called answers without an error converged
    exact = frame[frame["label"] == "exact"].assign(status="converged")
    assert exact["std_error"].isna().all()
    write_records(exact, tmp_path)
    assert set(read_records(tmp_path)["status"]) == {"converged"}


def test_frame_of_the_records_is_that_of_compare(tmp_path: Path) -> None:
    write_records(toy_frame(), tmp_path)
    compared = uqfold.compare(
        uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0)
    )  # another problem, the same columns and types
    assert list(read_records(tmp_path).dtypes.items()) == list(compared.dtypes.items())


def test_infinite_criteria_and_binomial_missions_survive(tmp_path: Path) -> None:
    grid = criteria([-math.inf, 12.0, math.inf], [None, 0.0, math.inf], [1, Binomial(3, 0.1)])
    write_records(toy_frame(grid, {"broken": METHODS["broken"]}, referenced=False), tmp_path)
    assert criteria_of(comparison_header(read_records(tmp_path))) == grid


def test_a_header_says_which_source_made_the_rows(tmp_path: Path) -> None:
    """Comparison records use the one provenance."""
    frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    write_records(frame, tmp_path)
    header = comparison_header(read_records(tmp_path))
    method, model = "uqfold.methods.ffni_saddlepoint", "uqfold.problems.series_system"
    assert header["source"] == source_digest(method, model)
    assert "uqfold/moments" in header["source"]
    assert "uqfold/surrogates" not in header["source"]


@settings(max_examples=40)
@given(st.floats(), st.integers(-(2**256), 2**256), st.text())
def test_every_value_survives_strict_json(
    a_row: dict[str, Any], number: float, whole: int, text: str
) -> None:
    sent = {**a_row, "pf": number, "n_evals": whole, "message": text}
    received = without_constants(json.dumps(encoded([sent]), allow_nan=False))
    (read,) = ROWS.validate_python(received, strict=True)
    assert repr(read["pf"]) == repr(math.nan if math.isnan(number) else number)
    assert (read["n_evals"], read["message"]) == (whole, text)


def test_half_a_character_in_a_message_survives(frame: pd.DataFrame, tmp_path: Path) -> None:
    """A model may name a file whose name is no UTF-8: nothing was written, and all was lost."""
    message = "no file caf\udce9.txt"
    csv_file, _ = write_records(frame.assign(message=message), tmp_path)
    assert set(read_records(tmp_path)["message"]) == {message}
    assert r"no file caf\udce9.txt" in csv_file.read_text(encoding="utf-8")


def test_json_is_strict_and_says_its_schema(frame: pd.DataFrame, tmp_path: Path) -> None:
    _, path = write_records(frame, tmp_path)
    document = without_constants(path.read_text(encoding="utf-8"))
    assert document["schema"] == "uqfold-comparison/3"
    assert document["rows"][0]["std_error"] is None
    assert document["rows"][0]["beta"] == "inf"
    assert list(document["versions"]) == [
        "uqfold",
        "python",
        "numpy",
        "scipy",
        "numba",
        "openturns",
    ]


def test_the_published_schema_is_what_checks_a_record(tmp_path: Path) -> None:
    """Records go through one library; the schema is made from the forms that check them."""
    schema = record_schema()
    _, path = write_records(toy_frame(criteria(12.0)), tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    assert set(schema["properties"]) == {*document, "error_parts"}
    assert set(schema["required"]) == set(document) - {"sha256"}
    row = schema["$defs"]["RowForm"]
    assert (row["required"], row["additionalProperties"]) == (list(COLUMNS), False)
    assert {"type": "null"} in row["properties"]["pf"]["anyOf"]
    assert row["properties"]["n_evals"]["type"] == "integer"


def test_the_columns_are_those_of_schema_3() -> None:
    # another list of columns needs another number in the schema, and a new text in docs/records.md
    assert list(COLUMNS) == [
        *("problem", "label", "threshold", "tau", "missions", "missions_planned", "missions_p"),
        *("pf", "reliability", "beta", "std_error", "ci_low", "ci_high", "ci_kind"),
        *("pf_low", "pf_high", "error_kind", "status", "message", "n_evals", "n_evals_row"),
        *("n_reused", "n_failed", "seconds", "method", "seed"),
        *("reference_pf", "reference_std_error", "error"),
    ]


def test_the_header_says_what_the_system_was_and_what_the_methods_state(tmp_path: Path) -> None:
    write_records(toy_frame(), tmp_path)
    header = comparison_header(read_records(tmp_path))
    system = header["system"]
    assert (system["units"], system["structure"], system["dependence"]) == (
        3,
        "Series()",
        "independent",
    )
    assert {one["role"] for one in system["inputs"]} == {"shared", "individual"}
    assert all("Normal(mu = " in one["distribution"] for one in system["inputs"])
    assert "cores" in header["machine"]
    theory = header["methods"][0]["theory"]
    assert theory == json.loads(json.dumps(asdict(METHODS["exact"].theory)))
    assert theory["equations"][0]["latex"] == r"p_f = \mathrm{told}"


def product(x: FloatArray) -> FloatArray:
    return x.prod(axis=1)


def test_the_header_says_by_what_units_differ() -> None:
    units = [uqfold.Unit(offset=1.5, name="stiff"), uqfold.Unit(), uqfold.Unit(offset=-2.0)]
    problem = uqfold.Problem(
        lambda x: x.sum(axis=1), shared={"a": stats.norm()}, individual={"b": stats.norm()},
        units=units,
    )  # fmt: skip
    header = comparison_header(uqfold.compare(problem, ["ffni-pearson"], criteria(3.0)))
    offsets = header["system"]["offsets"]
    assert offsets == dict(zip(problem.unit_names, [1.5, 0.0, -2.0], strict=True))
    assert offsets["stiff"] == 1.5
    assert "models" not in header["system"]


def test_the_header_says_which_unit_has_which_model_and_inputs() -> None:
    mine, wide = (lambda x: x.sum(axis=1)), stats.norm(0, 2)
    units = [uqfold.Unit(mine, individual={"b": wide}, name="wide"), uqfold.Unit(name="usual")]
    problem = uqfold.Problem(
        product, shared={"a": stats.norm()}, individual={"b": stats.norm()}, units=units
    )
    system = comparison_header(uqfold.compare(problem, ["mc"], criteria(3.0), max_evals=40))[
        "system"
    ]
    assert list(system["models"]) == ["wide", "usual"]
    assert system["models"]["usual"] == f"{__name__}.product"
    assert system["models"]["wide"].endswith("which_model_and_inputs.<locals>.<lambda>")
    assert [one["name"] for one in system["inputs"]] == ["a", "b", "b of wide"]


def test_every_column_and_field_is_documented() -> None:
    text = (Path(__file__).parents[2] / "docs" / "records.md").read_text(encoding="utf-8")
    assert [
        name for name in (*COLUMNS, *record_schema()["properties"]) if f"`{name}`" not in text
    ] == []


def test_the_code_in_the_documentation_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (Path(__file__).parents[2] / "docs" / "records.md").read_text(encoding="utf-8")
    code, *_ = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    written = toy_frame()
    write_records(written, tmp_path / "uqfold-results" / "series")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code, names)
    assert len(names["frame"]) == len(written)


def test_csv_holds_the_same_numbers(frame: pd.DataFrame, tmp_path: Path) -> None:
    path, _ = write_records(frame, tmp_path)
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row, written in zip(rows, frame.to_dict("records"), strict=True):
        assert list(row) == list(COLUMNS)
        for name, kind in COLUMNS.items():
            cell: Any = kind(row[name]) if row[name] or kind is str else math.nan
            assert repr(cell) == repr(kind(written[name]))


def damaged(document: dict[str, Any], how: str) -> Any:
    match how:
        case "no object":
            return [document]
        case "other schema":
            return {**document, "schema": "uqfold-comparison/1"}
        case "no schema":
            return {key: value for key, value in document.items() if key != "schema"}
        case "no seed":
            return {key: value for key, value in document.items() if key != "seed"}
        case "other columns":
            return {**document, "columns": document["columns"][:-1]}
        case "text for a number":
            document["rows"][1]["pf"] = "small"
        case "truth for a number":
            document["rows"][1]["pf"] = True
        case "number for a whole one":
            document["rows"][1]["n_evals"] = 1.5
        case "nothing for a text":
            document["rows"][1]["label"] = None
        case "row lacks a column":
            del document["rows"][1]["pf"]
        case "row is a list":
            document["rows"][1] = list(document["rows"][1].values())
        case "rows lost":
            document["rows"].pop()
        case "unknown label":
            document["rows"][-1]["label"] = "stranger"
        case "bad criterion":
            document["criteria"][0]["tau"] = -1.0
        case "method without title":
            del document["methods"][0]["title"]
        case "equation without latex":
            del document["methods"][0]["theory"]["equations"][0]["latex"]
        case "input of two roles":
            document["system"]["inputs"][0]["role"] = ["shared", "individual"]
        case "rows is null":
            document["rows"] = None
    return document


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("no object", "no JSON object"),
        ("other schema", "'uqfold-comparison/1', not 'uqfold-comparison/3'"),
        ("no schema", "its schema is None"),
        ("no seed", "the field seed is missing"),
        ("other columns", "its columns are not those"),
        ("text for a number", "rows[1].pf: Input should be a valid number, not 'small'"),
        ("truth for a number", "rows[1].pf: Input should be a valid number, not True"),
        ("number for a whole one", "rows[1].n_evals: Input should be a valid integer, not 1.5"),
        ("nothing for a text", "rows[1].label: Input should be a valid string, not None"),
        ("row lacks a column", "the field rows[1].pf is missing"),
        ("row is a list", "rows[1]: Input should be a valid dictionary"),
        ("rows lost", "does not have the digest"),
        ("unknown label", "rows of 'stranger', which is none of its methods"),
        ("bad criterion", "tau = -1.0"),
        ("method without title", "title"),
        ("equation without latex", "latex"),
        (
            "input of two roles",
            "role: Input should be a valid string, not ['shared', 'individual']",
        ),
        ("rows is null", "comparison.json is not a readable record"),
    ],
)
def test_a_damaged_record_is_refused_and_the_fault_named(
    how: str, said: str, tmp_path: Path
) -> None:
    _, path = write_records(toy_frame(), tmp_path)
    document = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps(damaged(document, how)), encoding="utf-8")
    with pytest.raises(RecordsError, match=re.escape(said)) as caught:
        read_records(path)
    assert "written by `uqfold compare`" in str(caught.value)
    assert str(tmp_path) not in str(caught.value)


def test_another_number_in_a_record_is_damage(tmp_path: Path) -> None:
    """What is read back is checked by digest."""
    frame = toy_frame()
    _, path = write_records(frame, tmp_path)
    whole = json.loads(path.read_text(encoding="utf-8"))
    changes: list[tuple[str, object]] = [("pf", 0.142), ("n_evals", 99), ("message", "all is well")]
    for name, value in changes:
        document = json.loads(json.dumps(whole))
        assert document["rows"][0][name] != value
        document["rows"][0][name] = value
        path.write_text(json.dumps(document), encoding="utf-8")
        with pytest.raises(RecordsError, match="does not have the digest"):
            read_records(path)
    # laid out in another way it says the same, and earlier versions wrote no digest
    path.write_text(json.dumps(whole, indent=4, ensure_ascii=True), encoding="utf-8")
    assert len(read_records(path)) == len(frame)
    del whole["sha256"]
    path.write_text(json.dumps(whole), encoding="utf-8")
    assert len(read_records(path)) == len(frame)


@pytest.mark.parametrize(
    "text",
    ["", "not json", '{"schema": "uqfold-comparison/2"', '{"schema": NaN}', "label,pf\nmc,1\n"],
)
def test_a_foreign_file_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "comparison.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordsError, match="not a readable record"):
        read_records(path)


def test_a_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "comparison.json"
    path.write_bytes(b"\x80\x04\x95\xff")
    with pytest.raises(RecordsError, match="not a readable record"):
        read_records(path)


def test_a_missing_file_is_said_to_be_missing(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_records(tmp_path / "nowhere.json")


def test_an_interrupted_write_leaves_the_earlier_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    earlier = toy_frame(command="uqfold compare earlier")
    write_records(earlier, tmp_path)

    def fails(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", fails)
    with pytest.raises(KeyboardInterrupt):
        write_records(toy_frame(command="uqfold compare later"), tmp_path)
    monkeypatch.undo()
    assert comparison_header(read_records(tmp_path)) == comparison_header(earlier)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["comparison.csv", "comparison.json"]


def test_an_unfinished_comparison_knows_that_it_is(tmp_path: Path) -> None:
    first = next(run_comparison(toy_problem(), METHODS))
    write_records(first, tmp_path)
    header = comparison_header(read_records(tmp_path))
    assert header["finished"] == ["exact"]
    assert [one["label"] for one in header["methods"]] == list(METHODS)


@pytest.mark.thorough
def test_a_large_comparison_is_written_and_read_in_seconds(tmp_path: Path) -> None:
    """Records of 1e5 rows: the work grows as the rows do."""
    frame = toy_frame(GRID, {"exact": METHODS["exact"]})
    seconds = []
    for rows in (500, 5000):
        large = frame.iloc[[0] * rows].reset_index(drop=True)
        large["threshold"] = np.linspace(1.0, 2.0, rows)
        started = time.process_time()
        write_records(large, tmp_path)
        assert len(read_records(tmp_path)) == rows
        seconds.append(time.process_time() - started)
    assert seconds[1] < 40.0 * max(seconds[0], 0.02)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("1" + "0" * 400, "is too large"),
        ("1e400", "the number 1e400 is too large"),
        ("1" + "0" * 5000, "not a readable record"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a":' * 100_000, "nested too deeply"),
    ],
)
@pytest.mark.parametrize("name", ["pf", "n_evals", "seed", "threshold"])
def test_numbers_and_nesting_that_nobody_can_read_are_told(
    frame: pd.DataFrame, tmp_path: Path, value: str, message: str, name: str
) -> None:
    """Unreadable numbers in records (10**400) and deep nesting: one line, no traceback."""
    write_records(frame, tmp_path)
    path = tmp_path / "comparison.json"
    changed = re.sub(rf'"{name}": [^,\n]+', lambda _: f'"{name}": {value}', path.read_text())
    path.write_text(changed)
    with pytest.raises(RecordsError, match=message) as raised:
        read_records(path)
    assert len(str(raised.value)) < 400
