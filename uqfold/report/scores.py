"""How a method did in a comparison: what it answered, how well, and at what cost."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from uqfold.methods.result import STATUSES
from uqfold.plots.wording import REFERENCE_STANDARD_ERRORS, Row, criterion_key, finite

RIGHT_WITHIN = 0.10
"""An answer is called right when its error is not larger, or when the reference cannot tell."""
NOT_CONVERGED = tuple(status for status in STATUSES if status != "converged")


@dataclass(frozen=True)
class MethodScore:
    """What one method did.

    Attributes
    ----------
    label
        Its label in the comparison.
    asked, answered
        Criteria it was asked, and criteria with an answer.
    errors
        Relative errors of the answers that have a reference.
    referenced
        Criteria asked that have a reference, answered or not.
    right
        How many of these it answered with an error of at most `RIGHT_WITHIN`, or below what the
        reference can tell.
    intervals, covering
        Intervals stated where there is a reference, and how many of them cover it, widened by
        two of its standard errors.
    n_evals, seconds
        Cost of the whole run.
    statuses
        How often each status occurs.
    """

    label: str
    asked: int
    answered: int
    errors: tuple[float, ...]
    referenced: int
    right: int
    intervals: int
    covering: int
    n_evals: int
    seconds: float
    statuses: Counter[str]

    @property
    def median_error(self) -> float:
        """Median of the errors; NaN without any."""
        return median(self.errors) if self.errors else math.nan

    @property
    def always_right(self) -> bool:
        """Whether every answer that can be judged is right, and there is one."""
        return 0 < self.right == len(self.errors)


def method_scores(rows: Sequence[Row]) -> list[MethodScore]:
    """Score every method of a comparison, in the order in which they ran."""
    labels = dict.fromkeys(row["label"] for row in rows)
    return [_scored(label, [row for row in rows if row["label"] == label]) for label in labels]


def spreads(rows: Sequence[Row]) -> list[float]:
    """How far the answers to a criterion lie apart: (largest - smallest) / smallest.

    One number for each criterion that several methods answered with a positive pf and no doubt.
    """
    answers: dict[object, list[float]] = {}
    for row in rows:
        if row["status"] != "doubtful" and row["pf"] > 0.0:
            answers.setdefault(criterion_key(row), []).append(row["pf"])
    return [max(own) / min(own) - 1.0 for own in answers.values() if len(own) > 1]


def _scored(label: str, rows: Sequence[Row]) -> MethodScore:
    referenced = [row for row in rows if row["reference_pf"] > 0.0]
    with_interval = [row for row in referenced if not math.isnan(row["ci_low"] + row["ci_high"])]
    return MethodScore(
        label=label,
        asked=len(rows),
        answered=sum(not math.isnan(row["pf"]) for row in rows),
        errors=tuple(finite(row["error"] for row in referenced)),
        referenced=len(referenced),
        right=sum(_is_right(row) for row in referenced),
        intervals=len(with_interval),
        covering=sum(_covers(row) for row in with_interval),
        n_evals=rows[0]["n_evals"],
        seconds=rows[0]["seconds"],
        statuses=Counter(row["status"] for row in rows),
    )


def _is_right(row: Row) -> bool:
    slack = REFERENCE_STANDARD_ERRORS * row["reference_std_error"] / row["reference_pf"]
    return bool(row["error"] <= max(RIGHT_WITHIN, slack))


def _covers(row: Row) -> bool:
    slack = REFERENCE_STANDARD_ERRORS * row["reference_std_error"]
    return bool(row["ci_low"] - slack <= row["reference_pf"] <= row["ci_high"] + slack)
