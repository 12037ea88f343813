from pathlib import Path

from tests.validation.case_folder import DECLARED, MEASURE, make_case
from tests.validation.records import full_record
from uqfold.provenance import source_digest
from uqfold.validation.case import Case, load_cases
from uqfold.validation.kept import discrepancies, fingerprint
from uqfold.validation.record import read_case_record, write_case_record
from uqfold.validation.runner import FRAME, Validation, changed_since, sources


def kept_case(cases: Path, out: Path) -> Case:
    [case] = load_cases(make_case(cases))
    for tier in ("quick", "full"):
        record = Validation(tier, out, faults=True).run(case)  # type: ignore[arg-type]
        write_case_record(record, case.kept(tier))  # type: ignore[arg-type]
    return case


def test_what_belongs_together(cases: Path, tmp_path: Path) -> None:
    assert discrepancies(kept_case(cases, tmp_path)) == []


def test_missing_and_damaged_records(cases: Path, tmp_path: Path) -> None:
    case = kept_case(cases, tmp_path)
    (case.folder / "full.json").unlink()
    (case.folder / "quick.json").write_text("{}")
    damaged, missing = discrepancies(case)
    assert "quick.json is not a readable record" in damaged
    assert missing == "no record of the full tier is kept"


def test_other_code_and_another_claim(cases: Path, tmp_path: Path) -> None:
    case = kept_case(cases, tmp_path)
    (case.folder / "measure.py").write_text(MEASURE + "X = 1\n")
    (case.folder / "case.toml").write_text(DECLARED.replace("[7]", "[8]"))
    found = discrepancies(*load_cases(case.folder))
    assert [line for line in found if "the case has changed since: seeds" in line]
    assert [line for line in found if f"with other code ({cases.name}/a_case, seeds)" in line]
    assert [line for line in found if "uqfold validate a_case --full --update" in line]


def test_records_of_another_tier_and_missed_faults(cases: Path, tmp_path: Path) -> None:
    blind = MEASURE.replace('3.0 if work.fault == "too large" else 1.0', "1.0")
    [case] = load_cases(make_case(cases, measure=blind))
    record = Validation("quick", tmp_path, faults=True).run(case)
    for tier in ("quick", "full"):
        write_case_record(record, case.kept(tier))  # type: ignore[arg-type]
    found = discrepancies(case)
    assert "full.json holds a record of the quick tier" in found
    assert "quick.json: the planted fault 'too large' went unnoticed" in found


def test_a_fingerprint_is_that_of_what_records_say(tmp_path: Path) -> None:
    first, second = full_record(), full_record(name="another")
    mark = fingerprint([first, second])
    assert mark == fingerprint([second, first])
    assert mark != fingerprint([first])
    read = read_case_record(write_case_record(first, tmp_path / "a.json"))
    assert fingerprint([read]) == fingerprint([first])


def test_words_make_no_measurement_stale(cases: Path, tmp_path: Path) -> None:
    """Editing a help text makes no measurement stale."""
    case = kept_case(cases, tmp_path)
    measure = case.folder / "measure.py"
    measure.write_text(f'"""Words."""\n\n# more words\n{MEASURE}')
    (case.folder / "case.toml").write_text(DECLARED.replace('"A case"', '"Another title"'))
    [case] = load_cases(case.folder)
    record = read_case_record(case.kept("full"))
    assert changed_since(record, case) == ()
    (case.folder / "times.csv").write_text("1", encoding="utf-8")
    assert changed_since(record, case) == (f"{cases.name}/a_case",)


def test_declared_data_count_and_records_do_not(cases: Path, tmp_path: Path) -> None:
    data = cases.parent / "studies" / "one"
    data.mkdir(parents=True)
    (data / "curves.csv").write_text("1", encoding="utf-8")
    declared = DECLARED.replace("seeds = [7]", 'seeds = [7]\ndata = ["studies/one"]')
    [case] = load_cases(make_case(cases, declared=declared))
    record = Validation("quick", tmp_path).run(case)
    write_case_record(record, case.kept("quick"))
    assert changed_since(record, case) == ()
    (data / "curves.csv").write_text("2", encoding="utf-8")
    assert changed_since(record, case) == ("studies/one",)


def test_drawing_and_printing_rooms_do_not_count(cases: Path) -> None:
    imports = "from uqfold.methods import available\nfrom uqfold.validation import Finding\n"
    [case] = load_cases(make_case(cases, measure=imports))
    parts = set(source_digest(*sources(case), without=FRAME))
    assert {"uqfold/methods", "uqfold/system", "uqfold/evaluation"} <= parts
    assert not parts & {"uqfold/plots", "uqfold/report", "uqfold/cli", "uqfold/validation"}
