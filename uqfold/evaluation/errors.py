"""What can go wrong while a model is run."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from uqfold.typing import FloatArray


class BudgetExceededError(RuntimeError):
    """A method asked for more runs than `max_evals` allows."""


class TimeLimitError(BudgetExceededError):
    """The wall-clock limit `max_seconds` of the evaluator is over.

    Attributes
    ----------
    responses
        Those (k,) of the first k rows of the call that was under way, which were still made.
    """

    def __init__(self, message: str) -> None:
        # the command line knows these errors before it needs arrays
        import numpy as np

        super().__init__(message)
        self.responses: FloatArray = np.empty(0)


class FailedRunError(RuntimeError):
    """An evaluation failed under the policy ``raise``, or every one fails."""


class ModelError(FailedRunError):
    """The model does not take rows X (n, d), or gives something else than a response for each."""


class GradientError(RuntimeError):
    """The gradient of a problem raised, or returned something of another shape than its rows."""


class EngineError(RuntimeError):
    """Store or executor failed, not the model; no status of a method can stand for that."""


class StoreError(EngineError):
    """A store cannot be opened, read or written, or its content is damaged."""


class ExecutorError(EngineError):
    """An executor cannot take the model, or broke while running it."""


class ExternalRunError(RuntimeError):
    """A run of a program failed; says why and where its folder is."""
