"""The analysis `scatter`: what it measures on models whose scatter is known."""

import textwrap
from pathlib import Path

import numpy as np
import pytest

from uqfold.comparison.studies.loading import load_study
from uqfold.comparison.studies.runner import StudyRunner, StudyTable
from uqfold.comparison.studies.steps.scatter import Nudged

HEAD = """
schema = "uqfold-study/1"
title = "Scatter"
question = "How much?"
[problems.series]
case = "series"
[[analysis]]
name = "scatter"
kind = "scatter"
problem = "series"
method = "ffni-pearson"
thresholds = [0, 2]
tau = ["none", 16]
missions = [1, 5]
"""


def table(folder: Path, keys: str) -> StudyTable:
    (folder / "study.toml").write_text(HEAD + textwrap.dedent(keys), encoding="utf-8")
    return list(StudyRunner(load_study(folder, {}, {})).tables())[-1]


def test_scatter_of_a_smooth_model_grows_with_the_nudge(tmp_path: Path) -> None:
    keys = 'input = "X3"\nrelative = [1e-6, 1e-3]\nrepeats = 8'
    small, large = (
        [row for row in table(tmp_path, keys).rows if row["relative"] == relative]
        for relative in (1e-6, 1e-3)
    )
    assert len(small) == len(large) == 2 * 2 * 2
    for one, other in zip(small, large, strict=True):
        assert one["pf"] == other["pf"]
        assert 0.0 < one["pf_std"] < 1e-4 * one["pf"]
        # a smooth response: the scatter is proportional to the nudge
        assert other["pf_std"] == pytest.approx(1e3 * one["pf_std"], rel=0.05)
        assert one["pf_low"] < one["pf_mean"] < one["pf_high"]
        assert one["pf_mean"] == pytest.approx(one["pf"], rel=1e-4)
        assert one["repeats"] == 8


def test_one_repeat_and_an_unknown_input_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="repeats = 1: give at least 2"):
        table(tmp_path, 'input = "X3"\nrelative = 1e-6\nrepeats = 1')
    with pytest.raises(ValueError, match="'series' has no input 'C_r', only X1, X2, X3"):
        table(tmp_path, 'input = "C_r"\nrelative = 1e-6')


def first(x: np.ndarray) -> np.ndarray:
    return x[:, 0]


def test_a_row_is_nudged_alike_in_any_batch_and_by_the_stated_amount() -> None:
    x = np.random.default_rng(1).uniform(1.0, 2.0, (4000, 3))
    nudged = Nudged(first, 0, 1e-3, seed=5)
    whole = nudged(x)
    np.testing.assert_array_equal(whole[1000:1010], nudged(x[1000:1010]))
    change = whole / x[:, 0] - 1.0
    assert change.std() == pytest.approx(1e-3, rel=0.05)
    assert abs(change.mean()) < 5e-3 / np.sqrt(4000)
    assert (Nudged(first, 0, 1e-3, seed=6)(x) != whole).all()
    np.testing.assert_array_equal(Nudged(first, 1, 1e-3, seed=5)(x), x[:, 0])
