"""Sobol' indices of the response: which inputs its variance comes from.

Two routes that share nothing. A polynomial chaos expansion has the indices among its coefficients.
Pick-freeze sampling (`exchanged_columns`) runs the model itself on two independent samples A and
B and on A with one column of B after the other; scrambled repetitions give its error. Where there
are several shared inputs, they also have one index together: the correlation of the responses of
two units of one system.

With dependent inputs the indices are those of the variables of the Rosenblatt transformation, each
an input given those before it, and change with the order of the columns. They are named so, and a
warning says it; `conditional_sobol` has the indices that do not.

References
----------
Sudret B. Global sensitivity analysis using polynomial chaos expansions. Reliab. Eng. Syst. Saf.
93 (2008) 964-979.
"""

from __future__ import annotations

import math
import time
import warnings
from copy import copy

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.analysis.affordable import check_affordable
from uqfold.analysis.exchanged_columns import (
    checked_samples,
    frozen_rows,
    responses_with_variance,
    saltelli,
    standard_pairs,
)
from uqfold.analysis.fitted_surface import fit_surface
from uqfold.analysis.sobol_rows import SobolIndices, labelled_rows, student_quantile
from uqfold.checks import instance, or_none, whole
from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.methods.arguments import checked_budget, checked_evaluator, checked_unit
from uqfold.methods.polynomial_chaos import PolynomialChaos
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.problems.structure import Series
from uqfold.problems.units import UnitKinds
from uqfold.surrogates.polynomial_chaos import PolynomialChaosExpansion
from uqfold.typing import FloatArray

PICK_FREEZE = "pick-freeze"
_DRAWS, _DRAWN_SAMPLES = 40, 2048
_STREAM = 11


def pick_freeze(
    problem: Problem,
    samples: int = 1024,
    repetitions: int = 8,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> SobolIndices:
    """Estimate Sobol' indices by running the model itself.

    Parameters
    ----------
    problem
        Model and inputs, d of them.
    samples
        Size of the samples A and B, a power of two: Sobol' sequences, scrambled anew for each
        repetition.
    repetitions
        Independent repetitions, at least 3; their spread is the error. All together take
        ``repetitions * samples * (d + 2)`` runs, d + 3 where shared inputs form a group.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`; a budget must pay for all runs.

    Raises
    ------
    ValueError
        For wrong arguments, or if a response is infinite or a run fails: there is no variance.
    BudgetExceededError
        If the runs cost more than `max_evals`; none is made then.
    """
    started = time.perf_counter()
    checked_unit(problem)
    samples = checked_samples(samples)
    repetitions = whole("repetitions", repetitions, at_least=3)
    inputs = problem.inputs
    seed = reduced_seed(rng)
    session = checked_evaluator(evaluator).open(problem, checked_budget(max_evals))
    points = _points(inputs.dimension, inputs.n_shared)
    session.expected = repetitions * samples * points
    check_affordable(session, session.expected)
    warn_of_order(inputs)
    found, moments = [], []
    for block in range(repetitions):
        u = _design(samples, inputs.dimension, inputs.n_shared, block_generator(seed, block))
        y = responses_with_variance(session, inputs.from_standard_normal(u))
        found.append(_indices(y, inputs.dimension, inputs.n_shared))
        both = y[: 2 * samples]
        moments.append((both.mean(), both.std()))
    values = np.array(found)
    mean, std = np.mean(moments, axis=0)
    return SobolIndices(
        rows=labelled_rows(
            inputs, values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(repetitions),
            student_quantile(repetitions - 1), "sampling", PICK_FREEZE, _variables(inputs),
        ),
        mean=float(mean),
        std=float(std),
        n_evals=session.n_evals,
        n_reused=session.n_reused,
        seconds=time.perf_counter() - started,
        seed=seed,
    )  # fmt: skip


@one_blas_thread()
def chaos_sobol(
    problem: Problem,
    method: PolynomialChaos | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> SobolIndices:
    """Read Sobol' indices off a polynomial chaos expansion.

    Parameters
    ----------
    problem
        Model and inputs.
    method
        How the expansion is made; None: with the default settings.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Returns
    -------
    SobolIndices
        Their errors are the spread of the indices of surfaces that the residuals allow.

    Raises
    ------
    NoSurfaceError
        If the evaluations allow no expansion.
    """
    started = time.perf_counter()
    warn_of_order(checked_unit(problem).inputs)
    wanted = "give PolynomialChaos(...)"
    chosen = or_none("method", method, instance, PolynomialChaos, wanted) or PolynomialChaos()
    # it is the surface that is wanted, whatever criterion and however many units are asked for
    fitted = fit_surface(
        _one_unit(problem), criteria(math.inf), chosen,
        max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    expansion = fitted.surface
    assert isinstance(expansion, PolynomialChaosExpansion)
    d, n_shared = problem.inputs.dimension, problem.inputs.n_shared
    rng_draws = block_generator(fitted.result.seed, _STREAM)
    u = _design(_DRAWN_SAMPLES, d, n_shared, rng_draws)
    own = _indices(expansion.mean(u), d, n_shared)
    paths = expansion.sample_paths(rng_draws, _DRAWS)(u)
    # the same points for all surfaces: what their sampling errors share cancels
    changes = np.array([_indices(y, d, n_shared) - own for y in paths])
    errors = fitted.overconfidence * np.sqrt(np.mean(changes**2, axis=0))
    return SobolIndices(
        rows=labelled_rows(
            problem.inputs,
            _of_expansion(expansion, n_shared),
            errors,
            1.96,
            "surrogate",
            "pce",
            _variables(problem.inputs),
        ),
        mean=expansion.mean_response,
        std=math.sqrt(expansion.variance),
        n_evals=fitted.result.n_evals,
        n_reused=fitted.result[0].n_reused,
        seconds=time.perf_counter() - started,
        seed=fitted.result.seed,
    )


def _one_unit(problem: Problem) -> Problem:
    """Return the same model and inputs as a system of one unit, whose pf takes no time to find."""
    alone = copy(problem)
    for name, value in (
        ("units", 1),
        ("structure", Series()),
        ("kinds", UnitKinds((problem.model,), (problem.inputs,), partners=problem.kinds.partners)),
    ):
        object.__setattr__(alone, name, value)
    return alone


def warn_of_order(inputs: JointInputs) -> None:
    """Warn that indices of dependent inputs change with the order of the columns."""
    if not inputs.independent:
        variables = [name for name in _variables(inputs) if name not in inputs.names]
        warnings.warn(
            "the inputs are dependent: these Sobol' indices are those of the variables "
            f"{', '.join(variables)} of the Rosenblatt transformation, and change with the order "
            "of the columns; conditional_sobol has indices of the inputs that do not",
            UserWarning,
            stacklevel=3,
        )


def _variables(inputs: JointInputs) -> tuple[str, ...]:
    """What the variables of the Rosenblatt transformation are: inputs, given those before."""
    return tuple(
        f"{name} given {', '.join(before)}" if before else name
        for name, before in zip(inputs.names, inputs.conditioning, strict=True)
    )


def _grouped(dimension: int, n_shared: int) -> bool:
    """Whether the shared inputs, more than one, are a group among others."""
    return 1 < n_shared < dimension


def _points(dimension: int, n_shared: int) -> int:
    return dimension + 2 + int(_grouped(dimension, n_shared))


def _design(size: int, dimension: int, n_shared: int, rng: np.random.Generator) -> FloatArray:
    """Rows A, B, then A with each column of B, then A with all shared columns of B."""
    a, b = standard_pairs(size, dimension, rng)
    chosen = [(i,) for i in range(dimension)]
    group = [tuple(range(n_shared))] if _grouped(dimension, n_shared) else []
    return frozen_rows(a, b, [*chosen, *group])


def _indices(y: FloatArray, dimension: int, n_shared: int) -> FloatArray:
    """Main indices of the inputs, that of the group if there is one, then total indices."""
    main, total = saltelli(y.reshape(_points(dimension, n_shared), -1))
    return np.concatenate([main, total[:dimension]])


def _of_expansion(expansion: PolynomialChaosExpansion, n_shared: int) -> FloatArray:
    sobol = expansion.sobol_indices()
    group: list[float] = []
    if _grouped(expansion.indices.shape[1], n_shared):
        active = expansion.indices > 0
        within = active.any(axis=1) & ~active[:, n_shared:].any(axis=1)
        group = [float(np.sum(expansion.coefficients[within] ** 2)) / expansion.variance]
    return np.concatenate([sobol.main, group, sobol.total])
