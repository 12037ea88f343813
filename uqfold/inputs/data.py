"""Inputs of which there are measured values: these smoothed, or a family that they allow."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from uqfold.checks import array, choice, or_none, raised, real, refused, several
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.counts import listed
from uqfold.typing import FloatArray

_FEWEST, _MOST = 10, 10_000
_SAMPLES, _LEVEL = 199, 0.01
"""Samples of a fit that its test draws, and the probability of refusing the right family."""
_LEAK = 0.1
"""What smoothing may put beyond zero where all values are on one side: a share of one value."""
_LARGEST = 1e50
"""Of values, and of what divides one: powers of these are still numbers."""
_RESOLVED = 1e-9
"""Standard deviation of values, relative to the largest: rounding is a millionth of it."""


def from_data(
    data: ArrayLike,
    family: str | None = None,
    bounds: tuple[float, float] = (-math.inf, math.inf),
) -> Any:
    """Return the distribution of an input of which there are measured values.

    Parameters
    ----------
    data
        The values (n,), 10 to 10,000 of them, independent of each other.
    family
        ``normal``, ``lognormal``, ``weibull``, ``gamma``, ``exponential`` (these start at zero),
        ``gumbel`` or ``logistic``: fitted by maximum likelihood, and refused where the data
        contradict it. ``discrete``: the values as they are, each as often as it was seen. None: no
        family, the values themselves, smoothed by normal kernels.
    bounds
        Where the smoothed distribution ends, as (0.0, math.inf); only without a family.

    Returns
    -------
    openturns.Distribution
        What `uqfold.Problem` takes as an input.

    Raises
    ------
    TypeError, ValueError
        If there are too few or too many values, less than half of them differ without the family
        ``discrete``, they are too large or too small for powers, or differ by little more than
        rounding does, one lies outside the bounds, smoothing would reach beyond zero where all
        values are on one side of it, or a family is contradicted: an Anderson-Darling test with
        fitted parameters (their effect found by refitting 199 samples of the fit) refuses it at
        the level 1 %.

    Notes
    -----
    n values say little of probabilities below 1/n: there the smoothed distribution falls off as
    its kernels do, and a fitted one as its family does, which no test on n values can confirm. Of
    ``discrete`` data nothing occurs that was not seen.
    Where many values lie near a bound, smoothing moves the mean away from it, by some percent.
    The uncertainty of what was fitted is not part of any error that a method states.

    Examples
    --------
    >>> import numpy as np
    >>> thickness = np.random.default_rng(1).normal(2.0, 0.1, size=50)
    >>> print(from_data(thickness, "normal"))
    Normal(mu = 1.99639, sigma = 0.088113)
    """
    values = array("data", data, ("n",))
    if not _FEWEST <= len(values) <= _MOST:
        raise refused("data", values, f"give {_FEWEST} to {_MOST:,} values, not {len(values)}")
    seen, times = np.unique(values, return_counts=True)
    if family != "discrete" and 2 * len(seen) < len(values):
        remedy = 'as of something discrete: give family="discrete", or a distribution of your own'
        raise refused("data", values, f"only {len(seen)} of {len(values)} values differ, {remedy}")
    if family != "discrete":
        _check_size(values)
    ends = several("bounds", bounds, real, finite=False)
    if len(ends) != 2:
        raise refused("bounds", bounds, "give two, a lower and an upper one")
    low, high = ends
    known = [*_FAMILIES, "discrete"]
    if or_none("family", family, choice, known) is None:
        return as_openturns(_smoothed(values, low, high))
    if math.isfinite(low) or math.isfinite(high):
        raise refused("bounds", bounds, "a family has its own, give bounds without a family")
    if family == "discrete":
        if len(seen) < 2:
            raise refused("data", values, "all are the same: that is no random input")
        return listed(seen, times / len(values))
    return as_openturns(_fitted(values, str(family)))


def _check_size(values: FloatArray) -> None:
    """Refuse values whose powers, or whose differences, are no numbers to rely on."""
    largest = float(np.abs(values).max())
    if not 1.0 / _LARGEST <= largest <= _LARGEST:
        remedy = f"give them in another unit, the largest one {1.0 / _LARGEST:g} to {_LARGEST:g}"
        raise refused("data", values, remedy)
    if values.std() < _RESOLVED * largest:
        remedy = f"they differ by less than {_RESOLVED:g} of the largest: give differences instead"
        raise refused("data", values, remedy)


def _smoothed(values: FloatArray, low: float, high: float) -> Any:
    from uqfold.inputs.smoothed import SmoothedData

    if not (low <= values.min() and values.max() <= high and low < high):
        raise refused("bounds", (low, high), "give bounds around all values")
    smooth = SmoothedData(values, low, high)
    below = float(smooth.uncut(np.zeros(1))[0])
    for side, beyond, wrong in ((1.0, below, low < 0.0), (-1.0, 1.0 - below, high > 0.0)):
        if wrong and (side * values > 0.0).all() and beyond * len(values) > _LEAK:
            remedy = "give bounds=(0, inf)" if side > 0.0 else "give bounds=(-inf, 0)"
            lost = f"smoothing puts {100.0 * beyond:.2g} % on the other side of zero"
            raise refused("data", values, f"{lost}: {remedy}, or a family")
    return smooth()


def _fitted(values: FloatArray, family: str) -> Any:
    """Return the fitted distribution, if a test with refitted samples does not refuse it."""
    fit, positive = _FAMILIES[family]
    unit = 2.0 ** math.floor(math.log2(np.abs(values).max()))
    if positive and values.min() <= 0.0:
        raise refused("data", values, f"give positive values for the family {family!r}")
    values = values / unit  # SciPy's searches have absolute tolerances
    rng = np.random.default_rng(0)
    try:
        with np.errstate(all="ignore"):
            fitted = fit(values)
            found = _anderson_darling(values, fitted)
            samples = fitted.isf(rng.random((_SAMPLES, len(values))))
            larger = sum(_anderson_darling(sample, fit(sample)) >= found for sample in samples)
    except (ValueError, ArithmeticError) as error:
        remedy = f"it cannot be fitted to the values ({raised(error)}): give another, or None"
        raise refused("family", family, remedy) from error
    p = (1 + larger) / (1 + _SAMPLES)
    if p <= _LEVEL:
        remedy = f"the values contradict it (Anderson-Darling, p = {p:.2g}): give another, or None"
        raise refused("family", family, remedy)
    *shape, location, scale = fitted.args
    return fitted.dist(*shape, location * unit, scale * unit)


def _anderson_darling(values: FloatArray, law: Any) -> float:
    """Distance of values from a law, which looks at both tails."""
    x, n = np.sort(values), len(values)
    weight = (2.0 * np.arange(n) + 1.0) / n
    return float(-n - weight @ (law.logcdf(x) + law.logsf(x[::-1])))


def _weibull(values: FloatArray) -> Any:
    from scipy import stats

    # logarithms of it are of the Gumbel family, which is fitted ten times faster
    centre, spread = stats.gumbel_l.fit(np.log(values))
    return stats.weibull_min(1.0 / spread, 0.0, math.exp(centre))


def _of_scipy(name: str, **fixed: float) -> Callable[[FloatArray], Any]:
    def fit(values: FloatArray) -> Any:
        from scipy import stats

        family = getattr(stats, name)
        return family(*family.fit(values, **fixed))

    return fit


_FAMILIES: dict[str, tuple[Callable[[FloatArray], Any], bool]] = {
    "normal": (_of_scipy("norm"), False),
    "lognormal": (_of_scipy("lognorm", floc=0.0), True),
    "weibull": (_weibull, True),
    "gamma": (_of_scipy("gamma", floc=0.0), True),
    "exponential": (_of_scipy("expon", floc=0.0), True),
    "gumbel": (_of_scipy("gumbel_r"), False),
    "logistic": (_of_scipy("logistic"), False),
}
"""Name -> its fit by maximum likelihood, and whether it starts at zero."""
