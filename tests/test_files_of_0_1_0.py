"""Stores, session files, records and studies of 0.1.0 are converted or refused by name.

The files in `of_0_1_0` were written by its code (commit 8d22bd2; the first record of a comparison
by e89d0ba), for the problem of `spring` and the command
``uqfold compare series --method ffni-spa --method mc --threshold 0,3 --tau none,12``.
"""

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

import uqfold
from studies import runner
from uqfold.comparison import RecordsError, comparison_header, read_records, write_records
from uqfold.evaluation import Store
from uqfold.methods import session_file
from uqfold.report import write_report
from uqfold.validation import RecordError, read_case_record

FILES = Path(__file__).parent / "of_0_1_0"


def spring() -> uqfold.Problem:
    """Return the problem of the store and the session, whose model answered 1.5 a + b then."""
    return uqfold.Problem(
        lambda x: 2.0 * x[:, 0] + x[:, 1],
        shared={"a": uqfold.inputs.normal(0, 1)},
        individual={"b": uqfold.inputs.normal(0, 1)},
        units=2,
        name="spring",
        version="1",
        default_criteria=uqfold.criteria(3.0),
    )


@pytest.mark.parametrize("problem", [uqfold.problems.series(), spring()], ids=lambda one: one.name)
def test_nothing_in_a_store_is_taken_for_a_response_of_the_present_model(
    problem: uqfold.Problem, tmp_path: Path
) -> None:
    """0.1.0 told models apart by less: `spring` of today has its name, version and rows."""
    path = tmp_path / "store.db"
    shutil.copy(FILES / "store.db", path)
    method = uqfold.methods.FFNISaddlepoint()
    alone = method.estimate(problem)
    with Store(path) as store:
        kept = len(store)
        assert kept == 90
        answer = method.estimate(problem, evaluator=uqfold.Evaluator(store=store))
        assert len(store) == kept + answer.n_evals
    assert answer[0].n_reused == 0
    np.testing.assert_array_equal(answer.pf, alone.pf)


def test_a_session_is_read_and_its_method_of_other_settings_refused_by_name() -> None:
    """Kriging of 0.1.0 had no target for its error: what it asked for may differ from today's."""
    path = FILES / "session.npz"
    saved = session_file.read(path)
    assert saved.told.all()
    np.testing.assert_allclose(saved.y, 1.5 * saved.x[:, 0] + saved.x[:, 1], rtol=1e-12)
    method = uqfold.methods.Kriging(runs=16, trend="linear", kernel="gaussian")
    with pytest.raises(ValueError, match=r"belongs to another run: its method is .*runs=16.*here"):
        method.resume(path, spring(), uqfold.criteria(3.0), rng=3)


def test_a_record_is_read_and_written_again(tmp_path: Path) -> None:
    written = json.loads((FILES / "comparison.json").read_text(encoding="utf-8"))
    assert written["schema"] == "uqfold-comparison/2"
    frame = read_records(FILES / "comparison.json")
    pf = [math.nan if row["pf"] is None else row["pf"] for row in written["rows"]]
    np.testing.assert_array_equal(frame["pf"], pf)
    header = comparison_header(frame)
    assert header["finished"] == ["ffni-spa", "mc"]
    assert (header["source"], header["versions"]) == ({}, written["versions"])
    write_records(frame, tmp_path)
    assert read_records(tmp_path).equals(frame)
    write_report(frame, tmp_path / "report.html")


@pytest.mark.parametrize(
    ("file", "schema", "command"),
    [
        ("first-comparison.json", "uqfold-comparison/1", "compare"),
        ("study/results/record.json", "uqfold-study-results/1", ""),
        ("validation-case.json", "uqfold-validation/1", "validate"),
    ],
)
def test_what_is_not_converted_is_refused_by_name(
    file: str, schema: str, command: str, tmp_path: Path
) -> None:
    """And the command that makes it again is named."""
    remedy = f".*run it again with `uqfold {command}`" if command else ""
    for read, kind in ((read_records, RecordsError), (read_case_record, RecordError)):
        with pytest.raises(kind, match=f"its schema is '{schema}', not"):
            read(FILES / file)
    with pytest.raises(ValueError, match=f"its schema is '{schema}', not{remedy}"):
        write_report(FILES / file, tmp_path / "report.html")


def test_a_study_is_not_drawn_anew() -> None:
    """Its record has neither source nor machine, and its tables other columns."""
    with pytest.raises(ValueError, match=r"'uqfold-study-results/1', not .*: run the study again"):
        runner.read_run(FILES / "study", {})
