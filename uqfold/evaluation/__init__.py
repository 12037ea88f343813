"""Running the model: counting, budget, failed runs, progress."""

from uqfold.evaluation.evaluator import (
    BudgetExceededError,
    EvaluationSession,
    Evaluator,
    FailedRunError,
)

__all__ = ["BudgetExceededError", "EvaluationSession", "Evaluator", "FailedRunError"]
