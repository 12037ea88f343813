"""Distributions of inputs that take single values: counts, categories, and what is cut off."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from uqfold.checks import array, real, refused
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.counts import listed
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.engine import openturns

_ROUNDING = 1e-9


def bernoulli(p: float) -> Any:
    """Return the distribution of an input that is 1 with probability p, and else 0.

    Raises
    ------
    ValueError, TypeError
        If p is not between zero and one.
    """
    ot = openturns()
    return ot.Bernoulli(real("p", p, above=0.0, below=1.0))


def poisson(mean: float) -> Any:
    """Return the distribution of the number of events of which so many are expected.

    Raises
    ------
    ValueError, TypeError
        If `mean` is not positive.
    """
    ot = openturns()
    return ot.Poisson(real("mean", mean, above=0.0))


def discrete(values: ArrayLike, probabilities: ArrayLike) -> Any:
    """Return the distribution of an input that takes given values with given probabilities.

    Parameters
    ----------
    values
        What the model gets (k,), at least two different numbers; a category is a number too.
    probabilities
        Of each value (k,); they add up to one.

    Returns
    -------
    openturns.Distribution
        What `uqfold.Problem` takes as an input.

    Raises
    ------
    ValueError, TypeError
        If a value occurs twice, a probability is negative, or they do not add up to one.

    Examples
    --------
    >>> print(discrete([0, 1, 3], [0.7, 0.2, 0.1]).getMean()[0])
    0.5
    """
    x, p = array("values", values, ("k",)), array("probabilities", probabilities, ("k",))
    if len(np.unique(x)) < max(len(x), 2):
        raise refused("values", x, "give at least two, each of them once")
    if len(x) != len(p):
        raise refused("probabilities", p, f"give one for each of the {len(x)} values")
    if not (p >= 0.0).all():
        raise refused("probabilities", p, "give none below zero")
    if not abs(float(p.sum()) - 1.0) <= _ROUNDING:
        raise refused("probabilities", p, f"they add up to {p.sum():.9g}, not to 1")
    return listed(x, p)


def censored(distribution: Any, low: float = -math.inf, high: float = math.inf) -> Any:
    """Return a distribution that is cut off: what lies beyond a bound takes its value.

    max(0, X) is `censored(X, low=0.0)`: zero with the probability that X is below, else X.

    Parameters
    ----------
    distribution
        A continuous distribution of one input, in any form that `uqfold.Problem` takes.
    low, high
        Bounds, one of which may be infinite.

    Returns
    -------
    openturns.Distribution
        A mixture of atoms and the distribution between the bounds.

    Raises
    ------
    ValueError, TypeError
        If the distribution is not continuous, all of it lies on one side, or nothing is cut off.

    Examples
    --------
    >>> from uqfold.inputs import normal
    >>> print(f"{censored(normal(0.0, 1.0), low=0.0).computeCDF(0.0):.3f}")
    0.500
    """
    ot = openturns()
    try:
        whole = as_openturns(distribution)
    except (TypeError, ValueError) as error:
        raise refused("distribution", distribution, str(error), type(error)) from error
    if whole.getDimension() != 1 or not whole.isContinuous():
        raise refused("distribution", distribution, "give a continuous one of one input")
    bounds = real("low", low, finite=False), real("high", high, finite=False)
    marginal = checked_marginal(whole, "distribution")
    ends = np.array(bounds)
    below, above = float(marginal.cdf(ends[:1])[0]), float(marginal.sf(ends[1:])[0])
    rest = 1.0 - below - above
    if not (bounds[0] < bounds[1] and rest > 0.0 and below + above > 0.0):
        remedy = f"bounds within the distribution; {below:.3g} lies below, {above:.3g} above"
        raise refused("low, high", bounds, f"give {remedy}")
    lower, upper = ot.TruncatedDistribution.LOWER, ot.TruncatedDistribution.UPPER
    if math.isinf(bounds[1]):
        cut = ot.TruncatedDistribution(whole, bounds[0], lower)
    elif math.isinf(bounds[0]):
        cut = ot.TruncatedDistribution(whole, bounds[1], upper)
    else:
        cut = ot.TruncatedDistribution(whole, *bounds)
    parts = [(cut, rest)]
    parts += [(ot.Dirac(bounds[0]), below)] if below > 0.0 else []
    parts += [(ot.Dirac(bounds[1]), above)] if above > 0.0 else []
    return ot.Mixture([part for part, _ in parts], [weight for _, weight in parts])
