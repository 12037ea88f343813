import sys
from pathlib import Path

import pytest

from tests.validation.case_folder import DECLARED, make_case
from uqfold.validation.case import Case, CaseError, Fault, find_cases, load_cases
from uqfold.validation.runner import measuring


def load_case(folder: Path) -> Case:
    [case] = load_cases(folder)
    return case


def test_a_case_is_read(cases: Path) -> None:
    case = load_case(make_case(cases))
    assert (case.name, case.declared.claim, case.declared.seeds) == ("a_case", "It is so.", (7,))
    assert case.faults == (Fault("too large", "a value of 3"),)
    assert case.needs == ()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'schema = "uqfold-case/1"',
            'schema = "uqfold-case/2"',
            "its schema is not 'uqfold-case/1'",
        ),
        ("tolerance =", "tolerances =", "tolerances is not a field here: do you mean 'tolerance'?"),
        ('source = "mathematics"\n', "", "the field source is missing"),
        ('"exact solution"', '"exact"', "kind: Input should be 'paper claim', .*, not 'exact'"),
        ("[7]", "[-7]", r"seeds\[0\]: Input should be greater than or equal to 0, not"),
        ('title = "A case"', 'title = ""', "title: String should have at least 1 character"),
        ('what = "a value of 3"', "", r"the field faults\[0\].what is missing"),
        ("seeds = [7]", "seeds = [7", "case.toml: "),
    ],
)
def test_what_is_wrong_with_a_case_is_named(cases: Path, old: str, new: str, message: str) -> None:
    assert old in DECLARED
    folder = make_case(cases, declared=DECLARED.replace(old, new))
    with pytest.raises(CaseError, match=message):
        load_case(folder)


def test_a_case_without_a_fault_is_refused(cases: Path) -> None:
    folder = make_case(cases, declared=DECLARED.partition("[[fault]]")[0] + "fault = []\n")
    with pytest.raises(CaseError, match="faults: "):
        load_case(folder)


def test_two_faults_of_one_name_are_refused(cases: Path) -> None:
    twice = DECLARED + DECLARED[DECLARED.index("[[fault]]") :]
    with pytest.raises(CaseError, match="two faults have the same name"):
        load_case(make_case(cases, declared=twice))


def test_reading_a_case_does_not_import_it(cases: Path) -> None:
    case = load_case(make_case(cases, measure="raise SystemExit(9)"))
    with pytest.raises(SystemExit):
        measuring(case)


def test_a_case_has_to_measure(cases: Path) -> None:
    case = load_case(make_case(cases, measure="measured = 1"))
    with pytest.raises(CaseError, match=r"a_case/measure.py defines no function measure\(work\)"):
        measuring(case)


def test_a_folder_of_another_name_on_the_path_is_not_taken_for_the_case(tmp_path: Path) -> None:
    case = load_case(make_case(tmp_path / "json"))
    with pytest.raises(CaseError, match="Python finds another module 'json': rename the folder"):
        measuring(case)
    # workers, which are given the path, must not find it before Python's own either
    assert sys.path.index(str(tmp_path)) == len(sys.path) - 1
    sys.path.remove(str(tmp_path))


def test_cases_are_found_in_order_and_by_name(cases: Path) -> None:
    make_case(cases, "b")
    make_case(cases, "a")
    make_case(cases, "c", DECLARED.replace('"methods"', '"examples"'))
    (cases / "shared").mkdir()
    assert [case.name for case in find_cases(cases)] == ["c", "a", "b"]
    assert [case.name for case in find_cases(cases, ["b", "b"])] == ["b"]
    with pytest.raises(CaseError, match="no validation case is named 'ab': do you mean"):
        find_cases(cases, ["ab"])
    with pytest.raises(CaseError, match="holds no validation cases"):
        find_cases(cases / "shared")


def test_a_folder_may_declare_several_cases(cases: Path) -> None:
    several = (
        DECLARED
        + """
[[case]]
name = "body"
settings = { part = "body" }

[[case]]
name = "tail"
title = "The tail"

[[case.fault]]
name = "remedy"
what = "a finer method"
turns_to = "holds"
"""
    )
    make_case(cases, "both", several)
    body, tail = find_cases(cases)
    assert (body.name, body.declared.title, body.settings) == ("body", "A case", {"part": "body"})
    assert (tail.name, tail.declared.title, tail.settings) == ("tail", "The tail", {})
    assert [fault.name for fault in body.faults + tail.faults] == ["too large", "remedy"]
    assert body.kept("quick").name == "body.quick.json"
    assert measuring(body) is measuring(tail)
