"""Every case declares what it has to, and every planted fault turns its verdict."""

from pathlib import Path

import pytest

from uqfold.evidence.case import Case, Fault, find_cases
from uqfold.evidence.changes import Changes, changes
from uqfold.evidence.record_file import read_case_record
from uqfold.evidence.runner import Validation, plant

FOLDER = Path(__file__).resolve().parents[2] / "validation"
CASES = {case.name: case for case in find_cases(FOLDER)}

QUICK = {
    "example_2_tail",
    "mechanism_energy",
    "mechanism_limits",
    "openturns_form",
    "paper_independence",
    "sample_sizes",
}
"""Cases whose faults take seconds; the others are slow."""


def _marks(name: str) -> list[pytest.MarkDecorator]:
    return [] if name in QUICK else [pytest.mark.slow]


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        pytest.param(case.name, fault, marks=_marks(case.name), id=f"{case.name}-{fault.name}")
        for case in CASES.values()
        for fault in case.faults
    ],
)
def test_every_planted_fault_turns_the_verdict(name: str, fault: Fault) -> None:
    measurement = plant(CASES[name], fault.name)
    assert measurement.verdict == fault.turns_to, [one.words for one in measurement.findings]


@pytest.mark.parametrize("name", CASES)
def test_every_case_can_turn(name: str) -> None:
    """A case that holds has faults that break it, one that does not a remedy that mends it."""
    verdict = read_case_record(FOLDER / name / "quick.json").verdict
    assert {fault.turns_to for fault in CASES[name].faults} - {verdict}


@pytest.mark.parametrize("name", [pytest.param(name, marks=_marks(name)) for name in CASES])
def test_the_kept_verdict_comes_out_again(name: str, tmp_path: Path) -> None:
    case: Case = CASES[name]
    record = Validation("quick", tmp_path).run(case)
    assert record.error == ""
    assert changes(read_case_record(case.folder / "quick.json"), record) == Changes()


@pytest.mark.parametrize("name", CASES)
def test_kept_records_belong_to_their_case(name: str) -> None:
    case = CASES[name]
    record = read_case_record(case.folder / "quick.json")
    assert (record.name, record.claim, record.tier) == (name, case.claim, "quick")
    assert [fault.name for fault in record.faults] == [fault.name for fault in case.faults]
    # every declared fault was planted when the record was made, and noticed
    assert all(fault.caught for fault in record.faults)
