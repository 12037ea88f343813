from uqfold import (
    analysis as analysis,
    comparison as comparison,
    evaluation as evaluation,
    inputs as inputs,
    mechanism as mechanism,
    methods as methods,
    plots as plots,
    problems as problems,
    report as report,
    system as system,
    testing as testing,
    validation as validation,
)
from uqfold.comparison.benchmark_run import benchmark as benchmark
from uqfold.comparison.run import compare as compare
from uqfold.evaluation.evaluator import Evaluator as Evaluator
from uqfold.methods.automatic import estimate as estimate
from uqfold.methods.base import ReliabilityMethod as ReliabilityMethod
from uqfold.methods.result import ReliabilityResult as ReliabilityResult
from uqfold.problems.base import Problem as Problem
from uqfold.problems.criterion import (
    Binomial as Binomial,
    Criteria as Criteria,
    Criterion as Criterion,
    criteria as criteria,
)
from uqfold.problems.structure import (
    CutSets as CutSets,
    KOutOfN as KOutOfN,
    Parallel as Parallel,
    PathSets as PathSets,
    Series as Series,
    Structure as Structure,
)
from uqfold.problems.units import Unit as Unit

__version__: str
