"""Answering many criteria from what a run has found: block by block, within the time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from uqfold.evaluation import TimeLimitError
from uqfold.methods.result import Estimate
from uqfold.methods.task import attempt

BLOCK = 1024
"""Criteria answered together: bounds memory, and what is lost when the time is over."""


def estimates_by_blocks(
    n_criteria: int, answers: Callable[[Sequence[int]], list[Estimate]]
) -> list[Estimate]:
    """Answer criteria block by block.

    Where a block cannot be answered its criteria are answered one by one, so that one of them does
    not take the others with it. When the time is over, the rows answered so far stand.

    Parameters
    ----------
    n_criteria
        Number of criteria.
    answers
        Gives one estimate for each criterion of a block, named by their positions.

    Raises
    ------
    TimeLimitError
        If the time is over before the first answer.
    """
    found: list[Estimate] = []
    try:
        for start in range(0, n_criteria, BLOCK):
            block = range(start, min(start + BLOCK, n_criteria))
            try:
                found += answers(block)
            except TimeLimitError:
                raise
            except (ArithmeticError, RuntimeError, ValueError):
                for row in block:
                    found.append(attempt(partial(_alone, answers, row)))
    except TimeLimitError as error:
        if not found:
            raise
        late = Estimate.without_answer("failed", f"out of time before an answer: {error}")
        found += [late] * (n_criteria - len(found))
    return found


def _alone(answers: Callable[[Sequence[int]], list[Estimate]], row: int) -> Estimate:
    [estimate] = answers([row])
    return estimate
