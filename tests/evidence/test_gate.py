import pytest

from tests.evidence.records import full_record
from uqfold.comparison.findings import Finding
from uqfold.evidence import CaseRecord, Measurement
from uqfold.evidence.gate import differences


def record(*findings: Finding, **changes: object) -> CaseRecord:
    return full_record(measurement=Measurement(findings), stored=None, **changes)


KEPT = Finding("error", 0.2, 1.0)


@pytest.mark.parametrize(
    ("now", "said"),
    [
        ([KEPT], []),
        ([Finding("error", 0.5, 1.0)], []),
        ([Finding("error", 0.01, 1.0)], []),
        ([Finding("error", 0.7, 1.0)], ["error: lost 62.5 % of its margin"]),
        ([Finding("error", 1.2, 1.0)], ["the verdict was 'holds' and is", "error: was 'holds'"]),
        ([Finding("error", 0.2, 2.0)], ["error: the limit has changed"]),
        ([Finding("error", 0.2)], ["the verdict was 'holds' and is 'cannot", "error: was 'holds'"]),
        ([KEPT, Finding("more", 1.0)], ["more: not measured before"]),
        ([], ["the verdict was", "error: no longer measured"]),
    ],
)
def test_what_counts_as_changed(now: list[Finding], said: list[str]) -> None:
    found = differences(record(KEPT), record(*now))
    assert len(found) == len(said), found
    for line, expected in zip(found, said, strict=True):
        assert line.startswith(expected)


def test_a_lower_limit_has_its_margin_above() -> None:
    order = Finding("order", 4.0, 3.8, at_least=True)
    assert differences(record(order), record(Finding("order", 4.5, 3.8, at_least=True))) == []
    found = differences(record(order), record(Finding("order", 3.85, 3.8, at_least=True)))
    assert found[0].startswith("order: lost 75 % of its margin")


def test_a_limit_just_kept_has_no_margin_to_lose() -> None:
    zero = Finding("loss", 0.0, 0.0, at_least=True)
    assert differences(record(zero), record(zero)) == []


def test_speeds_are_compared_by_verdict_only() -> None:
    before = record(KEPT, kind="benchmark")
    assert differences(before, record(Finding("error", 0.9, 1.0), kind="benchmark")) == []
    assert differences(before, record(Finding("error", 1.1, 1.0), kind="benchmark")) != []


def test_what_could_not_be_measured_has_changed() -> None:
    assert differences(record(KEPT), record(error="ValueError: no")) == [
        "could not be measured: ValueError: no"
    ]
