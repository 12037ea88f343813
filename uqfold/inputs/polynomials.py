"""Orthonormal polynomials of the inputs' own distributions.

A response that is a polynomial of a uniform, exponential or beta input is none of that input's
normal score. The polynomials that are orthonormal under the input's own distribution (Legendre,
Laguerre, Jacobi, or those of a Lanczos process) keep it one.

References
----------
Xiu D., Karniadakis G. E. The Wiener-Askey polynomial chaos for stochastic differential equations.
SIAM J. Sci. Comput. 24 (2002) 619-644.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.inputs.behind import family_of
from uqfold.inputs.gauss import MAX_GAUSS_NODES, Recurrence, recurrence
from uqfold.inputs.joint import JointInputs
from uqfold.inputs.marginal import Marginal
from uqfold.typing import FloatArray


@dataclass(frozen=True, eq=False)
class OwnPolynomials:
    """Orthonormal polynomials of one input, as functions of its standard-normal score.

    Attributes
    ----------
    marginal
        The input's distribution.
    recurrence
        Its polynomials.
    """

    marginal: Marginal
    recurrence: Recurrence

    @property
    def highest(self) -> int:
        """Highest degree; moments of the input are missing for higher ones, or nobody asked."""
        return len(self.recurrence.diagonal) - 1

    def __call__(self, u: FloatArray, degree: int) -> FloatArray:
        """Values (n, degree + 1) at the input's normal scores u (n,)."""
        return np.column_stack(
            [np.ones(u.size), *self.ladder(self.marginal.from_normal(u), degree)[1:]]
        )

    def ladder(self, x: Any, degree: int) -> list[Any]:
        """Polynomials of degree 0 to `degree` in the input x, an array or a symbol."""
        origin, scale, a, b = self.recurrence
        z = (x - origin) / scale
        steps: list[Any] = [1.0]
        for k in range(degree):
            before = b[k - 1] * steps[k - 1] if k else 0.0
            steps.append(((z - a[k]) * steps[k] - before) / b[k])
        return steps


def own_polynomials(inputs: JointInputs, degree: int) -> list[OwnPolynomials | None]:
    """Return the polynomials of each of the d inputs up to a degree.

    Fewer where higher moments are missing. None for a normal input, whose own polynomials are the
    Hermite ones of its score, for one that depends on others, and for one without a variance.
    """
    linked = {column for part in inputs.parts.dependent for column in part.columns}
    found: list[OwnPolynomials | None] = []
    for i, marginal in enumerate(inputs.columns):
        own = None
        if i not in linked and family_of(marginal.distribution)[1] != "Normal":
            own = _longest(marginal, min(degree + 1, MAX_GAUSS_NODES))
        found.append(own)
    return found


def _longest(marginal: Marginal, count: int) -> OwnPolynomials | None:
    """As many polynomials as the moments of a marginal allow, at most `count`."""
    for n in sorted({count, *range(2, min(count, 6))}, reverse=True):
        try:
            known = recurrence(marginal, n)
        except ValueError:
            return None
        if known is not None:
            return OwnPolynomials(marginal, known)
    return None
