"""Discrete distributions as tables: values, and the probability of each.

OpenTURNS distributions and those of SciPy and chaospy are asked for the probabilities of whole
numbers, ever further out until there are none; what is not whole has to list its values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np

from uqfold.inputs.behind import family_of
from uqfold.inputs.engine import openturns
from uqfold.inputs.marginal import called
from uqfold.inputs.wrapped import ChaospyLaw
from uqfold.typing import FloatArray

ValueTable: TypeAlias = tuple[FloatArray, FloatArray]
"""Values (k,), increasing, and their probabilities (k,), all positive."""

MOST_VALUES = 1_000_000
"""Values of one input at most."""
LISTED = "FiniteDiscreteDistribution"
"""OpenTURNS' name of a distribution that lists its values."""
MISSING = 1e-9
"""What probabilities may lack of one, and a distribution function may differ from their sum."""
_SMALLEST = 1e-300
"""Numbers are taken so far out as their probability is at least this."""
_DEVIATIONS = 10.0
"""Where that begins: so many standard deviations around the mean."""
_AGREE = 1e-9


def table_of(distribution: Any) -> ValueTable:
    """Return the table of a discrete OpenTURNS distribution.

    Raises
    ------
    ValueError
        If it takes more than a million values, or their probabilities do not add up.
    """
    return joined([(weight, _own_table(part)) for weight, part in parts_of(distribution)])


def joined(tables: Sequence[tuple[float, ValueTable]]) -> ValueTable:
    """Return the table of a mixture of tables, each with its weight."""
    values, at = np.unique(np.concatenate([x for _, (x, _) in tables]), return_inverse=True)
    weighted = np.concatenate([weight * p for weight, (_, p) in tables])
    return values, np.bincount(at, weighted).astype(np.float64)


def parts_of(distribution: Any, weight: float = 1.0) -> Iterator[tuple[float, Any]]:
    """Weights and distributions that an OpenTURNS mixture is made of, to any depth."""
    own, family = family_of(distribution)
    if family != "Mixture":
        yield weight, distribution
        return
    weights = np.array(own.getWeights())
    for share, part in zip(weights / weights.sum(), own.getDistributionCollection(), strict=True):
        if share > 0.0:
            yield from parts_of(part, weight * float(share))


def _own_table(distribution: Any) -> ValueTable:
    """Return the table of what is no mixture; errors as in `table_of`."""

    def probability(x: FloatArray) -> FloatArray:
        return called(distribution.computePDF, x[:, None]).ravel()

    # values that are listed may lie far apart, and Dirac calls itself integral wherever it is
    if distribution.isIntegral() and family_of(distribution)[1] not in (LISTED, "Dirac"):
        reach = distribution.getRange()
        low, high = reach.getLowerBound()[0], reach.getUpperBound()[0]
        ends = reach.getFiniteLowerBound()[0], reach.getFiniteUpperBound()[0]
        table = _whole_numbers(probability, (low, high), (bool(ends[0]), bool(ends[1])))
    else:
        values = np.array(distribution.getSupport(), dtype=np.float64).ravel()
        _check_number(len(values))
        values = np.sort(values)
        table = _occurring(values, probability(values))
    total = float(table[1].sum())
    if not abs(total - 1.0) <= MISSING:
        raise ValueError(f"the probabilities of its values add up to {total:.9g}")
    return table


def of_scipy(frozen: Any, name: str) -> Any:
    """Return a discrete SciPy distribution, of its older or its newer kind, in OpenTURNS form.

    Raises
    ------
    ValueError
        If it takes more than a million values, or its parameters make no distribution.
    """
    ot = openturns()
    own = getattr(frozen, "dist", frozen)
    if hasattr(own, "xk") and own is frozen:  # any values, a frozen one may have a location
        return listed(own.xk, own.pk)
    with np.errstate(all="ignore"):
        mean, low, high = float(frozen.mean()), *map(float, frozen.support())
        variance = float(frozen.variance() if hasattr(frozen, "variance") else frozen.var())
        table = _around(frozen.pmf, mean, variance, (low, high), name)
    family = _FAMILIES.get(getattr(getattr(frozen, "dist", None), "name", ""))
    if family is not None and low == 0.0:
        candidate = ot.Distribution(family(ot, mean, high))
        values, probabilities = table
        own = called(candidate.computePDF, values[:, None]).ravel()
        if np.abs(own - probabilities).max() <= _AGREE:
            return candidate
    return _as_openturns(table, name)


def of_chaospy(distribution: Any) -> Any:
    """Return a discrete chaospy distribution in OpenTURNS form; errors as in `of_scipy`."""
    law, name = ChaospyLaw(distribution), f"chaospy.{distribution}"
    low, high = law.support()
    ends = math.ceil(low), math.floor(high)
    table = _around(distribution.pdf, law.mean(), law.std() ** 2, ends, name)
    return _as_openturns(table, name)


def listed(values: Any, probabilities: Any) -> Any:
    """Return the OpenTURNS distribution that takes values (k,) with probabilities (k,)."""
    ot = openturns()
    return ot.FiniteDiscreteDistribution(
        np.asarray(values, dtype=np.float64)[:, None].tolist(), np.asarray(probabilities).tolist()
    )


_FAMILIES: dict[str, Callable[[Any, float, float], Any]] = {
    "bernoulli": lambda ot, mean, _: ot.Bernoulli(mean),
    "binom": lambda ot, mean, high: ot.Binomial(int(high), mean / high),
    "poisson": lambda ot, mean, _: ot.Poisson(mean),
}
"""Name in SciPy -> (openturns module, mean, largest value) -> distribution."""


def _as_openturns(table: ValueTable, name: str) -> Any:
    made = listed(*table)
    made.setName(name)
    return openturns().Distribution(made)


def _around(
    probability: Callable[[FloatArray], Any],
    mean: float,
    variance: float,
    support: tuple[float, float],
    name: str,
) -> ValueTable:
    """Return the table of whole numbers around a mean, within a support."""
    if not (math.isfinite(mean) and math.isfinite(variance)):
        raise ValueError(f"{name} has no finite mean and standard deviation")
    reach = _DEVIATIONS * math.sqrt(variance) + 1.0
    low, high = max(support[0], mean - reach), min(support[1], mean + reach)
    inner = low > support[0], high < support[1]

    def own(x: FloatArray) -> FloatArray:
        with np.errstate(all="ignore"):
            inside = (support[0] <= x) & (x <= support[1])
            return np.where(inside, np.asarray(probability(x), dtype=np.float64), 0.0)

    return _whole_numbers(own, (low, high), (not inner[0], not inner[1]))


def _whole_numbers(
    probability: Callable[[FloatArray], FloatArray],
    ends: tuple[float, float],
    are_last: tuple[bool, bool],
) -> ValueTable:
    """Return the table of whole numbers.

    Parameters
    ----------
    probability
        Probabilities (n,) of whole numbers (n,).
    ends
        Numbers between which nearly all of it lies.
    are_last
        Whether these are the first and the last one of all; if not, they are moved outwards until
        there are no probabilities.
    """
    low, high = (float(np.round(end)) for end in ends)
    for side, is_last in zip((-1.0, 1.0), are_last, strict=True):
        step = max(high - low, 8.0)
        while not is_last and high - low < MOST_VALUES:
            end = np.array([low if side < 0.0 else high])
            if not float(probability(end)[0]) > _SMALLEST:
                break
            low, high = (low - step, high) if side < 0.0 else (low, high + step)
    _check_number(high - low + 1.0)
    values = np.arange(low, high + 1.0)
    return _occurring(values, probability(values))


def _occurring(values: FloatArray, probabilities: FloatArray) -> ValueTable:
    found = probabilities > 0.0
    if not found.any():
        raise ValueError("it takes no whole numbers: list its values by `uqfold.inputs.discrete`")
    return values[found], probabilities[found]


def _check_number(count: float) -> None:
    if not count <= MOST_VALUES:
        raise ValueError(f"it takes {count:,.0f} values, {MOST_VALUES:,} are the most")
