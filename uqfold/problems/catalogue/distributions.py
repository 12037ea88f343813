"""Inputs that limit states of the literature share, by mean and standard deviation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.inputs import normal
from uqfold.typing import FloatArray


def standard_normals(n: int) -> dict[str, Any]:
    """Return x1 to xn, independent standard normals."""
    return dict.fromkeys((f"x{i}" for i in range(1, n + 1)), normal(0.0, 1.0))


def lognormal_parameters(mean: float, std: float) -> tuple[float, float]:
    """Return mean and standard deviation of the logarithm of a lognormal variable."""
    variance = math.log1p((std / mean) ** 2)
    return math.log(mean) - 0.5 * variance, math.sqrt(variance)


def lognormal(mean: float, std: float) -> Any:
    """Return a lognormal distribution of that mean and standard deviation."""
    from scipy.stats import lognorm

    mu, sigma = lognormal_parameters(mean, std)
    return lognorm(sigma, scale=math.exp(mu))


def gumbel_parameters(mean: float, std: float) -> tuple[float, float]:
    """Return mode and scale of a Gumbel variable (of maxima)."""
    scale = std * math.sqrt(6.0) / math.pi
    return mean - 0.5772156649015329 * scale, scale


def gumbel(mean: float, std: float) -> Any:
    """Return a Gumbel distribution (of maxima) of that mean and standard deviation."""
    from scipy.stats import gumbel_r

    mode, scale = gumbel_parameters(mean, std)
    return gumbel_r(mode, scale)


def lognormal_of(u: FloatArray, mean: float, std: float) -> FloatArray:
    """Return a lognormal variable (n,) as a function of a standard-normal one (n,)."""
    mu, sigma = lognormal_parameters(mean, std)
    return np.exp(mu + sigma * u)
