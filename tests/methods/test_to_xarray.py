"""Results as grids of xarray, where it is installed."""

import numpy as np
import pytest

import uqfold
from uqfold.problems import series
from uqfold.problems.criterion import Binomial

pytest.importorskip("xarray")


def result(grid: uqfold.Criteria) -> uqfold.ReliabilityResult:
    return uqfold.methods.FFNIPearson(check=False).estimate(series(), grid, rng=1)


def test_a_result_is_a_grid() -> None:
    asked = uqfold.criteria([0.0, 2.0, 4.0], tau=[None, 16.0], missions=[1, Binomial(10, 0.7)])
    answers = result(asked)
    grid = answers.to_xarray()
    assert dict(grid.sizes) == {"threshold": 3, "tau": 2, "missions": 2}
    for criterion, row in zip(asked, answers, strict=True):
        tau = np.inf if criterion.tau is None else criterion.tau
        at = {"threshold": criterion.threshold, "tau": tau, "missions": str(criterion.missions)}
        assert float(grid["pf"].sel(at)) == row.pf
        assert str(grid["status"].sel(at).item()) == row.status
    assert (grid.attrs["method"], grid.attrs["seed"]) == ("ffni-pearson", 1)


def test_what_does_not_differ_is_no_dimension_and_gaps_are_nan() -> None:
    one = result(uqfold.criteria([0.0, 2.0], missions=5)).to_xarray()
    assert dict(one.sizes) == {"threshold": 2}
    assert (one.attrs["missions"], one.attrs["tau"]) == ("5", np.inf)
    some = uqfold.Criteria([uqfold.Criterion(0.0), uqfold.Criterion(2.0, missions=2)])
    assert np.isnan(result(some).to_xarray()["pf"]).sum() == 2
    with pytest.raises(ValueError, match="one was asked twice"):
        result(uqfold.Criteria([*some, *some])).to_xarray()
