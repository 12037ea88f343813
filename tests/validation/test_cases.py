"""Every case declares what it has to, and every planted fault turns its verdict."""

from pathlib import Path

import pytest

from uqfold.validation.case import Case, Fault, find_cases
from uqfold.validation.kept import changes
from uqfold.validation.record import read_case_record
from uqfold.validation.runner import Validation, verdict_with

FOLDER = Path(__file__).resolve().parents[2] / "validation"
CASES = {case.name: case for case in find_cases(FOLDER)}

QUICK = {"example_2_tail"}
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
    assert verdict_with(fault, CASES[name]) == fault.turns_to


@pytest.mark.parametrize("name", CASES)
def test_every_case_can_turn(name: str) -> None:
    """A case that holds has faults that break it, one that does not a remedy that mends it."""
    record = read_case_record(CASES[name].kept("quick"))
    if not record.claims:
        assert {fault.turns_to for fault in CASES[name].faults} - {record.verdict}
    for key, verdict in record.claims.items():
        own = {fault.turns_to for fault in CASES[name].faults if key in fault.claims}
        assert own - {verdict}, key


@pytest.mark.parametrize("name", [pytest.param(name, marks=_marks(name)) for name in CASES])
def test_the_kept_verdict_comes_out_again(name: str, tmp_path: Path) -> None:
    case: Case = CASES[name]
    record = Validation("quick", tmp_path).run(case)
    assert record.error == ""
    assert changes(read_case_record(case.kept("quick")), record) == ()


@pytest.mark.parametrize("name", CASES)
def test_kept_records_belong_to_their_case(name: str) -> None:
    case = CASES[name]
    record = read_case_record(case.kept("quick"))
    kept = (record.name, record.case.claim, record.case.seeds, record.tier)
    assert kept == (name, case.declared.claim, case.declared.seeds, "quick")
    assert tuple(one.fault for one in record.faults) == case.faults
    # every declared fault was planted when the record was made, and noticed
    assert all(one.caught for one in record.faults)
