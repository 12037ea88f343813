"""uqfold: how reliable is this system, and which method tells us most cheaply?

One model, its random inputs and a failure rule go in; several reliability methods answer the same
question; one table, with costs and error bars, says who was right.

>>> import uqfold
>>> problem = uqfold.problems.series()
>>> result = uqfold.methods.FFNISaddlepoint().estimate(problem, uqfold.criteria(threshold=2.0))
>>> result.n_evals
75
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

__version__ = "0.1.0"

if TYPE_CHECKING:
    from uqfold import (
        analysis,
        inputs,
        mechanism,
        methods,
        plots,
        problems,
        report,
        system,
        testing,
    )
    from uqfold.comparison.run import compare
    from uqfold.evaluation.evaluator import Evaluator
    from uqfold.methods.base import ReliabilityMethod
    from uqfold.methods.result import ReliabilityResult
    from uqfold.problems.base import Problem, Unit
    from uqfold.problems.criterion import Binomial, Criteria, Criterion, criteria
    from uqfold.problems.structure import CutSets, KOutOfN, Parallel, Series

__all__ = [
    "Binomial",
    "Criteria",
    "Criterion",
    "CutSets",
    "Evaluator",
    "KOutOfN",
    "Parallel",
    "Problem",
    "ReliabilityMethod",
    "ReliabilityResult",
    "Series",
    "Unit",
    "analysis",
    "compare",
    "criteria",
    "inputs",
    "mechanism",
    "methods",
    "plots",
    "problems",
    "report",
    "system",
    "testing",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Binomial": "uqfold.problems.criterion",
        "Criteria": "uqfold.problems.criterion",
        "Criterion": "uqfold.problems.criterion",
        "CutSets": "uqfold.problems.structure",
        "Evaluator": "uqfold.evaluation.evaluator",
        "KOutOfN": "uqfold.problems.structure",
        "Parallel": "uqfold.problems.structure",
        "Problem": "uqfold.problems.base",
        "ReliabilityMethod": "uqfold.methods.base",
        "ReliabilityResult": "uqfold.methods.result",
        "Series": "uqfold.problems.structure",
        "Unit": "uqfold.problems.base",
        "analysis": "uqfold.analysis",
        "compare": "uqfold.comparison.run",
        "criteria": "uqfold.problems.criterion",
        "inputs": "uqfold.inputs",
        "mechanism": "uqfold.mechanism",
        "methods": "uqfold.methods",
        "plots": "uqfold.plots",
        "problems": "uqfold.problems",
        "report": "uqfold.report",
        "system": "uqfold.system",
        "testing": "uqfold.testing",
    },
)
