"""Derivatives of the system's failure probability by means and standard deviations of inputs.

Beside the derivative itself, in 1 over the unit of the input, stand two numbers without a unit,
so that inputs compare: the relative change of pf per standard deviation of the input (Wu 1994),
and the relative change of pf per relative change of the parameter, the elasticity.

References
----------
Wu Y.-T. Computational methods for efficient structural reliability and reliability sensitivity
analysis. AIAA Journal 32 (1994) 1717-1723.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from uqfold.checks import choice, names, refused
from uqfold.inputs.score import Moment
from uqfold.methods.result import ErrorKind, Status
from uqfold.methods.tabular import Tabular
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion

if TYPE_CHECKING:
    pass

CONFIDENT = 1.96
"""Quantile of the normal distribution behind a 95 % interval."""


@dataclass(frozen=True)
class InputParameter:
    """The mean or the standard deviation of one input.

    Attributes
    ----------
    input, unit
        Name of the input and its unit.
    shared
        Whether the input is shared by the units.
    moment
        ``mean`` or ``standard deviation``.
    value, std
        The parameter's value, and the standard deviation of the input.
    """

    input: str
    unit: str
    shared: bool
    moment: Moment
    value: float
    std: float


def input_parameters(problem: Problem) -> tuple[InputParameter, ...]:
    """Means of all inputs, then their standard deviations.

    Raises
    ------
    ValueError
        If an input has no finite mean and standard deviation.
    """
    inputs = problem.inputs
    rows = list(zip(inputs.names, problem.input_units, inputs.means, inputs.standard_deviations,
                    strict=True))  # fmt: skip
    return tuple(
        InputParameter(
            name, unit, column < inputs.n_shared, moment,
            float(mean if moment == "mean" else std), float(std),
        )
        for moment in _MOMENTS
        for column, (name, unit, mean, std) in enumerate(rows)
    )  # fmt: skip


_MOMENTS: tuple[Moment, ...] = ("mean", "standard deviation")


@dataclass(frozen=True)
class PfDerivative:
    """Derivative of pf under one criterion by one parameter; units as in `InputParameter`.

    Attributes
    ----------
    threshold, tau, missions
        The criterion; tau is NaN where there is none.
    pf
        Failure probability.
    derivative, std_error
        d pf / d parameter, and its standard error.
    per_std, per_std_error
        Relative change of pf per standard deviation of the input: sigma / pf times the
        derivative. NaN where pf is 0.
    elasticity, elasticity_error
        Relative change of pf per relative change of the parameter; 0 for a parameter that is 0.
    error_kind
        What the errors cover: ``sampling`` or ``surrogate``.
    method, status, message
        Who says so, and whether pf itself is trusted, see `uqfold.methods.CriterionResult`.
    """

    input: str
    unit: str
    shared: bool
    moment: Moment
    value: float
    std: float
    threshold: float
    tau: float
    missions: str
    pf: float
    derivative: float
    std_error: float
    per_std: float
    per_std_error: float
    elasticity: float
    elasticity_error: float
    error_kind: ErrorKind
    method: str
    status: Status
    message: str

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 % on the derivative."""
        reach = CONFIDENT * self.std_error
        return self.derivative - reach, self.derivative + reach


@dataclass(frozen=True, repr=False)
class PfDerivatives(Tabular[PfDerivative]):
    """Derivatives for all criteria and parameters, criteria first.

    Attributes
    ----------
    rows
        One `PfDerivative` each.
    n_evals, n_reused, n_failed
        Evaluations behind them, how many came from a store, how many failed.
    seconds, seed
        Wall time (s), and the seed that repeats the run.
    """

    rows: tuple[PfDerivative, ...]
    n_evals: int
    n_reused: int
    n_failed: int
    seconds: float
    seed: int

    _SHOWN = (
        "threshold",
        "tau",
        "missions",
        "input",
        "moment",
        "pf",
        "derivative",
        "std_error",
        "per_std",
        "status",
    )


@dataclass(frozen=True)
class Differentiated:
    """What a route to derivatives finds for one criterion and parameter.

    Attributes
    ----------
    derivative, std_error
        d pf / d parameter.
    relative, relative_error
        d ln pf / d parameter, whose error knows that pf and its derivative err together.
    """

    derivative: float
    std_error: float
    relative: float
    relative_error: float


def derivative_row(
    criterion: Criterion,
    parameter: InputParameter,
    pf: float,
    found: Differentiated,
    error_kind: ErrorKind,
    method: str,
    status: Status = "converged",
    message: str = "",
) -> PfDerivative:
    """Join a derivative with its criterion and parameter."""
    return PfDerivative(
        **asdict(parameter),
        threshold=criterion.threshold,
        tau=math.nan if criterion.tau is None else criterion.tau,
        missions=str(criterion.missions),
        pf=pf,
        derivative=found.derivative,
        std_error=found.std_error,
        per_std=parameter.std * found.relative,
        per_std_error=parameter.std * found.relative_error,
        elasticity=parameter.value * found.relative,
        elasticity_error=abs(parameter.value) * found.relative_error,
        error_kind=error_kind,
        method=method,
        status=status,
        message=message,
    )


def chosen_parameters(problem: Problem, inputs: Sequence[str] | None) -> tuple[InputParameter, ...]:
    """Parameters of the named inputs; None: of all.

    Raises
    ------
    ValueError, TypeError
        If a name is not one of the inputs.
    """
    every = input_parameters(problem)
    if inputs is None:
        return every
    known = problem.inputs.names
    chosen = {choice(f"inputs[{i}]", one, known) for i, one in enumerate(names("inputs", inputs))}
    if not chosen:
        raise refused("inputs", inputs, "name at least one input, or give None for all")
    return tuple(p for p in every if p.input in chosen)
