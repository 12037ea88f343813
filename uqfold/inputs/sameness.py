"""Whether two distributions are one and the same.

OpenTURNS' own ``==`` looks at no more than the class for some (mixtures of other weights, maxima of
other numbers), at the first marginals only where one has more than the other, and may then crash.
"""

from __future__ import annotations

from typing import Any

_LEVELS = (1e-6, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0 - 1e-6)
"""Where quantiles are compared: what a distribution says of itself may leave numbers out."""


def same_distribution(one: Any, other: Any) -> bool:
    """Return whether two distributions of OpenTURNS have the same form, numbers and quantiles.

    In doubt they are two.
    """
    dimension = one.getDimension()
    if dimension != other.getDimension() or repr(one) != repr(other) or one != other:
        return False
    return dimension > 0 and all(
        first.computeQuantile(level) == second.computeQuantile(level)
        for first, second in ((one.getMarginal(i), other.getMarginal(i)) for i in range(dimension))
        for level in _LEVELS
    )
