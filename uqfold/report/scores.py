"""How each method did in a comparison: what it answered, how well, and at what cost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from uqfold.comparison.league import RIGHT_WITHIN
from uqfold.methods.result import STATUSES
from uqfold.plots.wording import REFERENCE_STANDARD_ERRORS

if TYPE_CHECKING:
    import pandas as pd

CRITERION = ["threshold", "tau", "missions"]
"""Columns that tell criteria apart."""


def method_scores(frame: pd.DataFrame) -> pd.DataFrame:
    """Score every method of a comparison.

    Returns
    -------
    pandas.DataFrame
        One row per label, in the order in which they ran: criteria ``asked``, ``answered``, and
        ``referenced`` (those with a reference); ``median_error`` and ``largest_error`` of the
        answers with a reference (NaN without any); how many of these are ``right`` (within
        `RIGHT_WITHIN`, or what the reference can tell); intervals ``stated`` where there is a
        reference, and how many ``cover`` it, widened by two of its standard errors; ``n_evals``
        and ``seconds`` of the whole run; and for each status how often it occurs.
    """
    import numpy as np

    reference, error = frame["reference_pf"], frame["error"]
    slack = REFERENCE_STANDARD_ERRORS * frame["reference_std_error"]
    referenced = reference > 0.0
    stated = referenced & (frame["ci_low"] + frame["ci_high"]).notna()
    inside = (frame["ci_low"] - slack <= reference) & (reference <= frame["ci_high"] + slack)
    judged = frame[["label", "n_evals", "seconds"]].assign(
        asked=True,
        answered=frame["pf"].notna(),
        referenced=referenced,
        error=error.where(referenced & np.isfinite(error)),
        right=referenced & (error <= np.fmax(RIGHT_WITHIN, slack / reference)),
        stated=stated,
        cover=stated & inside,
        **{status: frame["status"] == status for status in STATUSES},
    )
    methods = judged.groupby("label", sort=False)
    counted = ["asked", "answered", "referenced", "right", "stated", "cover", *STATUSES]
    return (
        methods[counted]
        .sum()
        .assign(
            median_error=methods["error"].median(),
            largest_error=methods["error"].max(),
            n_evals=methods["n_evals"].first(),
            seconds=methods["seconds"].first(),
        )
    )


def spreads(frame: pd.DataFrame) -> pd.Series:
    """Return how far the answers to a criterion lie apart: (largest - smallest) / smallest.

    One number for each criterion that several methods answered with a positive pf and no doubt.
    """
    sure = frame[(frame["status"] != "doubtful") & (frame["pf"] > 0.0)]
    pf = sure.groupby(CRITERION, dropna=False)["pf"]
    several = pf.count() > 1
    return (pf.max() / pf.min() - 1.0)[several]
