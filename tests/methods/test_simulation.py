"""What all simulation methods have in common: infinite responses, large systems, many criteria."""

import math
from typing import Any

import numpy as np
import openturns as ot
import pytest

from uqfold.evaluation import Evaluator
from uqfold.methods import (
    ConditionalMonteCarlo,
    FFNIPearson,
    FFNISaddlepoint,
    Kriging,
    MonteCarlo,
    OpenTURNSMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
    conditional_monte_carlo,
    openturns_monte_carlo,
)
from uqfold.methods import system_sample as sample
from uqfold.methods.system_sample import draw_systems
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.system.event import Worst, mission_fails
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray

SYSTEM = LinearNormalSystem(units=3, shared_std=0.7)
METHODS = [
    MonteCarlo(systems=6_000),
    ConditionalMonteCarlo(blocks=40),
    OpenTURNSMonteCarlo(target_cov=0.03, max_samples=8_000),
]
each_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)


@each_method
@pytest.mark.parametrize(
    ("tau", "works"),
    [
        (None, lambda low, high, units: (1.0 - high) ** units),
        # under tau whatever is infinite fails, in a single unit and with tau = inf too
        (0.5, lambda low, high, units: (1.0 - low - high) ** units),
        (math.inf, lambda low, high, units: (1.0 - low - high) ** units),
    ],
)
@pytest.mark.parametrize("units", [1, 2])
def test_infinite_responses_fail_as_the_conventions_say(
    method: ReliabilityMethod, tau: float | None, works, units: int
) -> None:
    """-inf responses under tau: all methods follow the one definition."""
    low, high = 0.1, 0.15

    def response(x: FloatArray) -> FloatArray:
        y = np.where(x[:, 1] < low, -np.inf, 0.0)
        return np.where(x[:, 1] > 1.0 - high, np.inf, y)

    uniform = ot.Uniform(0.0, 1.0)
    problem = Problem(response, shared={"v": uniform}, individual={"u": uniform}, units=units)
    row = method.estimate(problem, criteria([0.0], tau=tau), rng=1)[0]
    assert abs(row.pf - (1.0 - works(low, high, units))) < 4.0 * row.std_error
    assert row.status in {"converged", "budget_exhausted"}


@pytest.mark.parametrize(
    "method",
    [MonteCarlo(), ConditionalMonteCarlo(), OpenTURNSMonteCarlo()],
    ids=lambda method: method.name,
)
def test_a_million_missions_are_refused_beforehand_and_spoil_no_other(
    method: ReliabilityMethod,
) -> None:
    """They died for want of memory; what does not draw them answers."""
    asked = [Criterion(14.0, missions=1_000_000), Criterion(11.0)]
    large, usual = method.estimate(SYSTEM.problem(), asked, max_evals=3_000, rng=1)
    assert large.status == "unsupported"
    assert "9,000,000 random numbers for one system" in large.message
    assert "ffni-pearson" in large.message
    assert math.isfinite(usual.pf)
    assert math.isfinite(FFNIPearson().estimate(SYSTEM.problem(), asked[0])[0].pf)


@pytest.mark.parametrize(
    "method",
    [
        *METHODS, FFNIPearson(), FFNISaddlepoint(), PolynomialChaos(runs=30, max_degree=2),
        pytest.param(Kriging(runs=30), marks=pytest.mark.thorough),
    ],
    ids=lambda method: method.name,
)  # fmt: skip
def test_a_row_is_the_same_alone_and_among_others(method: ReliabilityMethod) -> None:
    """Thresholds and tau beside it change neither number nor verdict of a row."""
    problem = SYSTEM.problem()
    among = [Criterion(9.0), Criterion(12.0), Criterion(12.0, tau=2.0), Criterion(15.0)]
    together = method.estimate(problem, among, rng=1)
    # a fit of a surface takes a while: two rows of it will do
    checked = slice(1, 3) if method.name in {"kriging", "pce"} else slice(None)
    for criterion, row in zip(among[checked], together.rows[checked], strict=True):
        alone = method.estimate(problem, criterion, rng=1)[0]
        assert (alone.status, alone.message) == (row.status, row.message)
        assert alone.pf == pytest.approx(row.pf, rel=1e-6, nan_ok=True)
        assert alone.std_error == pytest.approx(row.std_error, rel=1e-4, nan_ok=True)


@each_method
def test_large_systems_take_bounded_memory(
    method: ReliabilityMethod, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Blocks of large systems are short, and fit: no block draws more than it may."""
    drawn = []
    problem = SYSTEM.problem()
    evaluate = type(problem.inputs).from_standard_normal

    def watched(self, u):
        drawn.append(u.size)
        return evaluate(self, u)

    monkeypatch.setattr(type(problem.inputs), "from_standard_normal", watched)
    monkeypatch.setattr(sample, "BLOCK_VALUES", 30_000)
    monkeypatch.setattr(conditional_monte_carlo, "BLOCK_VALUES", 30_000)
    monkeypatch.setattr(openturns_monte_carlo, "BLOCK_VALUES", 30_000)
    row = method.estimate(problem, Criterion(13.0, missions=20), max_evals=60_000, rng=1)[0]
    assert abs(row.pf - SYSTEM.pf(Criterion(13.0, missions=20))) < 5.0 * row.std_error
    assert max(drawn) <= 30_000


def test_the_worst_of_each_system_counts_what_each_criterion_counts() -> None:
    """Failures of many criteria, read off at once, against one decision after the other."""
    thresholds = [-math.inf, *np.linspace(8.0, 14.0, 30), math.inf]
    asked = criteria(thresholds, tau=[None, 0.0, 1.5, math.inf], missions=[1, 3, Binomial(4, 0.5)])
    block = draw_systems(SYSTEM.problem(), asked, np.random.default_rng(1), 400)
    y = SYSTEM.response(block.x)
    kind = np.random.default_rng(2).random(y.size)
    y = np.where(kind < 0.02, np.nan, np.where(kind < 0.04, np.inf, y))
    y = np.where(kind > 0.98, -np.inf, np.round(y, 1))
    size, high, low = block.counts(y)
    assert size == 400
    full = np.zeros((*block.rows.shape, SYSTEM.units))
    full[block.rows] = y.reshape(-1, SYSTEM.units)
    mission = np.arange(block.rows.shape[1])
    for i, one in enumerate(asked):
        flies = mission < block.flown[one.missions][:, None]
        for counted, missing_fails in ((high, True), (low, False)):
            fails = mission_fails(full, one.threshold, one.tau, missing_fails=missing_fails)
            assert counted[i] == np.count_nonzero((fails & flies).any(axis=1))


@pytest.mark.parametrize(
    "method",
    [MonteCarlo(systems=4_096), ConditionalMonteCarlo(blocks=32)],
    ids=lambda method: method.name,
)
def test_many_criteria_look_at_the_responses_once(
    method: ReliabilityMethod, monkeypatch: pytest.MonkeyPatch
) -> None:
    """10,000 criteria: `mc` sought the largest and smallest responses anew for each of them."""
    calls = []
    plain = Worst.of_missions.__func__  # type: ignore[attr-defined]

    def counted(cls: type[Worst], y: FloatArray, **settings: Any) -> Worst:
        calls.append(y.size)
        return plain(cls, y, **settings)  # type: ignore[no-any-return]

    monkeypatch.setattr(Worst, "of_missions", classmethod(counted))
    looks = []
    for thresholds in (2, 300):
        calls.clear()
        asked = criteria(np.linspace(8.0, 14.0, thresholds), tau=[None, 2.0], missions=[1, 2])
        method.estimate(SYSTEM.problem(), asked, rng=1)
        looks.append(sum(calls))
    assert looks[0] == looks[1] > 0


@each_method
def test_a_time_limit_holds_while_systems_are_drawn_and_judged(method: ReliabilityMethod) -> None:
    asked = criteria([11.0, 13.0], missions=[2, Binomial(10, 0.5)])
    endless = {
        "mc": MonteCarlo(systems=10**9),
        "conditional-mc": ConditionalMonteCarlo(blocks=10**9),
        "openturns-mc": OpenTURNSMonteCarlo(target_cov=1e-6),
    }[method.name]
    result = endless.estimate(
        SYSTEM.problem(), asked, max_evals=10**12, rng=1, evaluator=Evaluator(max_seconds=0.3)
    )
    assert all("wall-clock limit" in row.message for row in result)
    assert result.n_evals < 10**9
