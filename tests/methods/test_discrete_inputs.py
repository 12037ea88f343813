"""Every method on discrete inputs: the right answer, or why there is none, before any run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import poisson as poisson_law

import uqfold
from uqfold.inputs import bernoulli, censored, normal, poisson
from uqfold.methods import available, build

THRESHOLD = 7.0
RUNS = 6_000


def _response(x: Any) -> Any:
    gust, cracks, load = x.T
    return 3.0 * gust + cracks + load


def _coarse(x: Any) -> Any:
    return _response(x) - 0.1 * x[:, 1]


def storm(units: int = 2) -> uqfold.Problem:
    """Return units that a gust hits together, each with cracks of its own."""
    return uqfold.Problem(
        _response,
        shared={"gust": bernoulli(0.1)},
        individual={"cracks": poisson(2.0), "load": normal(0.0, 1.0)},
        units=units,
        low_fidelity=_coarse,
    )


def pf_of_storm(units: int = 2) -> float:
    """Return the probability that one unit or more exceeds the threshold: sums over all values."""
    k = np.arange(60)
    p = [poisson_law(2.0).pmf(k) @ ndtr(-(THRESHOLD - 3.0 * gust - k)) for gust in (0.0, 1.0)]
    return sum(w * -math.expm1(units * math.log1p(-q)) for w, q in zip((0.9, 0.1), p, strict=True))


@pytest.mark.parametrize("name", available())
def test_every_method_is_right_or_says_why_not(name: str) -> None:
    asked: list[int] = []

    def counted(x: Any) -> Any:
        asked.append(len(x))
        return _response(x)

    problem = uqfold.Problem(
        counted, inputs=storm().inputs, units=2, low_fidelity=storm().low_fidelity
    )
    row = build(name).estimate(problem, THRESHOLD, max_evals=RUNS, rng=1)[0]
    if row.status == "unsupported":
        assert "cracks" in row.message or "gust" in row.message
        assert not asked
        return
    truth = pf_of_storm()
    assert row.status in ("converged", "doubtful", "budget_exhausted"), row.message
    assert row.std_error > 0.0
    assert abs(row.pf - truth) <= 4.0 * row.std_error
    assert row.std_error < 0.5 * truth


def test_an_input_that_is_cut_off_has_no_steps_and_is_open_to_more_methods() -> None:
    snow = censored(normal(-1.0, 1.0), low=0.0)
    problem = uqfold.Problem(
        lambda x: x[:, 0] + x[:, 1], individual={"snow": snow, "load": normal(0.0, 0.5)}
    )
    grid = np.linspace(-9.0, 9.0, 4_001)
    density = np.exp(-0.5 * grid**2) / math.sqrt(2.0 * math.pi) * (grid[1] - grid[0])
    truth = float(density @ ndtr(-(3.0 - np.maximum(0.0, grid - 1.0)) / 0.5))
    row = build("line-sampling").estimate(problem, 3.0, max_evals=2_000, rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - truth) <= max(4.0 * row.std_error, 2e-3 * truth)
    refused = build("ffni").estimate(problem, 3.0, rng=1)[0]
    assert refused.status == "unsupported"
    assert "no Gauss rule for snow" in refused.message
