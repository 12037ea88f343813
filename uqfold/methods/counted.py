"""The answer that counts of independent samples give."""

from __future__ import annotations

import math

from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.result import Estimate, Status

FEW = 10
"""Fewer failures than this (or systems that work) leave pf uncertain by a third or more."""
LEVEL = 0.95


def counted(n: int, high: int, low: int, status: Status, messages: list[str]) -> Estimate:
    """Return the answer: the share of failures, and the interval of Clopper and Pearson.

    Parameters
    ----------
    n
        Systems, at least 1.
    high, low
        How many of them failed, open ones counted as failed (high), and as safe (low).
    status, messages
        What is known of the run; it is ``doubtful`` with fewer than ten failures, or fewer than
        ten systems that work.
    """
    pf = high / n
    bound = high in (0, n)
    if bound:
        messages = [*messages, f"{'no' if high == 0 else 'only'} failures among {n} systems"]
    elif min(high, n - high) < FEW:
        messages = [*messages, f"{high} failure{'s' * (high != 1)} among {n} systems"]
    return Estimate(
        pf=pf,
        reliability=(n - high) / n,
        # without both outcomes the sample says nothing about its own spread
        std_error=math.nan if bound else math.sqrt(pf * (1.0 - pf) / n),
        ci_low=clopper_pearson(low, n, LEVEL)[0],
        ci_high=clopper_pearson(high, n, LEVEL)[1],
        ci_kind="clopper-pearson 95 %" + (" one-sided" if bound else ""),
        pf_low=low / n,
        pf_high=pf,
        error_kind="sampling",
        status="doubtful" if min(high, n - high) < FEW else status,
        message="; ".join(messages),
    )
