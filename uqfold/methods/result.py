"""What every method returns: one row per criterion, with cost, error and status."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from uqfold.checks import keep, or_none, real, text, whole
from uqfold.methods.tabular import Tabular
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd
    import xarray

Status: TypeAlias = Literal[
    "converged", "unchecked", "budget_exhausted", "doubtful", "unsupported", "failed"
]
STATUSES: tuple[Status, ...] = get_args(Status)
"""All statuses, from the best to the worst; see ``docs/conventions.md``."""
ErrorKind: TypeAlias = Literal["sampling", "surrogate", "none"]
NO_ANSWER: frozenset[str] = frozenset({"unsupported", "failed"})
TARGET_COV = 0.1
"""Largest stated error, relative to pf, of a row that is not ``doubtful``, where none is set."""
NORMAL_95 = 1.959963984540054
"""Half the width of a normal 95 % interval, in standard deviations."""


@dataclass(frozen=True)
class Estimate:
    """A method's own answer to one criterion; the base adds cost and identity.

    Attributes
    ----------
    pf
        Failure probability; NaN only with the statuses ``unsupported`` and ``failed``.
    reliability
        1 - pf, computed directly where pf is close to one; None: take the complement.
    std_error
        Standard error of pf, NaN where the method has none.
    ci_low, ci_high, ci_kind
        Interval on pf and what it is; NaN and empty where the method has none.
    pf_low, pf_high
        Bounds on pf that hold whatever the failed runs would have been; None: not computed.
    error_kind
        What `std_error` and the interval cover: ``sampling``, ``surrogate`` or ``none``.
    status
        ``converged`` only where the stated error was met or estimated. Without a standard error
        and without an interval the base makes it ``unchecked``; with an error above the target of
        the method (`ReliabilityMethod.target_cov`), ``doubtful``.
    n_evals_row
        Runs spent on this criterion alone; None: the whole run's.
    """

    pf: float
    reliability: float | None = None
    std_error: float = math.nan
    ci_low: float = math.nan
    ci_high: float = math.nan
    ci_kind: str = ""
    pf_low: float | None = None
    pf_high: float | None = None
    error_kind: ErrorKind = "none"
    status: Status = "converged"
    message: str = ""
    n_evals_row: int | None = None

    def __post_init__(self) -> None:
        for name in ("pf", "std_error", "ci_low", "ci_high"):
            keep(self, name, real, finite=False, nan=True)
        for name in ("reliability", "pf_low", "pf_high"):
            keep(self, name, or_none, real, finite=False, nan=True)
        for name in ("ci_kind", "error_kind", "status", "message"):
            keep(self, name, text, empty=True)
        keep(self, "n_evals_row", or_none, whole, at_least=0)

    @classmethod
    def without_answer(cls, status: Literal["unsupported", "failed"], message: str) -> Estimate:
        """Return the row of a criterion that has no answer, and why."""
        return cls(pf=math.nan, status=status, message=message)

    @property
    def states_an_error(self) -> bool:
        """Whether it has a standard error or an interval."""
        return math.isfinite(self.stated_error)

    @property
    def stated_error(self) -> float:
        """The standard error; where it is zero or missing, what the interval stands for; or NaN."""
        return stated_error(self)


@dataclass(frozen=True)
class CriterionResult:
    """One row of a `ReliabilityResult`; fields as in `Estimate`, plus cost and identity.

    Attributes
    ----------
    threshold, tau, missions, missions_planned, missions_p
        The criterion: T, tau (NaN: none), a label of the mission profile, and for a binomial
        number its parameters (NaN otherwise).
    beta
        Generalised reliability index -Phi^-1(pf).
    n_evals, n_reused, n_failed
        Evaluations of the whole estimate, how many of them came from a store, how many failed.
    seconds
        Wall time of the whole estimate (s).
    """

    threshold: float
    tau: float
    missions: str
    missions_planned: float
    missions_p: float
    pf: float
    reliability: float
    beta: float
    std_error: float
    ci_low: float
    ci_high: float
    ci_kind: str
    pf_low: float
    pf_high: float
    error_kind: ErrorKind
    status: Status
    message: str
    n_evals: int
    n_evals_row: int
    n_reused: int
    n_failed: int
    seconds: float
    method: str
    seed: int


def stated_error(row: Estimate | CriterionResult) -> float:
    """Return its standard error; where it is zero or missing, what the interval stands for."""
    by_interval = (row.ci_high - row.ci_low) / (2.0 * NORMAL_95)
    if row.std_error > 0.0 or not math.isfinite(by_interval):
        return row.std_error
    return by_interval


@dataclass(frozen=True, repr=False)
class ReliabilityResult(Tabular[CriterionResult]):
    """Answers of one method run, one row per criterion, in the order of the criteria.

    It prints as a short table; `to_frame` has all that is known of each row.

    Attributes
    ----------
    criteria
        The criteria asked for.
    rows
        One `CriterionResult` for each.
    details
        What the method found on its way (design points, moments, ...): a frozen record of a type
        that belongs to the method, or None.
    problem
        Name of the problem that was asked about.
    system
        `Problem.system_digest` of it, by which an answer to another question is told.
    n_gradients
        Gradients that the problem was asked for, one per row, beside the evaluations.
    samples
        The runs, if the evaluator was to keep them (`Evaluator(samples=True)`): ``run`` (the
        number), every input by name, ``response`` (NaN: failed), and what the method says of them:
        ``phase``, ``level``, ``sample`` (which system a run belongs to), ``weight``.
    """

    criteria: tuple[Criterion, ...]
    rows: tuple[CriterionResult, ...]
    details: Any = None
    problem: str = ""
    system: str = ""
    n_gradients: int = 0
    samples: pd.DataFrame | None = field(default=None, compare=False)

    _SHOWN = (
        "threshold", "tau", "missions", "pf", "std_error", "ci_low", "ci_high", "n_evals_row",
        "status",
    )  # fmt: skip

    def __post_init__(self) -> None:
        if len(self.criteria) != len(self.rows):
            raise ValueError(f"{len(self.rows)} rows for {len(self.criteria)} criteria")

    @property
    def pf(self) -> FloatArray:
        """Failure probabilities (n_criteria,)."""
        return np.array([row.pf for row in self.rows])

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.rows[0].method

    @property
    def n_evals(self) -> int:
        """Evaluations of the whole estimate."""
        return self.rows[0].n_evals

    @property
    def n_reused(self) -> int:
        """How many of them came from a store."""
        return self.rows[0].n_reused

    @property
    def n_failed(self) -> int:
        """How many of them failed."""
        return self.rows[0].n_failed

    @property
    def seconds(self) -> float:
        """Wall time of the whole estimate (s)."""
        return self.rows[0].seconds

    @property
    def seed(self) -> int:
        """Seed from which the run can be repeated."""
        return self.rows[0].seed

    def to_xarray(self) -> xarray.Dataset:
        """Return the answers as a grid over ``threshold``, ``tau`` and ``missions``.

        tau and missions are dimensions only where they differ; an infinite tau stands for none.
        A combination that was not asked holds NaN. What all rows share (method, seed, cost) is in
        ``attrs``. It needs the package ``xarray`` (the extra of that name).

        Raises
        ------
        ImportError
            If ``xarray`` is not installed.
        ValueError
            If a criterion was asked twice.
        """
        frame = self.to_frame()
        shared = ("method", "seed", "seconds", "n_evals", "n_reused", "n_failed")
        frame["tau"] = frame["tau"].fillna(np.inf)
        over = [name for name in ("tau", "missions") if frame[name].nunique() > 1]
        grid = frame.set_index(["threshold", *over])
        if not grid.index.is_unique:
            raise ValueError("criteria: one was asked twice, which a grid has no place for")
        left_out = [*shared, "missions_planned", "missions_p", "tau", "missions"]
        found: xarray.Dataset = grid.drop(columns=left_out, errors="ignore").to_xarray()
        rest = [name for name in ("tau", "missions") if name not in over]
        return found.assign_attrs({name: frame[name].iloc[0] for name in (*shared, *rest)})

    def to_openturns(self, event: Any = None) -> list[Any]:
        """Return an ``openturns.ProbabilitySimulationResult`` for each row.

        It holds pf, the square of its standard error (where that is zero or missing, what the
        interval stands for), the runs spent on the row as blocks of one, the time of the whole
        estimate, and as its name what the row says of itself: method, status and message.
        Intervals that OpenTURNS derives from it are normal ones, not those of the method.

        Parameters
        ----------
        event
            The OpenTURNS event that the problem was made of (`Problem.from_openturns`), which the
            results then carry; None: they carry none.

        Raises
        ------
        TypeError, ValueError
            If it is no event, or a row has no answer or no standard error of sampling.

        Examples
        --------
        >>> from uqfold.methods import MonteCarlo
        >>> from uqfold.problems import series
        >>> result = MonteCarlo(systems=1_000).estimate(series(), 2.0, rng=1)
        >>> (made,) = result.to_openturns()
        >>> made.getProbabilityEstimate() == result[0].pf, made.getOuterSampling()
        (True, 4000)
        """
        from uqfold.inputs.simulation_result import checked_event, simulation_result

        checked = checked_event(event)
        made = []
        for i, row in enumerate(self.rows):
            error = stated_error(row)
            if row.error_kind != "sampling" or math.isnan(row.pf) or math.isnan(error):
                said = f"{row.status}, error_kind = {row.error_kind!r}"
                remedy = "only answers of simulations with an error have such a result"
                raise ValueError(f"row {i} of {row.method} ({said}): {remedy}")
            name = f"{row.method}: {row.status}{': ' if row.message else ''}{row.message}"
            numbers = (row.pf, error, row.n_evals_row, row.seconds)
            made.append(simulation_result(checked, *numbers, name))
        return made

    def to_records(self) -> list[dict[str, Any]]:
        """One dictionary per row, in the columns of `CriterionResult`."""
        names = [one.name for one in fields(CriterionResult)]
        return [{name: getattr(row, name) for name in names} for row in self.rows]


@dataclass(frozen=True)
class RunCost:
    """What the base knows about a finished run and every row repeats."""

    n_evals: int
    n_reused: int
    n_failed: int
    seconds: float
    method: str
    seed: int


def finished_row(criterion: Criterion, estimate: Estimate, cost: RunCost) -> CriterionResult:
    """Join a method's estimate with the criterion and the cost of the run."""
    binomial = criterion.missions if isinstance(criterion.missions, Binomial) else None
    reliability = 1.0 - estimate.pf if estimate.reliability is None else estimate.reliability
    n_evals_row = cost.n_evals if estimate.n_evals_row is None else estimate.n_evals_row
    shared: Mapping[str, Any] = {
        name: getattr(estimate, name)
        for name in ("pf", "std_error", "ci_low", "ci_high", "ci_kind", "error_kind", "status")
    }
    return CriterionResult(
        threshold=criterion.threshold,
        tau=math.nan if criterion.tau is None else criterion.tau,
        missions=str(criterion.missions),
        missions_planned=math.nan if binomial is None else binomial.planned,
        missions_p=math.nan if binomial is None else binomial.p,
        reliability=reliability,
        beta=reliability_index(estimate.pf, reliability),
        pf_low=estimate.pf if estimate.pf_low is None else estimate.pf_low,
        pf_high=estimate.pf if estimate.pf_high is None else estimate.pf_high,
        message=estimate.message,
        n_evals=cost.n_evals,
        n_evals_row=n_evals_row,
        n_reused=cost.n_reused,
        n_failed=cost.n_failed,
        seconds=cost.seconds,
        method=cost.method,
        seed=cost.seed,
        **shared,
    )


def reliability_index(pf: float, reliability: float) -> float:
    """Generalised reliability index beta = -Phi^-1(pf), from the smaller of the two tails."""
    if math.isnan(pf):
        return math.nan
    from scipy.special import ndtri

    # adding zero turns the -0.0 at pf = 1/2 into 0.0
    return float(-ndtri(pf) if pf <= reliability else ndtri(reliability)) + 0.0
