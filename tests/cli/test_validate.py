"""The command `uqfold validate`, on small cases."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from tests.validation.case_folder import DECLARED, MEASURE, make_case
from tests.validation.conftest import cases
from uqfold.cli import main

__all__ = ["cases"]


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["validate", *map(str, words)])
    return int(ended.value.code or 0)


@pytest.fixture
def three(cases: Path) -> Path:
    make_case(cases, "a")
    make_case(cases, "b", DECLARED.replace('"methods"', '"examples"'))
    make_case(cases, "c", measure=MEASURE.replace("else 1.0", "else 2.5"))
    return cases


def test_what_does_not_hold_is_said(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run("--quick", "--cases", three, "--out", out) == 1
    text = capsys.readouterr().out
    lines = [line.split() for line in text.splitlines()]
    assert [line[1] for line in lines[1:4]] == ["b", "a", "c"]
    assert "3 cases: 2 holds, 1 does not hold" in text
    assert "- value: 2.5 (at most 2) - does not hold" in text
    assert "2 of 3 cases have the kept verdicts" in text
    assert "c: changed: does not hold, and no record of another verdict is kept" in text
    assert sorted(path.name for path in out.glob("*.json")) == ["a.json", "b.json", "c.json"]


def test_all_that_hold_give_exit_code_0(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("a", "b", "--faults", "--cases", three, "--out", tmp_path / "out") == 0
    assert "2 of 2 planted faults noticed" in capsys.readouterr().out
    record = json.loads((tmp_path / "out" / "a.json").read_text(encoding="utf-8"))
    assert (record["tier"], record["verdict"]) == ("quick", "holds")


def forget(cases: Path) -> None:
    """Import the cases anew, as a new process does after an edit of the same size."""
    for kept in cases.rglob("__pycache__"):
        shutil.rmtree(kept)
    for name in [one for one in sys.modules if one.startswith(f"{cases.name}.")]:
        del sys.modules[name]


def test_exit_code_is_0_while_every_verdict_is_the_kept_one_and_1_when_one_changed(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--quick", "--cases", three, "--out", tmp_path / "out")
    # the former verdicts are none, so that "does not hold" becomes the kept one
    assert run(*words, "--update", "--faults") == 0
    assert "1 does not hold" in capsys.readouterr().out
    assert run(*words) == 0
    said = capsys.readouterr().out
    assert "1 does not hold" in said
    assert "kept records: every verdict is the kept one" in said
    (three / "a" / "measure.py").write_text(MEASURE.replace("else 1.0", "else 2.5"))
    forget(three)
    assert run(*words) == 1
    said = capsys.readouterr().out
    assert "2 of 3 cases have the kept verdicts" in said
    assert "a: changed: the verdict was 'holds' and is 'does not hold'" in said
    assert run(*words, "--update", "--no-faults") == 0
    assert run(*words) == 0


def test_exit_code_is_2_when_something_broke(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--quick", "--cases", three, "--out", tmp_path / "out")
    run(*words, "--update", "--no-faults")
    (three / "b" / "measure.py").write_text("def measure(work):\n    raise ValueError('gone')\n")
    # a verdict that has changed besides weighs less
    (three / "a" / "measure.py").write_text(MEASURE.replace("else 1.0", "else 2.5"))
    forget(three)
    capsys.readouterr()
    assert run(*words) == 2
    said = capsys.readouterr().out
    assert "1 of 3 cases have the kept verdicts" in said
    assert "b: broken: could not be measured: ValueError: gone" in said
    (three / "a" / "measure.py").write_text(MEASURE.replace('== "too large"', '== "none"'))
    forget(three)
    assert run("a", *words, "--faults") == 2


def test_check_measures_nothing(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("a", "--cases", three, "--check") == 1
    assert "a: no record of the full tier is kept" in capsys.readouterr().err
    for tier in ("--quick", "--full"):
        run("a", "--cases", three, "--out", tmp_path / "out", tier, "--update")
        # kept records say whether the faults were noticed
        record = json.loads((three / "a" / f"{tier[2:]}.json").read_text(encoding="utf-8"))
        assert {fault["verdict"] for fault in record["faults"]} == {"does not hold"}
    assert run("a", "--cases", three, "--check") == 0
    assert "1 case: records, code and claims belong together" in capsys.readouterr().err
    # the same records, drawn by other code
    report = three / "report.md"
    report.write_text(report.read_text(encoding="utf-8") + "An older sentence.\n")
    assert run("a", "--cases", three, "--check") == 1
    said = capsys.readouterr().err
    assert "report.md: the report is not what this code draws from the records, remake it" in said
    with pytest.raises(SystemExit):
        main(said.split("remake it: uqfold ")[1].split())
    assert run("a", "--cases", three, "--check") == 0


def test_only_what_is_stale_is_measured(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--quick", "--faults", "--update", "--stale", "--cases", three, "--out", tmp_path)
    assert run("a", "b", *words) == 0
    assert "2 of 2 cases have no current record of the quick tier" in capsys.readouterr().err
    (three / "b" / "measure.py").write_text(MEASURE + "X = 1\n")
    assert run("a", "b", *words) == 0
    said = capsys.readouterr()
    assert "1 of 2 cases have no current record" in said.err
    assert "1 case: 1 holds" in said.out
    with pytest.raises(SystemExit):
        main(["validate", "a", "b", *map(str, words)])
    assert "0 of 2 cases have no current record" in capsys.readouterr().err


def test_cases_are_listed(three: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["validate", "--list", "--cases", str(three)])
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == ["topic", "case", "kind", "faults", "title"]
    assert [line.split()[1] for line in lines] == ["b", "a", "c"]


def test_programs_get_json(three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The list, what a check finds, and verdicts with what changed; exit codes are the same."""
    words = ("--cases", three, "--json")
    assert run("--list", *words) == 0
    assert [one["case"] for one in json.loads(capsys.readouterr().out)] == ["b", "a", "c"]
    assert run("a", "--check", *words) == 1
    assert "no record" in json.loads(capsys.readouterr().out)["a"][0]
    assert run(*words, "--out", tmp_path / "out") == 1
    told = json.loads(capsys.readouterr().out)
    assert [one["verdict"] for one in told["cases"]] == ["holds", "holds", "does not hold"]
    assert "does not hold, and no record" in told["cases"][2]["changed"][0]
    with pytest.raises(SystemExit):
        main(["report", str(tmp_path / "out"), "--json"])
    assert json.loads(capsys.readouterr().out)["report"].endswith("report.html")


def test_an_interruption_keeps_what_is_finished(
    three: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (three / "c" / "measure.py").write_text("def measure(work):\n    raise KeyboardInterrupt\n")
    assert run("--full", "--cases", three, "--out", tmp_path / "out") == 130
    said = capsys.readouterr()
    assert "interrupted: 2 of 3 cases are finished and kept; to go on: uqfold validate" in said.err
    assert "2 cases: 2 holds" in said.out
    assert sorted(path.name for path in (tmp_path / "out").glob("*.json")) == ["a.json", "b.json"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["d"], "no validation case is named 'd'"),
        (["--quick", "--full"], "give one of them"),
        (["--cases", "nowhere"], "nowhere holds no validation cases"),
    ],
)
def test_bad_words_are_refused(
    three: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    given = words if "--cases" in words else [*words, "--cases", str(three)]
    assert run(*given) == 2
    assert message in capsys.readouterr().err
