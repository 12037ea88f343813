"""Cases measured side by side in worker processes, speeds alone."""

import multiprocessing
import os
from pathlib import Path

import pytest

from tests.validation.case_folder import DECLARED, MEASURE, make_case
from uqfold.validation import side_by_side as module
from uqfold.validation.case import Case, Tier, find_cases
from uqfold.validation.record import CaseRecord
from uqfold.validation.runner import Validation
from uqfold.validation.side_by_side import side_by_side

WHERE = MEASURE.replace('Finding("seed", work.seeds[0])', 'Finding("process", os.getpid())')


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WORTH", 1)


def measured(found: list[Case], folder: Path, tier: Tier = "quick") -> dict[str, CaseRecord]:
    pairs = side_by_side(Validation(tier, folder), found, lambda: None)
    return {case.name: record for case, record in pairs}


def test_few_cases_speeds_and_the_full_tier_are_not_for_workers(
    cases: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_case(cases, "speed", DECLARED.replace('"exact solution"', '"benchmark"'))
    assert measured(find_cases(cases), tmp_path) == {}
    make_case(cases, "a")
    assert measured(find_cases(cases), tmp_path, "full") == {}
    monkeypatch.setattr(module, "WORTH", 2)
    assert measured(find_cases(cases), tmp_path) == {}


def test_workers_measure_what_one_process_measures(cases: Path, tmp_path: Path) -> None:
    measure = "import os\n" + WHERE
    names = ["a", "b", "c"]
    for name in names:
        broken = measure if name != "b" else "def measure(work):\n    raise ValueError('gone')\n"
        make_case(cases, name, measure=broken)
    records = measured(find_cases(cases), tmp_path)
    assert sorted(records) == names
    assert records["b"].error == "ValueError: gone"
    assert records["a"].verdict == records["c"].verdict == "holds"
    assert records["a"].findings[1].value != os.getpid()
    assert sorted(path.name for path in tmp_path.glob("*.json")) == ["a.json", "b.json", "c.json"]


def test_an_interruption_ends_the_workers(cases: Path, tmp_path: Path) -> None:
    make_case(cases, "a", measure="import time\n\ndef measure(work):\n    time.sleep(600)\n")
    before = multiprocessing.active_children()

    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(side_by_side(Validation("quick", tmp_path), find_cases(cases), interrupted))
    assert multiprocessing.active_children() == before
