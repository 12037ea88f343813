"""A problem with exact references, and methods that answer as told."""

import math
import time
from dataclasses import dataclass, field
from functools import cache
from typing import ClassVar

import numpy as np
import pandas as pd

from uqfold.comparison import run_comparison
from uqfold.methods import Estimate, ReliabilityMethod, Solution, Task
from uqfold.methods.theory import Equation, Theory
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criteria, Criterion, criteria
from uqfold.problems.reference import Reference, ReferenceTable
from uqfold.testing import LinearNormalSystem
from uqfold.testing.counting import RowCount

SYSTEM = LinearNormalSystem()
THRESHOLDS = (11.0, 12.0, 13.0)
GRID = criteria(THRESHOLDS, tau=[None, 3.0], missions=[1, Binomial(3, 0.7)])
RELATIVE_STD_ERROR = 0.01


@dataclass
class CountingModel:
    """The response of the linear-normal system, counting its rows."""

    seen: list[int] = field(default_factory=list)
    count: RowCount = field(default_factory=RowCount)

    @property
    def rows(self) -> int:
        return self.count.rows

    def __call__(self, x: np.ndarray) -> np.ndarray:
        if self.count.add(x):
            self.seen.append(len(x))
        return SYSTEM.response(x)


def toy_problem(grid: Criteria = GRID, *, referenced: bool = True) -> Problem:
    """Give the linear-normal system with its exact answers as references."""
    entries = {one: reference(one) for one in grid} if referenced else {}
    table = ReferenceTable("toy", "integration", "Quadrature.", "python toy.py", entries)
    base = SYSTEM.problem()
    return Problem(
        CountingModel(),
        inputs=base.inputs.distribution,
        names=base.inputs.names,
        shared=base.inputs.shared_names,
        units=SYSTEM.units,
        name="toy",
        response="deflection",
        response_unit="mm",
        default_criteria=grid,
        references=table if referenced else None,
    )


@cache
def truth(criterion: Criterion) -> float:
    """Give the exact failure probability; it takes a while with tau."""
    return SYSTEM.pf(criterion)


def reference(criterion: Criterion) -> Reference:
    """Give the exact answer, with a made-up standard error of 1 %."""
    pf = truth(criterion)
    return Reference(criterion, pf, RELATIVE_STD_ERROR * pf)


@dataclass(frozen=True)
class Told(ReliabilityMethod):
    """Spends `n` runs and answers (1 + bias) times the truth, or nothing with tau."""

    name: ClassVar[str] = "told"
    title: ClassVar[str] = "answers as told"
    theory: ClassVar[Theory] = Theory(
        "Knows the answer, and errs as told.",
        (Equation("The failure probability is", r"p_f = \mathrm{told}", "Eq. (1)"),),
        ("Somebody. How to answer as told. 2020.",),
    )

    n: int = 100
    bias: float = 0.0
    synchronized: bool = True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        if criterion.tau is not None and not self.synchronized:
            return "told not to answer tau"
        return super().supports(problem, criterion)

    def _solve(self, task: Task) -> Solution:
        task.session.expect(self.n)
        task.session.evaluate(task.problem.inputs.sample(task.generator(), self.n))
        return Solution([Estimate((1.0 + self.bias) * truth(one)) for one in task.criteria])


@dataclass(frozen=True)
class Quick(ReliabilityMethod):
    """Answers at once, whatever the problem."""

    name: ClassVar[str] = "quick"

    def _solve(self, task: Task) -> Solution:
        return Solution([Estimate(0.25) for _ in task.criteria])


@dataclass(frozen=True)
class Sampled(ReliabilityMethod):
    """Has an interval, and says `doubtful` where it saw no failure."""

    name: ClassVar[str] = "sampled"
    stochastic: ClassVar[bool] = True

    n: int = 1000

    def _solve(self, task: Task) -> Solution:
        task.session.evaluate(task.problem.inputs.sample(task.generator(), self.n))
        failures = [
            int(task.generator(i + 1).binomial(self.n, truth(one)))
            for i, one in enumerate(task.criteria)
        ]
        return Solution([self._estimate(k) for k in failures])

    def _estimate(self, k: int) -> Estimate:
        pf = k / self.n
        error = math.sqrt(pf * (1.0 - pf) / self.n)
        return Estimate(
            pf,
            std_error=error if k else math.nan,
            ci_low=max(pf - 2.0 * error, 0.0),
            ci_high=pf + 2.0 * error if k else 3.7 / self.n,
            ci_kind="normal 95 %",
            error_kind="sampling",
            status="converged" if k else "doubtful",
            message="" if k else f"no failures among {self.n}",
        )


@dataclass(frozen=True)
class Broken(ReliabilityMethod):
    """Always raises."""

    name: ClassVar[str] = "broken"

    def _solve(self, task: Task) -> Solution:
        raise ArithmeticError("a pole [at zero]")


@dataclass(frozen=True)
class Endless(ReliabilityMethod):
    """Runs for a minute, to be interrupted; swallows the interruption if told so."""

    name: ClassVar[str] = "endless"

    swallows: bool = False

    def _solve(self, task: Task) -> Solution:
        try:
            self._wait()
        except KeyboardInterrupt:
            if not self.swallows:
                raise
        return Solution([Estimate(0.5) for _ in task.criteria])

    def _wait(self) -> None:
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            time.sleep(0.01)


@dataclass(frozen=True)
class Swallowing(Endless):
    """Runs for a minute and hides that it was interrupted."""

    name: ClassVar[str] = "swallowing"

    swallows: bool = True


METHODS = {
    "exact": Told(),
    "biased": Told(n=250, bias=0.2, synchronized=False),
    "sampled": Sampled(),
    "broken": Broken(),
}


def toy_frame(
    grid: Criteria = GRID,
    methods: dict[str, ReliabilityMethod] | None = None,
    *,
    referenced: bool = True,
    command: str = "uqfold compare toy",
) -> pd.DataFrame:
    """Return a finished comparison of the fakes."""
    problem = toy_problem(grid, referenced=referenced)
    asked = METHODS if methods is None else methods
    *_, frame = run_comparison(problem, asked, max_evals=5000, command=command)
    return frame
