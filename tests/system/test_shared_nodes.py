"""Shared nodes of redundant systems: what many units make of their failures is steep."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import binom

from uqfold import Criterion, KOutOfN, Problem
from uqfold.inputs import normal
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import reliability_indices
from uqfold.system.surface_layout import laid_out
from uqfold.typing import FloatArray

V = np.linspace(-12.0, 12.0, 4001)
DENSITY = np.exp(-0.5 * V**2) / math.sqrt(2.0 * math.pi) * (V[1] - V[0])


@pytest.mark.parametrize(
    ("shared", "units", "works", "threshold"),
    [
        # 0 with five nodes, and no doubt
        pytest.param(0.4, 200, 100, 1.9, marks=pytest.mark.thorough),
        (0.4, 20, 1, 0.9),
        (0.2, 50, 25, 0.6),
        (0.8, 40, 20, 3.0),
        (0.6, 8, 2, 3.0),  # 0.7 % off at four stated errors
    ],
)
def test_failure_far_out_in_the_shared_input_is_found(
    shared: float, units: int, works: int, threshold: float
) -> None:
    own = math.sqrt(1.0 - shared**2)

    def surface(u: FloatArray) -> FloatArray:
        return np.asarray(shared * u[:, 0] + own * u[:, 1])

    problem = Problem(
        surface,
        shared=normal(0, 1),
        individual=normal(0, 1),
        units=units,
        structure=KOutOfN(works),
    )
    p = ndtr((shared * V - threshold) / own)
    exact = float(binom.sf(units - works, units, p) @ DENSITY)
    assert 1e-9 < exact < 1e-2
    asked = [Criterion(threshold)]
    system = laid_out(surface, 2, 1, SystemUnits.of(problem), asked)
    responses = system.responses(surface)
    found = system.failures_given(responses, asked)
    error = float(system.integration_errors(responses, asked)[0])
    density = math.exp(-0.5 * float(reliability_indices(found)[0]) ** 2) / math.sqrt(2.0 * math.pi)
    assert abs(found[0].pf - exact) < error * density
    assert found[0].pf == pytest.approx(exact, rel=3e-3)
