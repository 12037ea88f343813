"""Methods, problems, results and comparisons are plain records: copied, pickled, changed."""

import copy
import pickle
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import uqfold
from uqfold.methods import available, build
from uqfold.problems import folding_wing, series

COPIES: list[Callable[[Any], Any]] = [
    copy.copy,
    copy.deepcopy,
    lambda one: pickle.loads(pickle.dumps(one)),
]
each_copy = pytest.mark.parametrize("copied", COPIES, ids=["copy", "deepcopy", "pickle"])


@pytest.mark.parametrize("name", list(available()))
def test_a_method_is_its_settings(name: str) -> None:
    """They are listed by `fields`, changed by `replace`, and all that a copy has."""
    method = build(name)
    settings = {field.name: getattr(method, field.name) for field in fields(method)}
    assert type(method)(**settings) == method == replace(method)
    for copied in COPIES:
        assert copied(method) == method
    if "target_cov" in settings:
        other = replace(method, target_cov=0.03)
        assert (other.target_cov, other == method) == (0.03, False)
        assert copy.deepcopy(other) == other


@each_copy
@pytest.mark.parametrize("make", [series, folding_wing])
def test_a_copied_problem_is_the_same(copied: Callable[[Any], Any], make: Any) -> None:
    """Its references are still its own, and it can be changed."""
    problem, again = make(), copied(make())
    assert str(again) == str(problem)
    assert again.references == problem.references
    u = np.zeros((1, problem.inputs.dimension))
    x = problem.inputs.from_standard_normal(u)
    np.testing.assert_array_equal(again.inputs.from_standard_normal(u), x)
    assert replace(again, units=7).n_units == 7
    assert replace(again, units=7).references is None
    assert replace(again, name="other").references is not None


@each_copy
def test_a_copied_result_says_the_same(copied: Callable[[Any], Any]) -> None:
    problem = series()
    result = uqfold.methods.FFNIPearson(check=False).estimate(problem, 2.0, rng=1)
    assert repr(copied(result)) == repr(result)
    frame = uqfold.compare(problem, {"base": uqfold.methods.FFNIPearson(check=False)}, 2.0)
    again = copied(frame)
    pd.testing.assert_frame_equal(again, frame)
    assert again.attrs == frame.attrs
    assert repr(again) == repr(frame)
