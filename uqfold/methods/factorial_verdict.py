"""The stated error and the status of an answer of FFNI, from other answers beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.methods.result import NORMAL_95, Estimate
from uqfold.problems.criterion import Criterion
from uqfold.typing import BoolArray, FloatArray

_CAUTION = 1.5
"""Stated error over what the answers differ by; see ``docs/ffni.md`` for what was measured."""
_LEAST = 5e-3
"""Smallest stated error, as a share of pf or of its complement."""
_BLURRED = 0.05
"""Share of tau by which responses may miss the polynomial."""


@dataclass(frozen=True, eq=False)
class OtherAnswers:
    """How far answers of the same question lie apart.

    Attributes
    ----------
    causes
        What was changed (S,), as the subject of a sentence.
    amounts
        What that changed pf, or the reliability, by (S, C); infinite where the method itself found
        no answer, NaN where another distribution has none.
    families
        Whether another distribution could be compared (C,).
    """

    causes: list[str]
    amounts: FloatArray
    families: BoolArray

    def joined_by(self, cause: str, amounts: FloatArray) -> OtherAnswers:
        """Add one more difference (C,)."""
        return replace(
            self, causes=[cause, *self.causes], amounts=np.vstack([amounts, self.amounts])
        )


def judged(
    estimate: Estimate,
    criterion: Criterion,
    differences: OtherAnswers,
    row: int,
    miss: float,
    target: float,
) -> Estimate:
    """Return one answer with its stated error and status."""
    pf, reliability = estimate.pf, reliability_of(estimate)
    name, smaller = ("reliability", reliability) if reliability < pf else ("pf", pf)
    amounts = np.nan_to_num(differences.amounts[:, row], nan=0.0, posinf=math.inf)
    # squares of the smallest probabilities are zero to the computer
    stated = math.hypot(*(_CAUTION * amounts).tolist(), _LEAST * smaller)
    doubts = []
    if smaller == 0.0:
        does = "fails" if name == "pf" else "works"
        doubts.append(f"{name} = 0: no response of the design, nor what is fitted to them, {does}")
    elif stated > target * smaller:
        worst = int(amounts.argmax())
        share = 100.0 * float(amounts[worst]) / smaller
        by = f"by {share:.2g} %" if math.isfinite(share) else "beyond what the method can answer"
        doubts.append(f"compared with {differences.causes[worst]}, {name} changes {by}")
    if not differences.families[row]:
        doubts.append("no other distribution with these moments to compare with")
    if criterion.tau is not None and not miss <= _BLURRED * criterion.tau:
        doubts.append(f"responses miss the polynomial by {miss:.2g}, tau is {criterion.tau:g}")
    if estimate.status == "doubtful" or doubts:
        return with_reasons(replace(estimate, status="doubtful"), doubts)
    return replace(
        estimate,
        std_error=stated,
        ci_low=max(pf - NORMAL_95 * stated, 0.0),
        ci_high=min(pf + NORMAL_95 * stated, 1.0),
        ci_kind="normal 95 %, from rules and distributions compared",
        error_kind="surrogate",
        status="converged",
    )


def reliability_of(estimate: Estimate) -> float:
    """Return the complement of pf, as exact as it is known."""
    return 1.0 - estimate.pf if estimate.reliability is None else estimate.reliability


def with_reasons(estimate: Estimate, reasons: Sequence[str]) -> Estimate:
    """Add reasons to the message."""
    said = [estimate.message] if estimate.message else []
    return replace(estimate, message="; ".join([*said, *reasons]))
