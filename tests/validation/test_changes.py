"""What counts as changed since the kept record."""

import pytest

from tests.validation.records import claims_record, full_record
from uqfold.validation import CaseRecord, Measurement
from uqfold.validation.case import Fault
from uqfold.validation.findings import Finding
from uqfold.validation.kept import changes
from uqfold.validation.record import PlantedFault


def record(*findings: Finding, **more: object) -> CaseRecord:
    fields: dict[str, object] = {"tier": "quick", **more}
    return full_record(measurement=Measurement(findings), **fields)


KEPT = Finding("error", 0.2, 1.0)


@pytest.mark.parametrize(
    ("now", "verdicts"),
    [
        ([KEPT], []),
        ([Finding("error", 0.9, 2.0)], []),
        ([KEPT, Finding("more", 1.0)], []),
        (
            [Finding("error", 1.2, 1.0)],
            [
                "the verdict was 'holds' and is 'does not hold'",
                "error was 'holds' and is 'does not hold'",
            ],
        ),
        (
            [Finding("error", 0.2)],
            [
                "the verdict was 'holds' and is 'cannot be judged'",
                "error was 'holds' and is 'quoted only'",
            ],
        ),
        ([], ["the verdict was 'holds' and is 'cannot be judged'"]),
    ],
)
def test_what_counts_as_changed(now: list[Finding], verdicts: list[str]) -> None:
    assert changes(record(KEPT), record(*now)) == tuple(verdicts)


def test_what_could_not_be_measured_or_noticed_is_broken() -> None:
    failed = record(error="ValueError: no")
    assert failed.broken == ("could not be measured: ValueError: no",)
    # it has no verdict that could have changed
    assert changes(record(KEPT), failed) == ()
    blind = (PlantedFault(Fault("wrong sign", "the response negated"), "holds"),)
    found = record(KEPT, faults=blind)
    assert found.broken == ("the planted fault 'wrong sign' went unnoticed",)
    assert changes(record(KEPT), found) == ()


def test_without_a_kept_record_a_case_is_expected_to_hold() -> None:
    assert changes(None, record(KEPT)) == ()
    assert changes(None, record(Finding("error", 1.2, 1.0)))


def test_a_claim_that_has_turned_is_named() -> None:
    kept, now = claims_record(), claims_record(rise=0.5)
    found = changes(kept, now)
    assert found == (
        "the verdict on 'first' was 'holds' and is 'does not hold'",
        "first: largest rise was 'holds' and is 'does not hold'",
    )
    assert changes(kept, kept) == ()
