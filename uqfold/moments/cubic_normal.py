"""Cubic polynomial of a standard normal variable with given first four moments.

In standard units x = a + b u + c u^2 + d u^3 with u normal. Mean 0 asks a = -c; the other moments

    1 = b^2 + 6 b d + 2 c^2 + 15 d^2
    l3 = 2 c (b^2 + 24 b d + 105 d^2 + 2)
    l4 = 24 (b d + c^2 (1 + b^2 + 28 b d) + d^2 (12 + 48 b d + 141 c^2 + 225 d^2))

(Fleishman 1978, with l4 the excess kurtosis) are solved by Newton's method from the normal, b = 1,
in steps from its moments to the given ones. Where the cubic rises, P(Y <= y) = Phi(u(y)).

The expansion of Cornish and Fisher to four moments is such a cubic too, without an equation to
solve, whose moments are the given ones to first order in l4 and second in l3:

    b = 1 - l4 / 8 + 5 l3^2 / 36,  c = l3 / 6,  d = l4 / 24 - l3^2 / 18.

References
----------
Fleishman A.I. A method for simulating non-normal distributions. Psychometrika 43 (1978) 521-532.
Cornish E.A., Fisher R.A. Moments and cumulants in the specification of distributions. Revue de
l'Institut International de Statistique 5 (1938) 307-320.
Zhao Y.G., Lu Z.H. Fourth-moment standardization for structural reliability assessment. Journal of
Structural Engineering 133 (2007) 916-924.
"""

from __future__ import annotations

import numpy as np

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.typing import FloatArray

_STEPS, _NEWTON = (2, 20), 12
_SOLVED = 1e-9
# Normal scores of the table, and within which the cubic has to rise.
_SCORES = np.linspace(-8.0, 8.0, 65)
_NEEDED = 5.0


def cubic_normal(
    mean: float, std: float, skewness: float, kurtosis: float
) -> TabulatedDistribution | AtomicDistribution | None:
    """Return the cubic normal with these moments, or None where no rising cubic has them.

    Parameters
    ----------
    mean, std
        In the unit of the response; std = 0 is a step at the mean.
    skewness, kurtosis
        Standardised; kurtosis is 3 for a normal.
    """
    if std == 0.0:
        return AtomicDistribution((mean,))
    for steps in _STEPS:
        coefficients = _coefficients(skewness, kurtosis - 3.0, steps)
        if coefficients is not None:
            break
    else:
        return None
    return _of_cubic(mean, std, *coefficients.tolist())


def cornish_fisher(
    mean: float, std: float, skewness: float, kurtosis: float
) -> TabulatedDistribution | AtomicDistribution | None:
    """Return the distribution that the expansion of Cornish and Fisher has to these moments.

    None where it does not rise. Parameters are those of `cubic_normal`.
    """
    if std == 0.0:
        return AtomicDistribution((mean,))
    excess = kurtosis - 3.0
    b = 1.0 - excess / 8.0 + 5.0 * skewness**2 / 36.0
    return _of_cubic(mean, std, b, skewness / 6.0, excess / 24.0 - skewness**2 / 18.0)


def _of_cubic(
    mean: float, std: float, b: float, c: float, d: float
) -> TabulatedDistribution | None:
    """Return the distribution of the cubic, or None where it turns within five normal scores."""
    slope = b + 2.0 * c * _SCORES + 3.0 * d * _SCORES**2
    # beyond a turn the table ends, and is continued as a straight line
    falling = np.abs(_SCORES[slope <= 1e-3])
    nearest = float(falling.min()) if falling.size else np.inf
    if nearest <= _NEEDED:
        return None
    scores = _SCORES[np.abs(_SCORES) < nearest]
    levels = mean + std * (-c + (b + (c + d * scores) * scores) * scores)
    if not (np.diff(levels) > 0.0).all():
        return None
    return TabulatedDistribution(levels, scores)


def _coefficients(skewness: float, excess: float, steps: int) -> FloatArray | None:
    """Return b, c, d, or None where the path from the normal leads to no solution."""
    found = np.array([1.0, 0.0, 0.0])
    for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
        wanted = share * np.array([0.0, skewness, excess]) + np.array([1.0, 0.0, 0.0])
        for _ in range(_NEWTON):
            error, slopes = _moments(*found.tolist())
            error = error - wanted
            if np.abs(error).max() < _SOLVED:
                break
            try:
                found = found - np.linalg.solve(slopes, error)
            except np.linalg.LinAlgError:
                return None
            if not np.abs(found).max() < 10.0:
                return None
        else:
            return None
    return found


def _moments(b: float, c: float, d: float) -> tuple[FloatArray, FloatArray]:
    """Return variance, skewness and excess kurtosis (3,), and their slopes (3, 3) in b, c, d."""
    moments = np.array(
        [
            b**2 + 6 * b * d + 2 * c**2 + 15 * d**2,
            2 * c * (b**2 + 24 * b * d + 105 * d**2 + 2),
            24
            * (
                b * d
                + c**2 * (1 + b**2 + 28 * b * d)
                + d**2 * (12 + 48 * b * d + 141 * c**2 + 225 * d**2)
            ),
        ]
    )
    slopes = np.array(
        [
            [2 * b + 6 * d, 4 * c, 6 * b + 30 * d],
            [
                2 * c * (2 * b + 24 * d),
                2 * (b**2 + 24 * b * d + 105 * d**2 + 2),
                2 * c * (24 * b + 210 * d),
            ],
            [
                24 * (d + c**2 * (2 * b + 28 * d) + 48 * d**3),
                48 * c * (1 + b**2 + 28 * b * d + 141 * d**2),
                24 * (b + 28 * b * c**2 + 24 * d + 144 * b * d**2 + 282 * c**2 * d + 900 * d**3),
            ],
        ]
    )
    return moments, slopes
