"""Adaptive Gauss-Kronrod integration of many integrands at once, over given panels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

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


class IntegrationError(ArithmeticError):
    """An integral did not reach its tolerance."""


def integrate(
    integrand: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    offset: FloatArray,
    tolerance: float = 1e-12,
) -> FloatArray:
    """Integrals of R non-negative integrands over [edges[0], edges[-1]].

    Parameters
    ----------
    integrand
        Maps points (N,) to values (R, N). It is never called at an edge.
    edges : array (P + 1,)
        Increasing. Kinks and jumps belong at an edge; singular behaviour at an edge is resolved
        by bisection.
    offset : array (R,)
        What each integral will be added to; the tolerance is relative to their sum.
    tolerance
        Allowed error of each panel, relative to (offset + integral).

    Returns
    -------
    array (R,)

    Raises
    ------
    IntegrationError
        If a panel still fails after 60 bisections and matters by more than 1e-8.
    """
    low, high = edges[:-1], edges[1:]
    wide = high > low
    low, high = low[wide], high[wide]
    total: FloatArray = np.zeros(offset.shape)
    parent_error = np.full((offset.size, low.size), np.inf)
    for _ in range(_MOST_BISECTIONS):
        check_time()
        if low.size == 0:
            return np.asarray(total)
        half = 0.5 * (high - low)
        middle = 0.5 * (low + high)
        points = middle[:, None] + half[:, None] * _NODES
        values = integrand(points.ravel()).reshape(offset.size, low.size, _NODES.size)
        kronrod = values @ _KRONROD
        scatter = np.abs(values - 0.5 * kronrod[..., None]) @ _KRONROD * half
        error = np.abs(kronrod - values @ _GAUSS) * half
        kronrod = kronrod * half
        # QUADPACK's estimate: the difference overstates the error of the longer rule by far.
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(scatter > 0, 200.0 * error / scatter, 0.0)
        error = scatter * np.minimum(1.0, ratio**1.5)
        scale = (offset + total + kronrod.sum(axis=1))[:, None]
        # Where bisection no longer helps, rounding is what is left.
        stuck = (error > 0.3 * parent_error) & (error < 1e-11 * scale)
        split = ((error > tolerance * scale) & ~stuck).any(axis=0)
        split &= half > 4.0 * np.finfo(float).eps * np.maximum(np.abs(low), np.abs(high))
        total = total + kronrod[:, ~split].sum(axis=1)
        low, middle, high = low[split], middle[split], high[split]
        parent_error = np.tile(0.5 * error[:, split], 2)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    rest = error[:, split].sum(axis=1)
    total = total + kronrod[:, split].sum(axis=1)
    if (rest > 1e-8 * (offset + total)).any():
        raise IntegrationError(
            f"an integral over [{edges[0]}, {edges[-1]}] has a relative error of "
            f"{float((rest / (offset + total)).max()):.1e} after {_MOST_BISECTIONS} bisections; "
            "add an edge where its integrand jumps or has a kink"
        )
    return np.asarray(total)
