from pathlib import Path

import pytest

from tests.validation.case_folder import DECLARED, MEASURE, make_case
from uqfold.validation.case import Case, Fault, load_cases
from uqfold.validation.findings import Finding
from uqfold.validation.record import read_case_record
from uqfold.validation.runner import Validation, verdict_with

COUNTED = """import pathlib
COUNT = pathlib.Path(__file__).with_name("count.txt")


def measure(work):
    from uqfold.validation.findings import Finding
    from uqfold.validation import Measurement
    COUNT.write_text(COUNT.read_text() + "x" if COUNT.exists() else "x")
    return Measurement([Finding("value", 1.0, 2.0)])
"""


def load_case(folder: Path) -> Case:
    [case] = load_cases(folder)
    return case


def counts(case: Case) -> int:
    return len((case.folder / "count.txt").read_text())


def test_a_record_says_all_that_the_case_declares(cases: Path, tmp_path: Path) -> None:
    case = load_case(make_case(cases))
    told: list[tuple[str, int, int | None]] = []
    validation = Validation("quick", tmp_path / "out", progress=lambda *what: told.append(what))
    record = validation.run(case)
    assert read_case_record(tmp_path / "out" / "a_case.json") == record
    assert (record.verdict, record.case, record.tier) == ("holds", case.declared, "quick")
    assert record.made["command"] == "uqfold validate a_case --quick"
    assert record.findings == (Finding("value", 1.0, 2.0), Finding("seed", 7.0))
    assert [fault.verdict for fault in record.faults] == [None]
    assert set(record.made["source"]) == {f"{cases.name}/a_case"}
    assert told == [("a_case", 0, None)]


def test_faults_are_planted_where_asked_for(cases: Path, tmp_path: Path) -> None:
    case = load_case(make_case(cases))
    record = Validation("default", tmp_path, faults=True).run(case)
    assert [fault.caught for fault in record.faults] == [True]
    assert record.verdict == "holds"


@pytest.mark.parametrize("spoilt", ["value = 1.0", "raise ValueError('no')"])
def test_a_fault_that_goes_unnoticed_is_recorded(cases: Path, tmp_path: Path, spoilt: str) -> None:
    measure = MEASURE.replace('value = 3.0 if work.fault == "too large" else 1.0', "value = 1.0")
    measure = measure.replace("    return", f"    if work.fault:\n        {spoilt}\n    return")
    record = Validation("quick", tmp_path, faults=True).run(
        load_case(make_case(cases, measure=measure))
    )
    assert record.broken == ("the planted fault 'too large' went unnoticed",)
    assert record.error == ""


def test_each_claim_of_a_fault_has_to_turn(cases: Path) -> None:
    measure = """from uqfold.validation import Claim, Finding, Measurement


def measure(work):
    claims = [Claim(key, "It is so.", "Section 1", "always") for key in ("first", "second")]
    rise = 3.0 if work.fault else 1.0
    findings = [Finding("rise", rise, 2.0, claim="first"), Finding("end", 1.0, 2.0, claim="second")]
    return Measurement(findings, claims=claims)
"""
    case = load_case(make_case(cases, measure=measure))
    for claims, verdict in (((), "does not hold"), (("first",), "does not hold"),
                            (("first", "second"), "holds")):  # fmt: skip
        assert verdict_with(Fault("risen", "a rise of 3", claims=claims), case) == verdict


def test_an_error_is_part_of_the_record(cases: Path, tmp_path: Path) -> None:
    case = load_case(make_case(cases, measure="def measure(work):\n    return 1 / 0\n"))
    record = Validation("quick", tmp_path).run(case)
    assert (record.verdict, record.error) == (
        "cannot be judged",
        "ZeroDivisionError: division by zero",
    )
    assert read_case_record(tmp_path / "a_case.json").error == record.error


def test_an_interruption_is_none(cases: Path, tmp_path: Path) -> None:
    case = load_case(make_case(cases, measure="def measure(work):\n    raise KeyboardInterrupt\n"))
    with pytest.raises(KeyboardInterrupt):
        Validation("quick", tmp_path).run(case)
    assert not list(tmp_path.glob("*.json"))


def test_a_missing_package_is_told_before_anything_runs(cases: Path, tmp_path: Path) -> None:
    declared = DECLARED.replace("seeds = [7]", 'seeds = [7]\nneeds = ["no_such_package"]')
    case = load_case(make_case(cases, declared=declared, measure=COUNTED))
    record = Validation("full", tmp_path).run(case)
    assert record.error == ("the full tier needs no_such_package: pip install 'uqfold[validation]'")
    assert not (case.folder / "count.txt").exists()
    assert Validation("quick", tmp_path).run(case).error == ""


def test_a_full_run_goes_on_where_it_was_interrupted(cases: Path, tmp_path: Path) -> None:
    case = load_case(make_case(cases, measure=COUNTED))
    first = Validation("full", tmp_path).run(case)
    assert (Validation("full", tmp_path).run(case), counts(case)) == (first, 1)
    # a shorter tier always measures
    Validation("quick", tmp_path / "quick").run(case)
    assert counts(case) == 2
    # and so does the full one after the code, or what the case declares, has changed
    (case.folder / "data.csv").write_text("1")
    Validation("full", tmp_path).run(case)
    assert counts(case) == 3
    (case.folder / "case.toml").write_text(DECLARED.replace("[7]", "[8]"))
    Validation("full", tmp_path).run(load_case(case.folder))
    assert counts(case) == 4
