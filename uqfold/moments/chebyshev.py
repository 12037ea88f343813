"""Functions given panel by panel as Chebyshev sums, and their integrals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

# With 20 terms a panel may hold exp(+-4) or a pole three half-widths away at rounding accuracy.
TERMS = 20

_BLOCK = 8192
_ANGLES = (np.arange(TERMS) + 0.5) * np.pi / TERMS
NODES: FloatArray = -np.cos(_ANGLES)  # increasing, inside (-1, 1)

_ORDERS = np.arange(TERMS)
# T_k(-x) = (-1)^k T_k(x), and the nodes run upwards.
_TO_COEFFICIENTS = np.cos(np.outer(_ORDERS, _ANGLES)) * (-1.0) ** _ORDERS[:, None] * 2.0 / TERMS
_TO_COEFFICIENTS[0] /= 2.0


def _integration_matrix() -> FloatArray:
    """Coefficients of the antiderivative that vanishes at -1, from those of the integrand."""
    matrix = np.zeros((TERMS + 1, TERMS))
    matrix[1, 0] = 1.0
    matrix[0, 1] = matrix[2, 1] = 0.25
    for k in range(2, TERMS):
        matrix[k + 1, k] = 0.5 / (k + 1)
        matrix[k - 1, k] = -0.5 / (k - 1)
    signs = (-1.0) ** np.arange(TERMS + 1)
    matrix[0] -= signs @ matrix
    return matrix


_INTEGRATE = _integration_matrix()
_TO_ANTIDERIVATIVE = _INTEGRATE @ _TO_COEFFICIENTS
_AT_NODES = np.cos(np.outer(np.arange(TERMS + 1), _ANGLES)) * (
    (-1.0) ** np.arange(TERMS + 1)[:, None]
)


def antiderivative(values: FloatArray, half_widths: FloatArray) -> FloatArray:
    """Chebyshev sums (TERMS + 1, P) of the integrals from each panel's left edge.

    Parameters
    ----------
    values : array (TERMS, P)
        Integrand at the nodes of P panels.
    half_widths : array (P,)
        Half the panels' widths.
    """
    return np.asarray((_TO_ANTIDERIVATIVE @ values) * half_widths)


def at_nodes(coefficients: FloatArray) -> FloatArray:
    """Values (TERMS, P) at the nodes of sums with coefficients (TERMS + 1, P)."""
    return np.asarray(_AT_NODES.T @ coefficients)


def at_right_edge(coefficients: FloatArray) -> FloatArray:
    """Values (P,) at +1."""
    return np.asarray(coefficients.sum(axis=0))


def evaluate(coefficients: FloatArray, panel: NDArray[np.intp], x: FloatArray) -> FloatArray:
    """Clenshaw sum of the given panels' series at local positions x in [-1, 1], all (N,)."""
    total = np.empty_like(x)
    # In blocks that stay in the processor's cache, with all work arrays in place.
    for start in range(0, x.size, _BLOCK):
        check_time()
        block = slice(start, start + _BLOCK)
        where, local = panel[block], x[block]
        double = 2.0 * local
        upper, last, work = np.zeros_like(local), np.zeros_like(local), np.empty_like(local)
        for row in coefficients[:0:-1]:
            np.multiply(double, upper, out=work)
            work -= last
            work += row[where]
            upper, last, work = work, upper, last
        total[block] = coefficients[0][where] + local * upper - last
    return total
