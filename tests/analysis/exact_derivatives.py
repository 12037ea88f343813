"""Exact derivatives of pf for linear responses of normal inputs, by the chain rule."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from uqfold.problems.criterion import Criterion
from uqfold.testing import LinearNormalSystem

_STEP = 1e-3

# U and W carry 0.6 and 0.8 of the individual part
_SHARE = {"U": 0.6, "W": 0.8}


def exact_derivative(
    system: LinearNormalSystem, criterion: Criterion, name: str, moment: str
) -> float:
    """d pf / d moment of one input.

    A mean shifts the response, a standard deviation s scales its part: that of the individual
    inputs is sqrt(0.36 s_U^2 + 0.64 s_W^2). The derivatives of pf by mean and standard deviations
    of the response are differences of fourth order of the exact pf, good to about 1e-9.
    """
    if moment == "mean":
        inner = system.shared_std if name == "V" else system.individual_std * _SHARE[name]
        return inner * _by(system, criterion, "mean")
    if name == "V":
        return system.shared_std * _by(system, criterion, "shared_std")
    return _SHARE[name] ** 2 * system.individual_std * _by(system, criterion, "individual_std")


@cache
def _by(system: LinearNormalSystem, criterion: Criterion, field: str) -> float:
    value = getattr(system, field)
    pf = {k: replace(system, **{field: value + k * _STEP}).pf(criterion) for k in (-2, -1, 1, 2)}
    return (8.0 * (pf[1] - pf[-1]) - (pf[2] - pf[-2])) / (12.0 * _STEP)
