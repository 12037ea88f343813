"""Interval on a probability from a number of failures among independent samples."""

from __future__ import annotations

import math


def clopper_pearson(failures: int, n: int, level: float = 0.95) -> tuple[float, float]:
    """Clopper-Pearson interval on a failure probability, from the binomial distribution itself.

    With 1 to n - 1 failures the interval is two-sided with (1 - level) / 2 in each tail. With no
    failure at all, or nothing but failures, only one end is open, so the interval becomes a
    one-sided bound that takes the whole of 1 - level: (0, 1 - (1 - level)^(1/n)), about 3 / n at
    95 %, and its mirror image. Each tail alone keeps its level for every n; the price of the
    one-sided bounds is a total coverage slightly below `level` (never below 1.5 level - 0.5) for
    probabilities between the one-sided and the two-sided bound at zero failures, at 95 % between
    3.0 / n and 3.7 / n.

    Parameters
    ----------
    failures
        Number of failed samples, 0 to n.
    n
        Number of independent samples, fixed beforehand, at least 1.
    level
        Confidence level in (0, 1).

    Returns
    -------
    tuple[float, float]
        Lower and upper end; both lie in [0, 1] and enclose failures / n.

    Raises
    ------
    ValueError
        If the counts or the level are out of range.

    References
    ----------
    Clopper C.J., Pearson E.S. The use of confidence or fiducial limits illustrated in the case of
    the binomial. Biometrika 26 (1934) 404-413.

    Examples
    --------
    >>> low, high = clopper_pearson(0, 1000)
    >>> low, round(high, 6)
    (0.0, 0.002991)
    """
    if n < 1:
        raise ValueError(f"n = {n}: an interval needs at least one sample")
    if not 0 <= failures <= n:
        raise ValueError(f"failures = {failures}: give a number from 0 to n = {n}")
    if not 0.0 < level < 1.0:
        raise ValueError(f"level = {level}: a confidence level lies between 0 and 1")
    outside = 1.0 - level
    if failures == 0:
        return 0.0, -math.expm1(math.log(outside) / n)
    if failures == n:
        return math.exp(math.log(outside) / n), 1.0
    from scipy.special import betainccinv, betaincinv

    low = float(betaincinv(failures, n - failures + 1, outside / 2))
    high = float(betainccinv(failures + 1, n - failures, outside / 2))
    return low, high
