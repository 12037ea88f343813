"""Sobol' indices as a result: one row for each index, with its error and interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from uqfold.inputs import JointInputs
from uqfold.methods.result import ErrorKind
from uqfold.methods.tabular import Tabular
from uqfold.typing import FloatArray

Order: TypeAlias = Literal["main", "total"]

ALL_SHARED = "all shared inputs"
"""What the group index is called."""


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
