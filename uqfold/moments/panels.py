"""Adaptive Gauss-Kronrod integration of many integrands at once, up to many ends at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from uqfold.time_limit import check_time
from uqfold.typing import BoolArray, FloatArray, IntArray

# Nodes and weights of the (7, 15) pair, Piessens et al., QUADPACK (Springer, 1983), dqk15.
_HALF_NODES = np.array(
    [
        0.991455371120812639206854697526329,
        0.949107912342758524526189684047851,
        0.864864423359769072789712788640926,
        0.741531185599394439863864773280788,
        0.586087235467691130294144691693013,
        0.405845151377397166906606412076961,
        0.207784955007898467600689403773245,
        0.0,
    ]
)
_HALF_KRONROD = np.array(
    [
        0.022935322010529224963732008058970,
        0.063092092629978553290700663189204,
        0.104790010322250183839876322541518,
        0.140653259715525918745189590510238,
        0.169004726639267902826583426598550,
        0.190350578064785409913256402421014,
        0.204432940075298892414161999234649,
        0.209482141084727828012999174891714,
    ]
)


_HALF_GAUSS = np.array(
    [
        0.129484966168869693270611432679082,
        0.279705391489276667901467771423780,
        0.381830050505118944950369775488975,
        0.417959183673469387755102040816327,
    ]
)
_NODES = np.concatenate([-_HALF_NODES, _HALF_NODES[-2::-1]])
_KRONROD = np.concatenate([_HALF_KRONROD, _HALF_KRONROD[-2::-1]])
_GAUSS = np.zeros(15)
_GAUSS[1::2] = np.concatenate([_HALF_GAUSS, _HALF_GAUSS[-2::-1]])

_MOST_BISECTIONS = 60
_MOST_PANELS = 60_000
_BLOCK_VALUES = 500_000
"""Values of integrands at once: bounds memory, and the time between two looks at the clock."""


class IntegrationError(ArithmeticError):
    """An integral did not reach its tolerance."""


def integrate(
    integrand: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    offset: FloatArray,
    tolerance: float = 1e-12,
) -> FloatArray:
    """Integrals (R,) of R non-negative integrands over [edges[0], edges[-1]].

    Parameters
    ----------
    integrand, edges, tolerance
        As in `integrals_up_to`.
    offset : array (R,)
        What each integral will be added to; the tolerance is relative to their sum.

    Raises
    ------
    IntegrationError
        As in `integrals_up_to`.
    """
    return integrals_up_to(integrand, edges, edges[-1:], offset[:, None], tolerance)[:, 0]


def integrals_up_to(
    integrand: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    stops: FloatArray,
    offset: FloatArray,
    tolerance: float = 1e-12,
) -> FloatArray:
    """Integrals of R non-negative integrands from edges[0] up to each of S stops.

    All stops share the panels below them, so that a thousand of them cost little more than one.

    Parameters
    ----------
    integrand
        Maps points (N,) to values (R, N). It is never called at an edge.
    edges : array (P + 1,)
        Increasing. Kinks and jumps belong at an edge; singular behaviour at an edge is resolved
        by bisection.
    stops : array (S,)
        Increasing; each between the first and the last edge and one of the edges.
    offset : array (R, S)
        What each integral will be added to; the tolerance is relative to their sum.
    tolerance
        Allowed error of each panel, relative to (offset + integral) at every stop behind it.

    Returns
    -------
    array (R, S)

    Raises
    ------
    IntegrationError
        If a panel still fails after 60 bisections, or 60,000 panels do not suffice, and the rest
        matters by more than 1e-8.
    """
    edges = edges[edges <= stops[-1]]
    low, high = edges[:-1], edges[1:]
    wide = high > low
    low, high = low[wide], high[wide]
    total: FloatArray = np.zeros(offset.shape)
    parent_error = np.full((offset.shape[0], low.size), np.inf)
    n_panels = 0
    for _ in range(_MOST_BISECTIONS):
        if low.size == 0:
            return np.cumsum(total, axis=1)
        n_panels += low.size
        stop = np.searchsorted(stops, 0.5 * (low + high))
        kronrod, error = _estimates(integrand, low, high, offset.shape[0])
        found = _summed(total, kronrod, stop)
        # what a panel adds counts at every stop behind it, so that the smallest sum decides
        scale = offset + np.cumsum(found, axis=1)
        scale = np.minimum.accumulate(scale[:, ::-1], axis=1)[:, ::-1][:, stop]
        # Where bisection no longer helps, rounding is what is left.
        stuck = (error > 0.3 * parent_error) & (error < 1e-11 * scale)
        split: BoolArray = np.asarray(((error > tolerance * scale) & ~stuck).any(axis=0))
        half = 0.5 * (high - low)
        wide = half > 4.0 * np.finfo(float).eps * np.maximum(np.abs(low), np.abs(high))
        split &= wide
        if n_panels + 2 * np.count_nonzero(split) > _MOST_PANELS:
            break
        total = _summed(total, kronrod[:, ~split], stop[~split])
        low, middle, high = low[split], (low + half)[split], high[split]
        parent_error = np.tile(0.5 * error[:, split], 2)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    rest = (np.where(split, error, 0.0) / np.where(scale > 0.0, scale, 1.0)).sum(axis=1).max()
    if rest > 1e-8:
        raise IntegrationError(
            f"an integral over [{edges[0]}, {edges[-1]}] has a relative error of {rest:.1e} after "
            f"{_MOST_BISECTIONS} bisections or {_MOST_PANELS} panels; add an edge where its "
            "integrand jumps or has a kink"
        )
    return np.cumsum(found, axis=1)


def _estimates(
    integrand: Callable[[FloatArray], FloatArray], low: FloatArray, high: FloatArray, rows: int
) -> tuple[FloatArray, FloatArray]:
    """Integrals over each panel and their errors, (R, P) each."""
    kronrod, error = np.empty((rows, low.size)), np.empty((rows, low.size))
    block = max(1, _BLOCK_VALUES // (rows * _NODES.size))
    for start in range(0, low.size, block):
        check_time()
        here = slice(start, start + block)
        half = 0.5 * (high[here] - low[here])
        points = 0.5 * (low[here] + high[here])[:, None] + half[:, None] * _NODES
        values = integrand(points.ravel()).reshape(rows, half.size, _NODES.size)
        whole = values @ _KRONROD
        scatter = np.abs(values - 0.5 * whole[..., None]) @ _KRONROD * half
        difference = np.abs(whole - values @ _GAUSS) * half
        # QUADPACK's estimate: the difference overstates the error of the longer rule by far.
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(scatter > 0, 200.0 * difference / scatter, 0.0)
        kronrod[:, here] = whole * half
        error[:, here] = scatter * np.minimum(1.0, ratio**1.5)
    return kronrod, error


def _summed(total: FloatArray, parts: FloatArray, stop: IntArray) -> FloatArray:
    """Totals (R, S) with the integrals (R, P) of panels added, each at the first stop behind it."""
    if total.shape[1] == 1:
        return np.asarray(total + parts.sum(axis=1, keepdims=True))
    added = [np.bincount(stop, weights=row, minlength=total.shape[1]) for row in parts]
    return np.asarray(total + np.stack(added))
