from uqfold.evaluation.dask_cluster import Dask as Dask
from uqfold.evaluation.errors import (
    BudgetExceededError as BudgetExceededError,
    EngineError as EngineError,
    ExecutorError as ExecutorError,
    FailedRunError as FailedRunError,
    GradientError as GradientError,
    ModelError as ModelError,
    StoreError as StoreError,
    TimeLimitError as TimeLimitError,
)
from uqfold.evaluation.evaluator import Evaluator as Evaluator
from uqfold.evaluation.executors import Futures as Futures, InProcess as InProcess
from uqfold.evaluation.external import ExternalCode as ExternalCode
from uqfold.evaluation.outputs import Column as Column, Regex as Regex
from uqfold.evaluation.processes import Processes as Processes
from uqfold.evaluation.row_model import per_sample as per_sample
from uqfold.evaluation.served_problem import ServedProblem as ServedProblem
from uqfold.evaluation.session import (
    EvaluationSession as EvaluationSession,
    RunningEstimate as RunningEstimate,
)
from uqfold.evaluation.store import Store as Store
from uqfold.evaluation.um_bridge import UMBridgeModel as UMBridgeModel
