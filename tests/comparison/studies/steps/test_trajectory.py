"""The analysis `trajectory`: the table, and settings that are refused."""

import textwrap
from pathlib import Path

import numpy as np
import pytest

from uqfold.comparison.studies.document import StudyError
from uqfold.comparison.studies.loading import load_study
from uqfold.comparison.studies.runner import StudyRunner
from uqfold.comparison.studies.steps.trajectory import NAMES
from uqfold.mechanism import WingParameters, motion_table

HEAD = """
schema = "uqfold-study/1"
title = "Wing"
question = "How?"
[problems]
[[analysis]]
name = "wing"
kind = "trajectory"
"""


def written(folder: Path, keys: str) -> Path:
    (folder / "study.toml").write_text(HEAD + textwrap.dedent(keys), encoding="utf-8")
    return folder


def test_table_is_the_motion_of_the_wing_that_is_asked_for(tmp_path: Path) -> None:
    keys = 'parameters = { C_r = 0.001, k_d = 600, contact_law = "flores-2011" }\ntolerance = 1e-6'
    study = load_study(written(tmp_path, keys), {}, {})
    *_, table = StudyRunner(study).tables()
    wing = WingParameters(C_r=0.001, k_d=600.0, contact_law="flores-2011")
    expected = motion_table(wing, tolerance=1e-6)
    assert list(NAMES) == list(expected)
    assert list(table.columns) == ["step", *expected]
    assert [row["step"] for row in table.rows] == list(range(len(expected["time"])))
    for name, column in expected.items():
        got = [row[name] for row in table.rows]
        np.testing.assert_allclose(got, column, rtol=5.1e-7, atol=0.0)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("parameters = 3", "3 is no table of parameters"),
        ("parameters = { C_rr = 0.001 }", "no such parameter of the wing; .*C_r"),
        ("parameters = { C_r = 0.02 }", "C_r = 0.02 m leaves no journal"),
        ("parameters = { C_r = true }", "True is no number"),
        ("tolerance = 0", "0: give a number above 0"),
    ],
)
def test_bad_settings_are_refused_with_their_place(tmp_path: Path, keys: str, message: str) -> None:
    with pytest.raises(StudyError, match=message) as caught:
        load_study(written(tmp_path, keys), {}, {})
    assert "study.toml" in str(caught.value)
    assert "line 9" in str(caught.value)
