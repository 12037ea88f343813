"""Refusing work that a budget does not pay for, before any of it is done."""

from __future__ import annotations

from uqfold.evaluation import BudgetExceededError, EvaluationSession


def check_affordable(session: EvaluationSession, needed: int) -> None:
    """Refuse more runs than the budget allows.

    Raises
    ------
    BudgetExceededError
        If fewer than `needed` runs are left.
    """
    if needed > session.remaining:
        raise BudgetExceededError(
            f"up to {needed:,} runs are needed, but max_evals = {session.max_evals} allows only "
            f"{session.remaining:,}"
        )
