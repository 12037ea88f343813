"""What sampling says of the assumption of independence: correlated against independent units.

With K responses drawn at each of N draws of the shared inputs v, C_i of them in time, the number of
ways to choose r timely ones, C(C_i, r) / C(K, r), estimates H(T | v_i)^r without bias; the mean of
C_i / K estimates the marginal H-bar(T). Both come from the same responses, so that their difference
is known far better than either.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from uqfold.typing import FloatArray


@dataclass(frozen=True)
class SampledDependence:
    """Estimates at R thresholds, arrays (R,).

    Attributes
    ----------
    pf, pf_independent
        Failure probability with shared inputs, and with every response drawn from the marginal.
    difference
        ``pf_independent`` - ``pf``.
    std_error
        Standard error of the difference.
    """

    pf: FloatArray
    pf_independent: FloatArray
    difference: FloatArray
    std_error: FloatArray


def sampled_dependence(
    responses: FloatArray, thresholds: ArrayLike, count: int
) -> SampledDependence:
    """Estimate the failure probability of `count` responses that must all be in time.

    Parameters
    ----------
    responses : array (N, K)
        K responses at each of N independent draws of the shared inputs; NaN counts as too late.
    thresholds : array (R,)
        Response thresholds T.
    count
        Number of responses r: units times missions.

    Raises
    ------
    ValueError
        If fewer than `count` responses, or fewer than two draws, are given.
    """
    n_draws, per_draw = responses.shape
    if not 1 <= count <= per_draw:
        raise ValueError(f"{per_draw} responses per draw cannot judge {count} at once")
    if n_draws < 2:
        raise ValueError(f"{n_draws} draws of the shared inputs: give at least 2")
    in_time = (responses[:, :, None] <= np.asarray(thresholds, dtype=float)).sum(axis=1)
    steps = np.arange(count)
    # C(c, r) / C(K, r) as a product; a factor is zero where c < r
    factors = np.maximum(in_time[:, :, None] - steps, 0) / (per_draw - steps)
    together = factors.prod(axis=2)
    share = in_time / per_draw
    marginal = share.mean(axis=0)
    # the mean of C_i / K raised to r is too large by its own scatter, to second order
    bias = 0.5 * count * (count - 1) * marginal ** max(count - 2, 0) * share.var(axis=0) / n_draws
    influence = together - count * marginal ** (count - 1) * share
    with np.errstate(divide="ignore"):  # none in time: log1p gives -inf, expm1 of it -1
        late = -np.expm1(count * np.log1p(-(1.0 - marginal)))
    pf = (1.0 - together).mean(axis=0)
    pf_independent = late + bias
    return SampledDependence(
        pf=pf,
        pf_independent=pf_independent,
        difference=pf_independent - pf,
        std_error=influence.std(axis=0, ddof=1) / np.sqrt(n_draws),
    )
