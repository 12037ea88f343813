"""Running the model: counting, budget, failed runs, progress; store, executors, external codes."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.evaluation.dask_cluster import Dask
    from uqfold.evaluation.errors import (
        BudgetExceededError,
        EngineError,
        ExecutorError,
        FailedRunError,
        ModelError,
        StoreError,
        TimeLimitError,
    )
    from uqfold.evaluation.evaluator import Evaluator
    from uqfold.evaluation.executors import Futures, InProcess
    from uqfold.evaluation.external import ExternalCode
    from uqfold.evaluation.outputs import Column, Regex
    from uqfold.evaluation.processes import Processes
    from uqfold.evaluation.row_model import per_sample
    from uqfold.evaluation.running import RunningEstimate
    from uqfold.evaluation.session import EvaluationSession
    from uqfold.evaluation.store import Store

__all__ = [
    "BudgetExceededError",
    "Column",
    "Dask",
    "EngineError",
    "EvaluationSession",
    "Evaluator",
    "ExecutorError",
    "ExternalCode",
    "FailedRunError",
    "Futures",
    "InProcess",
    "ModelError",
    "Processes",
    "Regex",
    "RunningEstimate",
    "Store",
    "StoreError",
    "TimeLimitError",
    "per_sample",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "BudgetExceededError": "uqfold.evaluation.errors",
        "Column": "uqfold.evaluation.outputs",
        "Dask": "uqfold.evaluation.dask_cluster",
        "EngineError": "uqfold.evaluation.errors",
        "EvaluationSession": "uqfold.evaluation.session",
        "Evaluator": "uqfold.evaluation.evaluator",
        "ExecutorError": "uqfold.evaluation.errors",
        "ExternalCode": "uqfold.evaluation.external",
        "FailedRunError": "uqfold.evaluation.errors",
        "Futures": "uqfold.evaluation.executors",
        "InProcess": "uqfold.evaluation.executors",
        "ModelError": "uqfold.evaluation.errors",
        "Processes": "uqfold.evaluation.processes",
        "Regex": "uqfold.evaluation.outputs",
        "RunningEstimate": "uqfold.evaluation.running",
        "Store": "uqfold.evaluation.store",
        "StoreError": "uqfold.evaluation.errors",
        "TimeLimitError": "uqfold.evaluation.errors",
        "per_sample": "uqfold.evaluation.row_model",
    },
)
