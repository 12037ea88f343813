"""Sobol' indices of the response: which inputs its variance comes from.

Two routes that share nothing. A polynomial chaos expansion has the indices among its coefficients.
Pick-freeze sampling (Saltelli et al. 2010) runs the model itself on two independent samples A and
B and on A with one column of B after the other; scrambled repetitions give its error. Where there
are several shared inputs, they also have one index together: the correlation of the responses of
two units of one system.

With dependent inputs the indices are those of the variables of the Rosenblatt transformation, each
an input given those before it, and change with the order of the columns. They are named so, and a
warning says it; `conditional_sobol` has the indices that do not.

References
----------
Saltelli A. et al. Variance based sensitivity analysis of model output. Design and estimator for the
total sensitivity index. Comput. Phys. Commun. 181 (2010) 259-270.
Sudret B. Global sensitivity analysis using polynomial chaos expansions. Reliab. Eng. Syst. Saf.
93 (2008) 964-979.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.analysis.affordable import check_affordable
from uqfold.analysis.fitted_surface import fit_surface
from uqfold.checks import instance, or_none, refused, whole
from uqfold.evaluation import EvaluationSession, Evaluator
from uqfold.inputs import JointInputs
from uqfold.methods.arguments import checked_budget, checked_evaluator, checked_unit
from uqfold.methods.polynomial_chaos import PolynomialChaos
from uqfold.methods.result import ErrorKind
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.methods.tabular import Tabular
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.problems.structure import Series
from uqfold.problems.units import UnitKinds
from uqfold.surrogates.polynomial_chaos import PolynomialChaosExpansion
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    pass

Order: TypeAlias = Literal["main", "total"]

PICK_FREEZE = "pick-freeze"
ALL_SHARED = "all shared inputs"
"""What the group index is called."""
_DRAWS, _DRAWN_SAMPLES = 40, 2048
_STREAM = 11


@dataclass(frozen=True)
class SobolIndex:
    """One index.

    Attributes
    ----------
    input
        Name of the input, or `ALL_SHARED`. Where inputs are dependent, the variable of the
        Rosenblatt transformation: "L given D".
    shared
        Whether it is shared by the units.
    order
        ``main``: share of the variance by this input alone; ``total``: with its interactions.
    index, std_error
        The index and its standard error.
    ci_low, ci_high
        Interval of 95 %.
    error_kind
        What the error covers: ``sampling`` or ``surrogate``.
    method
        ``pick-freeze``, ``pce`` or ``conditional``.
    """

    input: str
    shared: bool
    order: Order
    index: float
    std_error: float
    ci_low: float
    ci_high: float
    error_kind: ErrorKind
    method: str


@dataclass(frozen=True, repr=False)
class SobolIndices(Tabular[SobolIndex]):
    """Indices of all inputs, main ones first, then that of all shared inputs, then total ones.

    Attributes
    ----------
    rows
        One `SobolIndex` each.
    mean, std
        Mean and standard deviation of the response, in its unit.
    n_evals, n_reused
        Evaluations behind them, and how many came from a store.
    seconds, seed
        Wall time (s), and the seed that repeats the run.
    """

    rows: tuple[SobolIndex, ...]
    mean: float
    std: float
    n_evals: int
    n_reused: int
    seconds: float
    seed: int

    _SHOWN = ("input", "order", "index", "std_error", "ci_low", "ci_high", "error_kind", "method")


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


def checked_samples(samples: int) -> int:
    """Return a power of two, at least 4.

    Raises
    ------
    ValueError, TypeError
        If it is none.
    """
    samples = whole("samples", samples, at_least=4, what="power of two")
    if samples & (samples - 1):
        raise refused("samples", samples, "give a power of two >= 4")
    return samples


def responses_with_variance(session: EvaluationSession, x: FloatArray) -> FloatArray:
    """Responses (n,) of rows X, all of them finite.

    Raises
    ------
    ValueError
        If one is infinite or a run failed.
    """
    y = session.evaluate(x)
    if not np.isfinite(y).all():
        bad = int((~np.isfinite(y)).sum())
        raise ValueError(
            f"{bad} of {y.size} responses are infinite or failed: the response has no "
            "variance to share out"
        )
    return y


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


def standard_pairs(
    size: int, dimension: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Two independent standard-normal samples A and B, each (size, dimension)."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    cube = qmc.Sobol(2 * dimension, rng=rng).random(size)
    both = ndtri(np.clip(cube, 1e-12, 1.0 - 1e-12))
    return both[:, :dimension], both[:, dimension:]


def frozen_rows(a: FloatArray, b: FloatArray, chosen: Sequence[tuple[int, ...]]) -> FloatArray:
    """Rows A, B, then A with each choice of columns taken from B."""
    mixed = []
    for columns in chosen:
        rows = a.copy()
        rows[:, columns] = b[:, columns]
        mixed.append(rows)
    return np.vstack([a, b, *mixed])


def saltelli(table: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Main and total index (k,) of each exchange, from responses (2 + k, n) to `frozen_rows`."""
    from scipy.stats import sobol_indices

    found = sobol_indices(
        func={"f_A": table[:1], "f_B": table[1:2], "f_AB": table[2:, None, :]}, n=table.shape[1]
    )
    return found.first_order.ravel(), found.total_order.ravel()


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


def labelled_rows(
    inputs: JointInputs,
    values: FloatArray,
    errors: FloatArray,
    reach: float,
    error_kind: ErrorKind,
    method: str,
    names: Sequence[str],
) -> tuple[SobolIndex, ...]:
    """Rows of a result: main indices, that of the group if there is one, then total indices.

    `reach` is the half width of the intervals in standard errors.
    """
    singles = [(name, i < inputs.n_shared) for i, name in enumerate(names)]
    group = [(ALL_SHARED, True)] if inputs.shared_are_a_group else []
    labels: Sequence[tuple[str, bool, Order]] = [
        *((name, shared, "main") for name, shared in [*singles, *group]),
        *((name, shared, "total") for name, shared in singles),
    ]
    return tuple(
        SobolIndex(
            name, shared, order, float(value), float(error),
            float(value - reach * error), float(value + reach * error), error_kind, method,
        )
        for (name, shared, order), value, error in zip(labels, values, errors, strict=True)
    )  # fmt: skip


def student_quantile(freedom: int) -> float:
    """Quantile of Student's distribution behind a 95 % interval."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))
