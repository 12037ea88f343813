"""Running a study: tables, seeds, the cache, a problem of the user's own."""

import math
import re
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest

from uqfold.comparison.studies import (
    ResultsError,
    Study,
    StudyError,
    StudyRunner,
    load_study,
    read_tables,
    results_state,
)
from uqfold.comparison.studies.check import compare_tables
from uqfold.comparison.studies.results import write_record, write_table
from uqfold.comparison.studies.study import RUN_COLUMNS, RUN_IDENTITY
from uqfold.methods import available
from uqfold.problems import series
from uqfold.report.studies import figure_kinds, table_kinds

FILE = """\
schema = "uqfold-study/1"
title = "A study"
question = "How sure are we?"

[problems.series]
case = "series"

[problems.mine]
function = "mine:problem"

[problems.apart]
case = "series"
independent = true

[[run]]
name = "body"
problem = ["series", "mine", "apart"]
methods = ["ffni-spa", "mc"]
thresholds = [0, 2]
max_evals = 4000
seeds = 2

[[analysis]]
name = "gap"
kind = "independence"
problem = "series"
method = "ffni-spa"
units = [1, 4]
thresholds = [0, 2]
"""
MODEL = """\
import openturns as ot
import uqfold

def drift(x):
    return x[:, 0] + x[:, 1]

def problem():
    return uqfold.Problem(
        drift, shared={"a": ot.Normal(0, 1)}, individual={"b": ot.Normal(0, 1)}, units=2,
        name="drift", version="1",
    )
"""


@pytest.fixture
def study(tmp_path: Path) -> Study:
    (tmp_path / "study.toml").write_text(FILE)
    (tmp_path / "mine.py").write_text(MODEL)
    return load_study(tmp_path, figure_kinds(), table_kinds())


def written(runner: StudyRunner, folder: Path) -> dict[str, pd.DataFrame]:
    entries = [write_table(folder, table) for table in runner.tables()]
    write_record(folder, runner.study, "uqfold study run", entries)
    return read_tables(folder, runner.study.columns)


def test_tables_of_all_kinds(study: Study, tmp_path: Path) -> None:
    tables = written(StudyRunner(study), tmp_path)
    body = tables["body"]
    assert list(body.columns) == list(RUN_COLUMNS)
    # mc runs with two seeds, ffni-spa once
    counts = body.groupby(["problem", "label"]).size().to_dict()
    assert counts == {
        (p, m): 2 * n for p in study.problems for m, n in (("ffni-spa", 1), ("mc", 2))
    }
    spa = body[(body["label"] == "ffni-spa") & (body["problem"] == "series")]
    reference = series().references
    assert reference is not None
    assert set(spa["n_evals"]) == {75}
    assert (spa["error"] < 0.05).all()
    # independent units have no reference, and fail more rarely: the one shared input is gone
    apart = body[(body["label"] == "ffni-spa") & (body["problem"] == "apart")]
    assert apart["reference_pf"].isna().all()
    inputs = tables["inputs"]
    assert set(inputs.loc[inputs["problem"] == "apart", "role"]) == {"individual"}
    assert list(inputs.loc[inputs["problem"] == "mine", "input"]) == ["a", "b"]
    gap = tables["gap"]
    one = gap[gap["units"] == 1]
    assert one["difference"].abs().max() < 1e-12
    assert (gap.loc[gap["units"] == 4, "difference"] > 0.0).all()
    # the correlated curve of the analysis is that of the method itself
    assert list(gap.loc[gap["units"] == 4, "pf"]) == pytest.approx(list(spa["pf"]), rel=1e-12)
    assert results_state(study) == "present"


def test_a_second_run_reuses_and_gives_the_same(study: Study, tmp_path: Path) -> None:
    first = list(StudyRunner(study, tmp_path / "cache").tables())
    seen: list[str] = []
    runner = StudyRunner(study, tmp_path / "cache", lambda title, n, expected: seen.append(title))
    second = list(runner.tables())
    assert seen == []
    assert all(table.reused for table in second)
    for one, other in zip(first, second, strict=True):
        assert _same(one.rows, other.rows)
        assert one.n_evals == other.n_evals
    # another model in the user's file: its jobs alone are done again, with the new model
    (tmp_path / "mine.py").write_text(MODEL.replace("+ x[:, 1]", "- 9.0").replace('"1"', '"2"'))
    changed = StudyRunner(
        load_study(tmp_path, figure_kinds(), table_kinds()),
        tmp_path / "cache",
        lambda title, n, expected: seen.append(title),
    )
    body = next(table for table in changed.tables() if table.name == "body")
    assert {title.split(" / ")[1] for title in seen} == {"mine"}
    assert {row["pf"] for row in body.rows if row["problem"] == "mine"} == {0.0}


def test_a_damaged_entry_of_the_cache_is_computed_again_with_a_warning(
    study: Study, tmp_path: Path
) -> None:
    first = list(StudyRunner(study, tmp_path / "cache").tables())
    entries = sorted((tmp_path / "cache" / "jobs").iterdir())
    for path in entries:
        whole = path.read_text(encoding="utf-8")
        digit = re.search(r"(?<=0\.)\d", whole.split("\n")[1])
        assert digit is not None
        at = whole.index("\n") + 1 + digit.start()
        path.write_text(f"{whole[:at]}{9 - int(whole[at])}{whole[at + 1 :]}", encoding="utf-8")
    with pytest.warns(UserWarning, match="is damaged, and left out") as caught:
        second = list(StudyRunner(study, tmp_path / "cache").tables())
    assert len(caught) == len(entries)
    for one, other in zip(first, second, strict=True):
        assert _same(one.rows, other.rows)


def test_interruption_keeps_finished_jobs(study: Study, tmp_path: Path) -> None:
    started: list[str] = []

    def interrupt(title: str, n_evals: int, expected: int | None) -> None:
        if title not in started:
            started.append(title)
        if len(started) == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(StudyRunner(study, tmp_path / "cache", interrupt).tables())
    again: list[str] = []
    list(StudyRunner(study, tmp_path / "cache", lambda t, n, e: again.append(t)).tables())
    assert set(again).isdisjoint(started[:3])
    assert started[3] in again


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("def problem():\n    return 3\n", "gave 3, not a Problem"),
        ("def problem():\n    return 1 / 0\n", "raised ZeroDivisionError: division by zero"),
        ("def problem():\n    raise SystemExit(0)\n", "raised SystemExit: 0"),
        ("raise SystemExit(0)\n", "cannot be imported: SystemExit"),
        ("import nowhere_to_be_found\n", "cannot be imported: ModuleNotFoundError"),
        ("def another():\n    pass\n", "has no function 'problem'"),
    ],
)
def test_a_users_function_that_gives_no_problem(
    study: Study, tmp_path: Path, source: str, words: str
) -> None:
    (tmp_path / "mine.py").write_text(source)
    with pytest.raises(StudyError, match="line 9") as raised:
        list(StudyRunner(study).tables())
    assert words in str(raised.value)


def test_what_failed_is_tried_again(study: Study, tmp_path: Path) -> None:
    source = MODEL.replace("return x[:, 0] + x[:, 1]", "return x[:, 0] * float('nan')")
    (tmp_path / "mine.py").write_text(source)
    seen: list[str] = []
    for _ in range(2):
        seen.clear()
        tables = StudyRunner(study, tmp_path / "cache", lambda t, n, e: seen.append(t)).tables()
        body = next(table for table in tables if table.name == "body")
    mine = [row for row in body.rows if row["problem"] == "mine"]
    assert {row["status"] for row in mine} == {"failed"}
    assert set(seen) == {
        "body / mine / ffni-spa",
        *(f"body / mine / mc / seed {i}" for i in (0, 1)),
    }


def test_sys_exit_in_a_model_is_a_failed_run_of_the_study(study: Study, tmp_path: Path) -> None:
    leaving = "(_ for _ in ()).throw(SystemExit(0)) if (x > 1.0).any() else x.sum(axis=1)"
    source = MODEL.replace("x[:, 0] + x[:, 1]", leaving)
    assert source != MODEL
    (tmp_path / "mine.py").write_text(source)
    body = next(table for table in StudyRunner(study).tables() if table.name == "body")
    mine = [row for row in body.rows if row["problem"] == "mine"]
    assert mine
    assert all("SystemExit: 0" in row["message"] for row in mine)
    assert {row["status"] for row in mine} <= {"failed", "doubtful"}


def test_states_of_results(study: Study, tmp_path: Path) -> None:
    assert results_state(study) == "missing"
    written(StudyRunner(study), tmp_path)
    path = tmp_path / "results" / "body.csv"
    text = path.read_text()
    path.write_text(text.replace("ffni-spa", "ffni_spa"))
    assert results_state(study) == "changed by hand"
    path.unlink()
    assert results_state(study) == "incomplete"
    with pytest.raises(ResultsError, match=r"body\.csv cannot be read"):
        read_tables(tmp_path, study.columns)
    path.write_text(text)
    assert results_state(study) == "present"
    # how it is shown is no part of what was asked
    (tmp_path / "study.toml").write_text(FILE.replace('title = "A study"', 'title = "Another"'))
    assert results_state(load_study(tmp_path, {}, {})) == "present"
    (tmp_path / "study.toml").write_text(FILE.replace("units = [1, 4]", "units = [1, 5]"))
    assert results_state(load_study(tmp_path, {}, {})) == "of another study.toml"


def test_comparison_finds_a_planted_difference(study: Study, tmp_path: Path) -> None:
    body = written(StudyRunner(study), tmp_path)["body"]
    tolerances = {"relative": 1e-6, "absolute": 1e-12, "standard_errors": 5.0}

    def compared(fresh: pd.DataFrame) -> list[str]:
        return compare_tables(body, fresh, RUN_COLUMNS, RUN_IDENTITY, tolerances).differences

    assert compared(body) == []
    changed = body.copy()
    changed.loc[3, "pf"] *= 1.0 + 1e-5
    assert len(compared(changed)) == 1
    # another sample is judged in its standard errors
    mc = body[body["label"] == "mc"].assign(max_evals=9.0, n_evals=9)
    assert compared(mc) == []
    assert compared(mc.assign(pf=mc["pf"] + 8.0 * mc["std_error"])) != []
    assert "not among" in compared(body.assign(threshold=77.0))[0]


def test_a_method_that_chooses_its_runs_is_judged_in_its_errors(
    study: Study, tmp_path: Path
) -> None:
    body = written(StudyRunner(study), tmp_path)["body"]
    tolerances = {"relative": 1e-6, "absolute": 1e-12, "standard_errors": 5.0}
    mc = body[body["label"] == "mc"]

    def compared(shift: float, adaptive: list[str]) -> list[str]:
        fresh = mc.assign(pf=mc["pf"] + shift * mc["std_error"])
        return compare_tables(
            body, fresh, RUN_COLUMNS, RUN_IDENTITY, tolerances, adaptive
        ).differences

    assert compared(1.0, ["mc"]) == []
    assert compared(1.0, ["ffni-spa"]) != []
    assert compared(8.0, ["mc"]) != []
    # of ours, one method chooses its runs by what it has seen
    assert [name for name, method in available().items() if method.adaptive] == ["active-kriging"]
    # what depends on no sample has to be the same
    fresh = mc.assign(reference_pf=0.3)
    assert compare_tables(body, fresh, RUN_COLUMNS, RUN_IDENTITY, tolerances, ["mc"]).differences


def _same(one: tuple[Mapping[str, object], ...], other: tuple[Mapping[str, object], ...]) -> bool:
    def plain(rows: tuple[Mapping[str, object], ...]) -> list[list[object]]:
        return [
            [None if isinstance(v, float) and math.isnan(v) else v for v in row.values()]
            for row in rows
        ]

    return plain(one) == plain(other)
