"""What counts as changed since the kept record, and what is only said."""

import pytest

from tests.validation.records import claims_record, full_record
from uqfold.validation import CaseRecord, Measurement
from uqfold.validation.case import Fault
from uqfold.validation.findings import Finding
from uqfold.validation.kept import Changes, changes
from uqfold.validation.record import PlantedFault


def record(*findings: Finding, **more: object) -> CaseRecord:
    fields: dict[str, object] = {"tier": "quick", **more}
    return full_record(measurement=Measurement(findings), **fields)


KEPT = Finding("error", 0.2, 1.0)


@pytest.mark.parametrize(
    ("now", "verdicts", "others"),
    [
        ([KEPT], [], []),
        ([Finding("error", 0.5, 1.0)], [], []),
        ([Finding("error", 0.01, 1.0)], [], []),
        ([Finding("error", 0.7, 1.0)], [], ["error: lost 62.5 % of its margin"]),
        (
            [Finding("error", 1.2, 1.0)],
            ["the verdict was 'holds' and is", "error: was 'holds'"],
            [],
        ),
        ([Finding("error", 0.2, 2.0)], [], ["error: the limit has changed"]),
        (
            [Finding("error", 0.2)],
            ["the verdict was 'holds' and is 'cannot", "error: was 'holds'"],
            ["error: the limit has changed"],
        ),
        ([KEPT, Finding("more", 1.0)], [], ["more: not measured before"]),
        ([], ["the verdict was"], ["error: no longer measured"]),
    ],
)
def test_what_counts_as_changed(now: list[Finding], verdicts: list[str], others: list[str]) -> None:
    found = changes(record(KEPT), record(*now))
    for said, expected in ((found.verdicts, verdicts), (found.others, others)):
        assert len(said) == len(expected), found
        for line, start in zip(said, expected, strict=True):
            assert line.startswith(start)
    assert found.broken == ()


def test_a_lower_limit_has_its_margin_above() -> None:
    order = Finding("order", 4.0, 3.8, at_least=True)
    better = record(Finding("order", 4.5, 3.8, at_least=True))
    assert changes(record(order), better) == Changes()
    found = changes(record(order), record(Finding("order", 3.85, 3.8, at_least=True)))
    assert found.others[0].startswith("order: lost 75 % of its margin")


def test_a_limit_just_kept_has_no_margin_to_lose() -> None:
    zero = Finding("loss", 0.0, 0.0, at_least=True)
    assert changes(record(zero), record(zero)) == Changes()


def test_speeds_are_compared_by_verdict_only() -> None:
    before = record(KEPT, kind="benchmark")
    assert changes(before, record(Finding("error", 0.9, 1.0), kind="benchmark")) == Changes()
    assert changes(before, record(Finding("error", 1.1, 1.0), kind="benchmark")).verdicts


def test_what_could_not_be_measured_or_noticed_is_broken() -> None:
    found = changes(record(KEPT), record(error="ValueError: no"))
    assert found == Changes(broken=("could not be measured: ValueError: no",))
    blind = (PlantedFault(Fault("wrong sign", "the response negated"), "holds"),)
    found = changes(record(KEPT), record(KEPT, faults=blind))
    assert found == Changes(broken=("the planted fault 'wrong sign' went unnoticed",))


def test_without_a_kept_record_a_case_is_expected_to_hold() -> None:
    assert changes(None, record(KEPT)) == Changes()
    assert changes(None, record(Finding("error", 1.2, 1.0))).verdicts


def test_what_another_tier_cannot_judge_has_not_changed() -> None:
    kept = record(KEPT, tier="full")
    assert changes(kept, record(Finding("error", 0.2), tier="default")) == Changes()
    found = changes(kept, record(Finding("error", 1.2, 1.0), tier="default"))
    assert found.verdicts == ("the verdict was 'holds' (full tier) and is 'does not hold'",)


def test_a_claim_that_has_turned_is_named() -> None:
    kept, now = claims_record(), claims_record(rise=0.5)
    found = changes(kept, now)
    assert found.verdicts[0] == "the verdict on 'first' was 'holds' and is 'does not hold'"
    assert found.verdicts[1].startswith("first: largest rise: was 'holds'")
    assert changes(kept, kept) == Changes()
