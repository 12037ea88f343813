"""Reliability methods behind one interface; `available()` lists them by name."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.methods.base import ReliabilityMethod, Solution, Task
    from uqfold.methods.ffni_pearson import FFNIPearson
    from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
    from uqfold.methods.monte_carlo import MonteCarlo
    from uqfold.methods.openturns_form import OpenTURNSFORM
    from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo
    from uqfold.methods.registry import available, build
    from uqfold.methods.result import CriterionResult, Estimate, ReliabilityResult

__all__ = [
    "CriterionResult",
    "Estimate",
    "FFNIPearson",
    "FFNISaddlepoint",
    "MonteCarlo",
    "OpenTURNSFORM",
    "OpenTURNSMonteCarlo",
    "ReliabilityMethod",
    "ReliabilityResult",
    "Solution",
    "Task",
    "available",
    "build",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "CriterionResult": "uqfold.methods.result",
        "Estimate": "uqfold.methods.result",
        "FFNIPearson": "uqfold.methods.ffni_pearson",
        "FFNISaddlepoint": "uqfold.methods.ffni_saddlepoint",
        "MonteCarlo": "uqfold.methods.monte_carlo",
        "OpenTURNSFORM": "uqfold.methods.openturns_form",
        "OpenTURNSMonteCarlo": "uqfold.methods.openturns_monte_carlo",
        "ReliabilityMethod": "uqfold.methods.base",
        "ReliabilityResult": "uqfold.methods.result",
        "Solution": "uqfold.methods.base",
        "Task": "uqfold.methods.base",
        "available": "uqfold.methods.registry",
        "build": "uqfold.methods.registry",
    },
)
