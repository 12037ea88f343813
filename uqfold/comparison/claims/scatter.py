"""The scatter of the model in a difference of two conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd


def scatter_of_gain(
    frame: pd.DataFrame, first: str, second: str, threshold: float, tau: float | None = None
) -> float:
    """Give the standard deviation of a gain of R that comes from the model's own scatter.

    Parameters
    ----------
    frame
        Table of an analysis of the kind ``scatter``.
    first, second
        The two problems; their scatter is independent.
    threshold, tau
        At which T, and at which tau; None without synchronization.

    Returns
    -------
    float
        The largest over the nudges and missions of the table.

    Raises
    ------
    ValueError
        If the table has nothing there.
    """
    at = frame["tau"].isna() if tau is None else frame["tau"] == tau
    own = frame[at & (frame["threshold"] == threshold)]
    keys = ["relative", "missions"]
    one, other = (
        own[own["problem"] == problem].set_index(keys)["pf_std"] for problem in (first, second)
    )
    if one.empty or other.empty:
        raise ValueError(f"no scatter of {first} and {second} at T = {threshold:g}, tau = {tau}")
    return float(np.hypot(one, other[one.index]).max())


def beyond_scatter(what: str, gain: float, noise: float) -> Finding:
    """Find whether a gain is positive; within twice the scatter it cannot be judged."""
    return Finding(
        what,
        gain,
        0.0,
        at_least=True,
        uncertainty=2.0 * noise,
        remark=f"scatter of the model {noise:.1g} (one standard deviation)",
    )
