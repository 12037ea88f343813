import dataclasses

import pytest

from tests.evidence.records import full_record
from uqfold.comparison.findings import Finding
from uqfold.evidence import Measurement, PlantedFault, StoredResult

BROKEN = (Finding("more", 3.0, 2.0),)
LATER = "2025-12-31T00:00:00+00:00"


def test_verdict_rests_on_this_tier_and_on_the_full_one_of_the_same_code() -> None:
    record = full_record()
    assert record.verdict == "holds"
    current = StoredResult(LATER, True, (), BROKEN, 60.0, "x86_64")
    assert full_record(stored=current).verdict == "does not hold"
    outdated = dataclasses.replace(current, current=False, changed=("uqfold/mechanism",))
    assert full_record(stored=outdated).verdict == "holds"
    assert full_record(stored=outdated).judged == record.findings
    assert full_record(stored=None, measurement=Measurement(BROKEN)).verdict == "does not hold"


def test_the_full_tier_judges_what_a_shorter_one_cannot() -> None:
    near, other = Finding("more", 1.9, 2.0, uncertainty=0.5), Finding("less", 1.9, 2.0)
    record = full_record(measurement=Measurement((near, other)))
    assert record.stored is not None
    assert record.verdict == "holds"
    assert record.judged == (other, *record.stored.findings)
    assert full_record(measurement=Measurement((near, other)), stored=None).verdict != "holds"
    coarse = dataclasses.replace(record.stored, findings=(near,))
    assert full_record(measurement=record.measurement, stored=coarse).verdict != "holds"


def test_a_measurement_that_ended_in_an_error_judges_nothing() -> None:
    record = full_record(error="ValueError: no data", measurement=Measurement(()))
    assert record.verdict == "cannot be judged"


def test_faults_that_went_unnoticed() -> None:
    missed = PlantedFault("biased", "1e-5 s late", "holds")
    unjudged = PlantedFault("coarse", "100 times the tolerance", "cannot be judged")
    record = full_record(faults=(*full_record().faults, missed, unjudged))
    assert [fault.caught for fault in record.faults] == [True, None, False, False]
    assert record.missed_faults == (missed, unjudged)


def test_everything_is_frozen() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        full_record().claim = "Something else."  # type: ignore[misc]
