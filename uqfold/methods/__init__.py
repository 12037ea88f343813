"""Reliability methods behind one interface; `available()` lists them by name."""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.methods.active_kriging import ActiveKriging
    from uqfold.methods.ask_tell import AskTellSession, SequentialMethod
    from uqfold.methods.base import ReliabilityMethod, Solution, Task
    from uqfold.methods.conditional_monte_carlo import ConditionalMonteCarlo
    from uqfold.methods.ffni_pearson import FFNIPearson
    from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
    from uqfold.methods.kriging import Kriging
    from uqfold.methods.monte_carlo import MonteCarlo
    from uqfold.methods.openturns_form import OpenTURNSFORM
    from uqfold.methods.openturns_monte_carlo import OpenTURNSMonteCarlo
    from uqfold.methods.polynomial_chaos import PolynomialChaos
    from uqfold.methods.registry import available, build
    from uqfold.methods.result import CriterionResult, Estimate, ReliabilityResult

__all__ = [
    "ActiveKriging",
    "AskTellSession",
    "ConditionalMonteCarlo",
    "CriterionResult",
    "Estimate",
    "FFNIPearson",
    "FFNISaddlepoint",
    "Kriging",
    "MonteCarlo",
    "OpenTURNSFORM",
    "OpenTURNSMonteCarlo",
    "PolynomialChaos",
    "ReliabilityMethod",
    "ReliabilityResult",
    "SequentialMethod",
    "Solution",
    "Task",
    "available",
    "build",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "ActiveKriging": "uqfold.methods.active_kriging",
        "AskTellSession": "uqfold.methods.ask_tell",
        "SequentialMethod": "uqfold.methods.ask_tell",
        "ConditionalMonteCarlo": "uqfold.methods.conditional_monte_carlo",
        "CriterionResult": "uqfold.methods.result",
        "Estimate": "uqfold.methods.result",
        "FFNIPearson": "uqfold.methods.ffni_pearson",
        "FFNISaddlepoint": "uqfold.methods.ffni_saddlepoint",
        "Kriging": "uqfold.methods.kriging",
        "MonteCarlo": "uqfold.methods.monte_carlo",
        "OpenTURNSFORM": "uqfold.methods.openturns_form",
        "OpenTURNSMonteCarlo": "uqfold.methods.openturns_monte_carlo",
        "PolynomialChaos": "uqfold.methods.polynomial_chaos",
        "ReliabilityMethod": "uqfold.methods.base",
        "ReliabilityResult": "uqfold.methods.result",
        "Solution": "uqfold.methods.base",
        "Task": "uqfold.methods.base",
        "available": "uqfold.methods.registry",
        "build": "uqfold.methods.registry",
    },
)
