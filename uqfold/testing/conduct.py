"""Checks of conduct: cost, seeds, state, and the shape of the answer."""

from __future__ import annotations

import math
import pickle
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import FrozenInstanceError, fields, is_dataclass

import numpy as np

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import (
    NO_ANSWER,
    STATUSES,
    TARGET_COV,
    ReliabilityResult,
    reliability_index,
)
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criteria, Criterion, criteria
from uqfold.testing.counting import RowCount
from uqfold.testing.curved import CurvedSystem
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.verdict import Settings, demand, shown
from uqfold.typing import FloatArray

SMALL_BUDGET = 4_000


class CountingModel:
    """A model that counts its rows and calls, and spoils the array it was given."""

    def __init__(self, system: LinearNormalSystem) -> None:
        self.system = system
        self._count = RowCount()

    @property
    def rows(self) -> int:
        """Rows so far, without those that only show how the model is called."""
        return self._count.rows

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of X (n, d)."""
        self._count.add(x)
        y = self.system.response(x)
        x[:] = 1e9
        return y


def grid(settings: Settings) -> Criteria:
    """A small grid with everything in it, or one criterion without and one with tau."""
    few = Criteria([Criterion(12.5), Criterion(11.0, tau=2.0, missions=Binomial(3, 0.6))])
    every = criteria(threshold=[11.0, 12.5], tau=[None, 2.0], missions=[1, Binomial(3, 0.6)])
    return settings.choose(quick=few, full=every)


def same_numbers(
    first: ReliabilityResult, second: ReliabilityResult, apart: Sequence[str] = ("seconds",)
) -> bool:
    """Whether two results agree bit for bit in every number, those `apart` excepted."""
    for a, b in zip(first.rows, second.rows, strict=True):
        for field in fields(a):
            if field.name in apart:
                continue
            left, right = getattr(a, field.name), getattr(b, field.name)
            both_nan = left != left and right != right  # noqa: PLR0124 - NaN differs from itself
            if left != right and not both_nan:
                return False
    return True


def counted(system: LinearNormalSystem) -> tuple[Problem, CountingModel]:
    """Return the system's problem around a counting model."""
    model = CountingModel(system)
    plain = system.problem()
    problem = Problem(
        model,
        shared=plain.inputs.marginals[0],
        individual=plain.inputs.marginals[1:],
        names=plain.inputs.names,
        units=system.units,
        low_fidelity=plain.low_fidelity,
        name="counted",
    )
    return problem, model


def check_is_a_frozen_record_of_settings(method: ReliabilityMethod, _: Settings) -> None:
    """A method is a frozen dataclass, equal to another with the same settings."""
    demand(is_dataclass(method), f"{type(method).__name__} is not a dataclass")
    settings = {f.name: getattr(method, f.name) for f in fields(method)}
    demand(type(method)(**settings) == method, "two methods with the same settings differ")
    try:
        method.name = "other"  # type: ignore[misc]
    except FrozenInstanceError:
        pass
    else:
        demand(False, "the method is not frozen: its attributes can be set")
    demand(bool(method.name), "the method has no name")


def check_rows_are_well_formed(method: ReliabilityMethod, settings: Settings) -> None:
    """One row per criterion, in order, with numbers that belong together."""
    asked = grid(settings)
    result = method.estimate(LinearNormalSystem().problem(), asked, max_evals=SMALL_BUDGET, rng=1)
    demand(result.criteria == tuple(asked), "the criteria came back changed or out of order")
    demand(bool(any(math.isfinite(row.pf) for row in result)), "not a single criterion is answered")
    for criterion, row in zip(asked, result, strict=True):
        where = shown(method, criterion, row) + ": "
        demand(row.status in STATUSES, where + f"status {row.status!r} is not one of {STATUSES}")
        demand(row.method == method.name, where + f"row names the method {row.method!r}")
        if row.status in NO_ANSWER:
            demand(math.isnan(row.pf), where + f"status {row.status} with pf = {row.pf}")
            demand(bool(row.message), where + f"status {row.status} without a message")
            continue
        demand(0.0 <= row.pf <= 1.0, where + f"pf = {row.pf}")
        total = row.pf + row.reliability
        demand(abs(total - 1.0) < 1e-9, where + f"pf + reliability = {total}")
        beta = reliability_index(row.pf, row.reliability)
        demand(row.beta == beta, where + f"beta = {row.beta}, expected {beta}")
        demand(row.pf_low <= row.pf <= row.pf_high, where + "pf outside [pf_low, pf_high]")
        if math.isfinite(row.ci_low) or math.isfinite(row.ci_high):
            demand(row.ci_low <= row.pf <= row.ci_high, where + "pf outside its interval")
            demand(bool(row.ci_kind), where + "an interval without saying of what kind")
        states = math.isfinite(row.std_error) or math.isfinite(row.ci_low + row.ci_high)
        demand(
            states or row.status != "converged",
            where + 'status "converged" without a standard error and without an interval',
        )
        target = TARGET_COV if method.target_cov is None else method.target_cov
        demand(
            row.status != "converged" or not row.std_error > target * row.pf,
            where + f'status "converged" with std_error = {row.std_error}, pf = {row.pf}',
        )
        if row.error_kind == "none":
            demand(math.isnan(row.std_error), where + 'error_kind "none" with a standard error')


def check_evaluations_are_counted_per_sample(method: ReliabilityMethod, settings: Settings) -> None:
    """`n_evals` equals the rows that the model has seen, see `RowCount`."""
    problem, model = counted(LinearNormalSystem())
    result = method.estimate(problem, grid(settings), max_evals=SMALL_BUDGET, rng=2)
    demand(model.rows > 0, "the model was never run")
    demand(
        result.n_evals == model.rows,
        f"{method.name} reports {result.n_evals} evaluations, the model has seen {model.rows} rows",
    )


def check_budget_is_kept(method: ReliabilityMethod, settings: Settings) -> None:
    """No run beyond `max_evals`, however small it is, and a status that says so."""
    for budget in settings.choose(quick=(1, 40), full=(1, 7, 40, 200, 1_500)):
        problem, model = counted(LinearNormalSystem())
        result = method.estimate(problem, grid(settings), max_evals=budget, rng=3)
        demand(
            model.rows <= budget,
            f"{method.name} ran the model {model.rows} times with max_evals = {budget}",
        )
        for criterion, row in zip(result.criteria, result, strict=True):
            where = shown(method, criterion, row)
            demand(row.status in STATUSES, f"{where} at max_evals = {budget}")
            # a budget too small for anything must not look like an answer without runs
            demand(budget > 1 or row.status != "converged", f"{where} with one run")


def check_same_seed_same_answer(method: ReliabilityMethod, settings: Settings) -> None:
    """The same seed gives the same numbers, also after other problems, and in any order."""
    system, other = LinearNormalSystem(), LinearNormalSystem(units=5, mean=9.0, shared_std=0.8)
    fresh = type(method)(**{f.name: getattr(method, f.name) for f in fields(method)})
    first = fresh.estimate(system.problem(), grid(settings), max_evals=SMALL_BUDGET, rng=4)
    method.estimate(other.problem(), grid(settings), max_evals=SMALL_BUDGET, rng=99)
    np.random.default_rng().standard_normal(3)
    again = method.estimate(system.problem(), grid(settings), max_evals=SMALL_BUDGET, rng=4)
    demand(
        same_numbers(first, again),
        f"{method.name} gives another answer with the same seed, or keeps state from one run to "
        "the next",
    )


def check_other_seed_other_answer(method: ReliabilityMethod, settings: Settings) -> None:
    """A stochastic method uses its seed; a deterministic one does not depend on it.

    Judged on the curved system: on the linear one a method may be exact whatever its seed is, and
    its answers then differ by rounding, or not even by that.
    """
    # of one unit: an integral over shared inputs takes most of the time, and knows no seed
    problem = CurvedSystem(units=1).problem()
    thresholds = settings.choose(quick=[11.0], full=[11.0, 12.5])
    first, second = (
        method.estimate(problem, criteria(thresholds), max_evals=SMALL_BUDGET, rng=seed)
        for seed in (5, 6)
    )
    pairs = [
        (one.pf, other.pf)
        for one, other in zip(first, second, strict=True)
        if one.status not in NO_ANSWER and other.status not in NO_ANSWER
    ]
    demand(
        bool(pairs),
        f"{method.name} answers no criterion of the curved system with both of two seeds, so that "
        "what the seed does cannot be judged",
    )
    if method.stochastic:
        differ = any(one != other for one, other in pairs)
        demand(differ, f"{method.name} gives the same answer with another seed")
    else:
        same = same_numbers(first, second, apart=("seconds", "seed"))
        demand(same, f"{method.name} depends on the seed but does not call itself stochastic")


def check_same_answer_in_a_fresh_process(method: ReliabilityMethod, settings: Settings) -> None:
    """A new interpreter on the same processor, with other string hashing, gives the same bits."""
    same_in_a_fresh_process([method], settings)


def same_in_a_fresh_process(methods: Sequence[ReliabilityMethod], settings: Settings) -> None:
    """Let several methods answer in one new interpreter: a start takes longer than most answers."""
    kinds = [(type(one), {f.name: getattr(one, f.name) for f in fields(one)}) for one in methods]
    code = (
        "import pickle\n"
        "from uqfold.testing.conduct import exact_answer\n"
        f"kinds, settings = pickle.loads({pickle.dumps((kinds, settings))!r})\n"
        "for kind, own in kinds:\n"
        "    print(exact_answer(kind(**own), settings))\n"
    )
    done = subprocess.run(
        [sys.executable, "-R", "-c", code], capture_output=True, text=True, check=False
    )
    names = ", ".join(one.name for one in methods)
    demand(done.returncode == 0, f"{names}: failure in a fresh process: {done.stderr[-500:]}")
    for one, there in zip(methods, done.stdout.splitlines(), strict=True):
        here = exact_answer(one, settings)
        demand(there == here, f"{one.name} gives {there} in a fresh process, {here} here")


def exact_answer(method: ReliabilityMethod, settings: Settings) -> str:
    """Return every bit of the failure probabilities with one seed, as text."""
    problem = LinearNormalSystem().problem()
    answer = method.estimate(problem, grid(settings), max_evals=SMALL_BUDGET, rng=7)
    return str([float(value).hex() for value in answer.pf])


def check_problem_is_left_alone(method: ReliabilityMethod, settings: Settings) -> None:
    """The problem's inputs are the same after a run, and so is NumPy's global generator."""
    problem = LinearNormalSystem().problem()
    probe = np.linspace(-2.0, 2.0, 9).reshape(3, 3)
    before = problem.inputs.from_standard_normal(probe)
    state = _global_state()
    method.estimate(problem, grid(settings), max_evals=SMALL_BUDGET, rng=8)
    after = problem.inputs.from_standard_normal(probe)
    demand(bool(np.array_equal(before, after)), f"{method.name} changed the problem's inputs")
    demand(state == _global_state(), f"{method.name} moved NumPy's global random generator")


def _global_state() -> str:
    state: object = np.random.get_state(legacy=True)  # noqa: NPY002 - it is what is watched
    with np.printoptions(threshold=10_000):
        return repr(state)
