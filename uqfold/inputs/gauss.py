"""Gauss quadrature rules that fit any continuous marginal distribution.

Normal, uniform, exponential, gamma and beta marginals have classical orthogonal polynomials, whose
recurrence is known. Any other marginal becomes a fine discrete measure: a composite Gauss-Legendre
rule, over the standard-normal variable in the body, split where OpenTURNS knows the density to have
kinks, and over the density itself in the tails, where quantiles run out of digits. The Lanczos
process then gives the recurrence of its orthonormal polynomials.

References
----------
Gautschi W. Orthogonal Polynomials: Computation and Approximation. Oxford University Press, 2004,
sections 2.2 and 3.1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from uqfold.checks import whole
from uqfold.inputs.behind import family_of
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.laws import ClosedMarginal
from uqfold.inputs.marginal import Marginal
from uqfold.typing import FloatArray

MAX_GAUSS_NODES = 64
"""Most nodes of a rule."""

_REACH = 6.0  # the body: beyond it, probabilities of 1e-9, the density takes over from quantiles
_PANEL = 0.25  # fine enough for the squares of polynomials with 64 zeros
_PANEL_NODES = 24
_TAIL_PANELS = 260  # each a quarter e-fold: until the density vanishes, or 1e28 scales out

# Largest share of the highest moment in the outermost panel (a moment that does not exist has a
# thousandth and more there), and largest departures of the measure from mass one, and of the
# finished rule from orthonormality
_TAIL_SHARE = 1e-6
_MASS_ERROR = 1e-8
_DEPARTURE = 1e-10


def gauss_rule(marginal: Any, n: int) -> tuple[FloatArray, FloatArray]:
    """Return the Gauss quadrature rule of a distribution: exact for polynomials of degree 2 n - 1.

    Parameters
    ----------
    marginal
        A `Marginal`, or a continuous univariate OpenTURNS distribution.
    n
        Number of nodes, 1 to 64.

    Returns
    -------
    tuple[FloatArray, FloatArray]
        Nodes (n,), increasing, and weights (n,) that sum to one.

    Raises
    ------
    ValueError
        If `n` is out of range, or the rule does not exist (moments up to order 2 n - 1 missing)
        or is beyond double precision.
    """
    n = whole("n", n, at_least=1, at_most=MAX_GAUSS_NODES)
    if not isinstance(marginal, Marginal):
        marginal = checked_marginal(marginal, "marginal")
    found = recurrence(marginal, n)
    if found is None:
        raise ValueError(
            f"no Gauss rule with {n} nodes for {marginal}: its moments up to order "
            f"{2 * n - 1} may not exist, or exceed double precision; use fewer nodes"
        )
    nodes, weights, _ = _rule_of_recurrence(found.diagonal, found.off_diagonal)
    return found.origin + found.scale * nodes, weights / weights.sum()


class Recurrence(NamedTuple):
    """Orthonormal polynomials of a distribution, by their three-term recurrence.

    Attributes
    ----------
    origin, scale
        The standard variable is z = (x - origin) / scale.
    diagonal, off_diagonal
        a (n,) and b (n - 1,) in z p_k = b_{k-1} p_{k-1} + a_k p_k + b_k p_{k+1}, p_0 = 1: enough
        for the polynomials up to degree n - 1.
    """

    origin: float
    scale: float
    diagonal: FloatArray
    off_diagonal: FloatArray


def recurrence(marginal: Marginal, n: int) -> Recurrence | None:
    """Return the first n orthonormal polynomials of a marginal.

    None where moments up to order 2 n - 1 are missing or beyond double precision.

    Raises
    ------
    ValueError
        If density and quantiles of the marginal contradict each other, or it takes single values.
    """
    if marginal.atoms[0].size:
        raise ValueError(
            f"no Gauss rule for {marginal}: its nodes would be values that it does not take"
        )
    own, family = family_of(marginal.distribution)
    if isinstance(marginal, ClosedMarginal) and family in _CLASSICAL:
        return _CLASSICAL[family](own, n)
    return _of_measure(_discrete_measure(marginal), n)


def _of_normal(d: Any, n: int) -> Recurrence:
    mean, std = d.getParameter()
    return Recurrence(mean, std, np.zeros(n), np.sqrt(np.arange(1.0, n)))


def _of_gamma(d: Any, n: int) -> Recurrence:
    shape = d.getK() if d.getClassName() == "Gamma" else 1.0
    j = np.arange(float(n))
    off = np.sqrt(j[1:] * (j[1:] + shape - 1.0))
    return Recurrence(d.getGamma(), 1.0 / d.getLambda(), 2.0 * j + shape, off)


def _of_beta(d: Any, n: int) -> Recurrence:
    low, high = d.getA(), d.getB()
    p, q = (d.getAlpha(), d.getBeta()) if d.getClassName() == "Beta" else (1.0, 1.0)
    total, j = p + q, np.arange(1.0, n)
    k = 2.0 * j + total
    diagonal = np.append((p - q) / total, (p - q) * (total - 2.0) / ((k - 2.0) * k))
    # the first has a factor in common above and below, which may vanish
    first = 4.0 * p * q / (total**2 * (total + 1.0))
    i, k = j[1:], k[1:]
    rest = 4.0 * i * (i + p - 1.0) * (i + q - 1.0) * (i + total - 2.0)
    squares = np.append(first, rest / ((k - 2.0) ** 2 * (k - 1.0) * (k - 3.0)))
    off = np.sqrt(squares[: n - 1])
    return Recurrence(0.5 * (low + high), 0.5 * (high - low), diagonal, off)


_CLASSICAL: dict[str, Callable[[Any, int], Recurrence]] = {
    "Beta": _of_beta,
    "Exponential": _of_gamma,
    "Gamma": _of_gamma,
    "Normal": _of_normal,
    "Uniform": _of_beta,
}
"""Class of an OpenTURNS distribution -> recurrence of its orthonormal polynomials."""


def _rule_of_recurrence(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes (n,), weights (n,) and the orthonormal polynomials (n, n) at the nodes."""
    n = len(a)
    nodes = np.linalg.eigvalsh(np.diag(a) + np.diag(b, 1) + np.diag(b, -1))
    if not np.any(a):
        # symmetric to the last bit: rules of odd order share the middle node, and runs in a store
        nodes = 0.5 * (nodes - nodes[::-1])
    p = np.ones((n, n))
    for k in range(n - 1):
        before = b[k - 1] * p[k - 1] if k else 0.0
        p[k + 1] = ((nodes - a[k]) * p[k] - before) / b[k]
    # weights as reciprocals of the Christoffel sums: the smallest ones stay accurate
    return np.asarray(nodes), np.asarray(1.0 / (p * p).sum(axis=0)), p


class _Measure(NamedTuple):
    """A discrete measure in place of a marginal.

    Attributes
    ----------
    points, probabilities
        Points (k,), increasing, and their probabilities (k,).
    open_low, open_high
        Whether the marginal has no bound on that side.
    """

    points: FloatArray
    probabilities: FloatArray
    open_low: bool
    open_high: bool


def _discrete_measure(marginal: Marginal) -> _Measure:
    from scipy.special import ndtri

    levels = marginal.cdf(marginal.kinks)
    kinks = ndtri(levels[(levels > 0.0) & (levels < 1.0)])
    edges = np.arange(-_REACH, _REACH + 0.5 * _PANEL, _PANEL)
    edges = np.unique(np.concatenate([edges, kinks[np.abs(kinks) < _REACH]]))
    u, du = _panels(edges)
    body = marginal.from_normal(u), du * np.exp(-0.5 * u * u) / np.sqrt(2.0 * np.pi)
    first, second, last_but_one, last = marginal.from_normal(
        np.array([-_REACH, -_REACH + _PANEL, _REACH - _PANEL, _REACH])
    )
    bottom, top = marginal.bounds
    low, low_p = _tail(marginal, first, first - second, bottom)
    high, high_p = _tail(marginal, last, last - last_but_one, top)
    points = np.concatenate([low[::-1], body[0], high])
    probabilities = np.concatenate([low_p[::-1], body[1], high_p])
    some = probabilities > 0.0
    if not (np.isfinite(points[some]).all() and abs(probabilities.sum() - 1.0) <= _MASS_ERROR):
        raise ValueError(
            f"no Gauss rule for {marginal}: its density and its quantiles do not fit together"
        )
    return _Measure(points[some], probabilities[some], np.isinf(bottom), np.isinf(top))


def _tail(
    marginal: Marginal, start: float, scale: float, bound: float
) -> tuple[FloatArray, FloatArray]:
    """Points, outwards from `start` in panels that grow with the distance, and probabilities."""
    edges = start + scale * np.expm1(_PANEL * np.arange(_TAIL_PANELS + 1))
    if np.isfinite(bound):
        edges = np.append(edges[(edges - bound) * np.sign(scale) < 0.0], bound)
    if edges.size < 2:
        return np.empty(0), np.empty(0)
    with np.errstate(all="ignore"):  # a wrapped density may overflow where it vanishes
        positive = marginal.pdf(edges[1:-1]) > 0.0
        x, dx = _panels(edges[: 2 + int(np.argmin(np.append(positive, False)))])
        density = marginal.pdf(x)
    return x, np.abs(dx) * np.where(density > 0.0, density, 0.0)


def _panels(edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Composite Gauss-Legendre rule between the edges: points, weights."""
    x, w = np.polynomial.legendre.leggauss(_PANEL_NODES)
    half = 0.5 * np.diff(edges)[:, None]
    return (0.5 * (edges[1:] + edges[:-1])[:, None] + half * x).ravel(), (half * w).ravel()


def _of_measure(measure: _Measure, n: int) -> Recurrence | None:
    """Recurrence of a discrete measure, or None where its rule fails its own checks."""
    points = measure.points
    level = np.cumsum(measure.probabilities)
    lower, center, upper = np.interp([0.25, 0.5, 0.75], level / level[-1], points)
    with np.errstate(all="ignore"):  # missing moments overflow; the checks below tell
        z = (points - center) / (upper - lower)
        basis = np.empty((n, z.size))
        basis[0] = np.sqrt(measure.probabilities / level[-1])
        a, b = np.zeros(n), np.zeros(n - 1)
        for k in range(n):
            following = z * basis[k]
            a[k] = basis[k] @ following
            # twice, so that the basis stays orthogonal to rounding
            for _ in range(2):
                following = following - basis[: k + 1].T @ (basis[: k + 1] @ following)
            if k < n - 1:
                b[k] = np.linalg.norm(following)
                basis[k + 1] = following / b[k]
        highest = np.abs(z) * basis[-1] ** 2
        tails = max(
            highest[:_PANEL_NODES].sum() if measure.open_low else 0.0,
            highest[-_PANEL_NODES:].sum() if measure.open_high else 0.0,
        )
        finite = np.isfinite(a).all() and np.isfinite(b).all()
        if not (finite and tails <= _TAIL_SHARE * highest.sum()):
            return None
        _, weights, p = _rule_of_recurrence(a, b)
        departure = np.abs((p * weights) @ p.T - np.eye(n)).max()
    if not departure <= _DEPARTURE:
        return None
    return Recurrence(float(center), float(upper - lower), a, b)
