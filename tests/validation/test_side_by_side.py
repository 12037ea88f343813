"""Cases measured side by side in worker processes, speeds alone."""

import multiprocessing
import os
from pathlib import Path

import pytest

from tests.validation.case_folder import DECLARED, MEASURE, make_case
from uqfold.validation import side_by_side as module
from uqfold.validation.case import find_cases
from uqfold.validation.runner import Validation
from uqfold.validation.side_by_side import for_workers, side_by_side

WHERE = MEASURE.replace('Finding("seed", work.seeds[0])', 'Finding("process", os.getpid())')


def kept(root: Path, name: str, declared: str = DECLARED, measure: str = MEASURE) -> None:
    [case] = find_cases(root, [make_case(root, name, declared, measure).name])
    Validation("quick", case.folder).run(case)
    (case.folder / f"{name}.json").rename(case.folder / "quick.json")


def test_short_work_and_speeds_are_not_for_workers(
    cases: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "b"):
        kept(cases, name)
    kept(cases, "speed", DECLARED.replace('"exact solution"', '"benchmark"'))
    make_case(cases, "new")
    found = find_cases(cases)
    assert for_workers(found, "quick") == []
    monkeypatch.setattr(module, "WORTH", 0.0)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    assert sorted(case.name for case in for_workers(found, "quick")) == ["a", "b"]
    assert for_workers(found, "full") == []
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    assert for_workers(found, "quick") == []


def test_workers_measure_what_one_process_measures(cases: Path, tmp_path: Path) -> None:
    measure = "import os\n" + WHERE
    names = ["a", "b", "c"]
    for name in names:
        broken = measure if name != "b" else "def measure(work):\n    raise ValueError('gone')\n"
        make_case(cases, name, measure=broken)
    found = find_cases(cases)
    records = {
        case.name: record
        for case, record in side_by_side(Validation("quick", tmp_path), found, lambda: None)
    }
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
