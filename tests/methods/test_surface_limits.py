"""Response surfaces at the limits: tiny tau, many criteria and units, time, settings that lie."""

import math
from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import ArrayLike

from uqfold.evaluation import Evaluator
from uqfold.inputs import normal
from uqfold.methods import ActiveKriging, Kriging, PolynomialChaos, ReliabilityMethod
from uqfold.methods.active_question import MOST_LEARNED
from uqfold.methods.active_view import View
from uqfold.methods.few_taus import MOST_TAUS, by_few_taus
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.surrogates import polynomial_chaos
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import FloatArray, IntArray

SYSTEM = LinearNormalSystem()
SMALL = [
    Kriging(runs=16, trend="linear", kernel="gaussian"),
    PolynomialChaos(runs=16),
    ActiveKriging(runs=14, kernel="gaussian"),
]


def named(method: ReliabilityMethod) -> str:
    return method.name


@pytest.mark.parametrize("method", SMALL, ids=named)
def test_tiny_tau_and_none_at_all(method: ReliabilityMethod) -> None:
    """tau of 1e-12 or 0: 15 GB and no end before; now the asymptote n tau^(n-1) int h^n."""
    asked = criteria(20.0, tau=[1e-12, 0.0])
    tiny, zero = method.estimate(SYSTEM.problem(), asked, rng=1)
    assert (zero.pf, zero.reliability) == (1.0, 0.0)
    assert tiny.pf == 1.0
    # three units, whose responses have the standard deviation 1 given the shared input
    expected = 3e-24 / (2.0 * math.pi * math.sqrt(3.0))
    assert tiny.reliability == pytest.approx(expected, rel=1e-3)


def test_tau_zero_always_holds_where_only_shared_inputs_count() -> None:
    """All units respond alike then: tau = 0 asks for nothing."""
    problem = Problem(lambda x: x[:, 0], shared=normal(0.0, 1.0), units=3)
    for method in SMALL[:2]:
        plain, zero = method.estimate(problem, criteria(1.0, tau=[None, 0.0]), rng=1)
        assert zero.pf == plain.pf == pytest.approx(0.158655, rel=1e-3)


@pytest.mark.thorough
def test_tau_below_the_error_of_the_surface_is_doubted() -> None:
    """Units that respond to the shared input alone are equal; a fit sees differences in them."""

    def model(x: FloatArray) -> FloatArray:
        return np.exp(0.8 * x[:, 0]) + 0.0 * x[:, 1]

    problem = Problem(model, shared=normal(0.0, 1.0), individual=normal(0.0, 1.0), units=3)
    asked = criteria(2.0, tau=[0.0, 1e-9, 1.0])
    method = Kriging(runs=12, trend="linear", kernel="gaussian")
    for row in method.estimate(problem, asked, rng=1):
        assert ("below what the surface can tell" in row.message) == (row.tau < 1.0)
        assert row.tau == 1.0 or row.status == "doubtful"


@pytest.mark.parametrize(
    ("method", "units"),
    [
        pytest.param(PolynomialChaos(runs=16), 100_000, marks=pytest.mark.thorough, id="pce"),
        pytest.param(
            ActiveKriging(runs=14, kernel="gaussian"), 100, marks=pytest.mark.thorough,
            id="active-kriging",
        ),
    ],
)  # fmt: skip
def test_the_number_of_criteria_and_units_costs_next_to_nothing(
    method: ReliabilityMethod, units: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """900 criteria and 1e5 units: distributions are asked for all thresholds at once."""
    calls = []
    plain = TabulatedDistribution.tails

    def counted(self: TabulatedDistribution, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        calls.append(np.size(y))
        return plain(self, y)

    monkeypatch.setattr(TabulatedDistribution, "tails", counted)
    many = criteria(np.linspace(9.0, 13.0, 450), missions=[1, Binomial(10, 0.7)])
    result = method.estimate(LinearNormalSystem(units=units).problem(), many, rng=1)
    # so many units need many shared nodes wherever some criterion lies in between: 11,000 calls
    assert 0 < len(calls) < 15_000
    exact = LinearNormalSystem(units=units).pf(many[449])
    assert result[449].pf == pytest.approx(exact, rel=0.05)


def test_many_criteria_are_learned_from_some(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = []
    plain = View.of.__func__  # type: ignore[attr-defined]

    def seen(cls: type[View], *given: object) -> View:
        view = plain(cls, *given)
        sizes.append(view.beta_std.size)
        assert view.question.for_all(view.beta_std).shape == (900,)
        return view  # type: ignore[no-any-return]

    monkeypatch.setattr(View, "of", classmethod(seen))
    asked = criteria(np.linspace(10.0, 13.0, 450), missions=[1, 3])
    result = ActiveKriging(runs=13, kernel="gaussian").estimate(SYSTEM.problem(), asked, rng=1)
    assert set(sizes) == {MOST_LEARNED}
    for row, criterion in zip(result, asked, strict=True):
        assert abs(row.pf - SYSTEM.pf(criterion)) < max(5 * row.std_error, 1e-3 * row.pf)


@pytest.mark.parametrize("method", [Kriging, ActiveKriging])
def test_a_noise_that_contradicts_the_fit_is_doubted(
    method: type[Kriging | ActiveKriging],
) -> None:
    """Kriging(noise=5) was `converged` at 0.57, however little the responses scatter."""
    rng = np.random.default_rng(1)

    def model(x: FloatArray) -> FloatArray:
        # what the model does at the smallest scale
        return SYSTEM.response(x) + 0.1 * rng.standard_normal(len(x))

    inputs = SYSTEM.problem().inputs
    problem = Problem(model, inputs=inputs.distribution, names=inputs.names, units=1)
    wrong, right = (
        method(runs=24, noise=noise, kernel="gaussian").estimate(problem, Criterion(10.6), rng=1)[0]
        for noise in (5.0, 0.1)
    )
    assert wrong.status == "doubtful"
    assert "noise = 5 contradicts the fit" in wrong.message
    assert "contradicts" not in right.message


@pytest.mark.parametrize("method", [Kriging(runs=16), ActiveKriging(runs=60)], ids=named)
def test_what_was_fitted_in_time_is_an_answer(
    method: ReliabilityMethod, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every time limit holds while surfaces are fitted, and the first of them answers."""
    looks, fitted = [0], [0]

    def now() -> float:
        # time stands still until the first surface is there; then a look takes a second
        looks[0] += fitted[0] > 0
        return float(looks[0])

    plain = GaussianProcess.leave_one_out

    def leave_one_out(self: GaussianProcess) -> object:
        fitted[0] += 1
        return plain(self)

    monkeypatch.setattr("uqfold.evaluation.deadline.time", SimpleNamespace(monotonic=now))
    monkeypatch.setattr("uqfold.evaluation.deadline.GRACE_SECONDS", 1e6)
    monkeypatch.setattr(GaussianProcess, "leave_one_out", leave_one_out)
    evaluator = Evaluator(max_seconds=150.0 if method.name == "active-kriging" else 10.0)
    row = method.estimate(SYSTEM.problem(), Criterion(11.0), rng=1, evaluator=evaluator)[0]
    assert row.status == "budget_exhausted"
    assert "max_seconds" in row.message
    assert abs(row.pf - SYSTEM.pf(Criterion(11.0))) < max(5 * row.std_error, 1e-6)


def test_expansions_in_many_inputs_draw_from_few_of_the_next_degree(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """pce on 200 inputs: the polynomials left out were all listed, a million of them."""
    listed = []
    plain = polynomial_chaos._multinomial

    def counted(indices: IntArray, influence: FloatArray) -> FloatArray:
        listed.append(indices.shape[0])
        return plain(indices, influence)

    monkeypatch.setattr(polynomial_chaos, "_multinomial", counted)
    monkeypatch.setattr(polynomial_chaos, "_MOST_OMITTED", 300)
    u = space_filling_design(130, 40, np.random.default_rng(0))
    y = u[:, 0] + 0.03 * u[:, 7] ** 2 + 0.1 * u[:, 3]
    surface = fit_polynomial_chaos(u, y, sparse=False, max_degree=1)
    paths = surface.sample_paths(np.random.default_rng(1), 3)
    assert surface.degree == 1
    assert paths.omitted.shape[1] == 40
    assert paths.omitted.shape[0] <= 200
    assert paths(u[:5]).shape == (3, 5)
    # of 820 polynomials of degree 2
    assert 200 < listed[0] <= 300


@pytest.mark.parametrize("unit", [1e-310, 1e-200, 1e-150, 1e160, 1e300])
@pytest.mark.parametrize(
    "method",
    [Kriging(runs=30), PolynomialChaos(runs=30), ActiveKriging(runs=30)],
    ids=lambda method: method.name,
)
def test_responses_that_cannot_be_squared_are_refused(
    method: ReliabilityMethod, unit: float
) -> None:
    """A fit whose sums of squares are 0 or inf is no fit: it said pf = 0 for sure."""
    system = LinearNormalSystem(mean=0.0)
    plain = system.problem()
    problem = Problem(
        lambda x: system.response(x) * unit,
        inputs=plain.inputs.distribution,
        names=plain.inputs.names,
        shared=plain.inputs.shared_names,
        units=plain.n_units,
    )
    asked = criteria([2.0 * unit], tau=[None, 2.0 * unit])
    for row in method.estimate(problem, asked, rng=1):
        assert row.status == "failed"
        assert "state them in another unit" in row.message


def test_errors_of_many_taus_are_those_of_a_few() -> None:
    """1,000 criteria with tau took 20 s: every tau had the integrals of thirty surfaces."""
    asked = []

    def errors(some: Sequence[Criterion]) -> FloatArray:
        asked.append(len({one.tau for one in some}))
        return np.array([[one.threshold / (one.tau or math.inf) for one in some]])

    few = criteria([1.0, 2.0], tau=[None, 1.0, 2.0])
    assert_array_equal(by_few_taus(few, errors), errors(few))
    many = criteria([1.0, 2.0], tau=[None, *np.linspace(1.0, 5.0, 41)])
    found = by_few_taus(many, errors)
    assert asked[-1] <= MOST_TAUS + 1
    exact = errors(many)
    assert (found >= exact).all()
    assert (found <= 2.0 * exact).all()
