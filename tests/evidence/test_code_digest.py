from pathlib import Path

import pytest

from tests.evidence.case_folder import make_case
from uqfold.evidence.code_digest import changed_parts, code_digests

USES_A_FILE = "from uqfold.moments.saddlepoint import SaddlepointDistribution\n"


def parts(cases: Path, imports: str) -> dict[str, str]:
    folder = cases / "a_case"
    if not folder.exists():
        make_case(cases)
    (folder / "measure.py").write_text(imports, encoding="utf-8")
    return code_digests(folder)


def test_only_what_is_imported_counts(cases: Path) -> None:
    own = f"{cases.name}/a_case"
    assert set(parts(cases, "import math\n")) == {own}
    assert set(parts(cases, "from uqfold.mechanism import WingParameters\n")) == {
        own,
        "uqfold/mechanism",
    }
    # a room that is imported as a whole counts with everything that it can load lazily
    everything = parts(cases, "from uqfold.methods import available\n")
    assert {"uqfold/methods", "uqfold/system", "uqfold/evaluation", "uqfold/surrogates"} <= set(
        everything
    )
    # within a function it counts as well, for types only it does not
    assert "uqfold/methods" in parts(cases, "def f():\n    from uqfold.methods import available\n")
    for_types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import uqfold.methods\n"
    assert set(parts(cases, for_types)) == {own}


def test_the_frame_makes_no_numbers(cases: Path) -> None:
    frame = (
        "from uqfold.evidence import Measurement\nfrom uqfold.comparison.findings import number\n"
        "from uqfold.checks import whole\n"
    )
    assert set(parts(cases, frame)) == {f"{cases.name}/a_case"}


def test_references_count_with_the_problems(cases: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = parts(cases, "from uqfold.problems.wing import folding_wing\n")
    read = Path.read_bytes

    def changed(path: Path) -> bytes:
        return read(path) + (b"\n" if path.name == "folding_wing.json" else b"")

    monkeypatch.setattr(Path, "read_bytes", changed)
    assert changed_parts(before, code_digests(cases / "a_case")) == ("uqfold/problems",)


def test_a_change_is_named_by_its_part(cases: Path) -> None:
    before = parts(cases, USES_A_FILE)
    assert changed_parts(before, before) == ()
    helper = cases / "shared" / "helper.py"
    helper.parent.mkdir()
    helper.write_text("x = 1\n", encoding="utf-8")
    with_helper = parts(cases, f"{USES_A_FILE}from {cases.name}.shared.helper import x\n")
    shared, own = f"{cases.name}/shared", f"{cases.name}/a_case"
    assert changed_parts(before, with_helper) == (own, shared)
    helper.write_text("x = 2\n", encoding="utf-8")
    assert changed_parts(with_helper, code_digests(cases / "a_case")) == (shared,)


def test_data_of_the_case_counts_but_its_records_do_not(cases: Path) -> None:
    before = parts(cases, "import math\n")
    folder = cases / "a_case"
    (folder / "quick.json").write_text("{}", encoding="utf-8")
    (folder / "case.toml").write_text("", encoding="utf-8")
    assert code_digests(folder) == before
    (folder / "times.csv").write_text("1", encoding="utf-8")
    assert changed_parts(before, code_digests(folder)) == (f"{cases.name}/a_case",)


def test_declared_data_counts(cases: Path) -> None:
    before = parts(cases, "import math\n")
    results = cases.parent / "studies" / "one"
    results.mkdir(parents=True)
    (results / "curves.csv").write_text("1", encoding="utf-8")
    with_data = code_digests(cases / "a_case", ["studies/one"])
    assert changed_parts(before, with_data) == ("studies/one",)
    (results / "curves.csv").write_text("2", encoding="utf-8")
    again = code_digests(cases / "a_case", ["studies/one"])
    assert changed_parts(with_data, again) == ("studies/one",)
