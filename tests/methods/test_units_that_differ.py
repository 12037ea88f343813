"""Units with models, inputs and offsets of their own, in any structure, against quadrature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import openturns as ot
import pytest
from scipy.integrate import quad
from scipy.special import log_ndtr, ndtr

from uqfold import (
    Binomial,
    Criterion,
    CutSets,
    Evaluator,
    KOutOfN,
    Parallel,
    Problem,
    Series,
    Structure,
    Unit,
    evaluation,
)
from uqfold.analysis import conditional_sobol, pick_freeze
from uqfold.inputs import normal
from uqfold.inputs.assembly import normal_copula
from uqfold.methods import (
    FFNI,
    ActiveKriging,
    ConditionalMonteCarlo,
    DimensionReduction,
    FFNIPearson,
    FFNISaddlepoint,
    FullFactorial,
    GaussOuter,
    Kriging,
    MonteCarlo,
    OpenTURNSFORM,
    OpenTURNSMonteCarlo,
    PolynomialChaos,
    ReliabilityMethod,
    SubsetSimulation,
    available,
    build,
)
from uqfold.methods.factorial_design import FFNIDetails
from uqfold.methods.kriging import KrigingDetails
from uqfold.problems.structure import SystemStructure
from uqfold.system.structure import SystemUnits
from uqfold.testing.linear_normal import works_as
from uqfold.testing.linear_units import OFFSETS, STRUCTURES, LinearUnits
from uqfold.typing import FloatArray

INPUTS = {"shared": {"V": normal(0, 1)}, "individual": {"U": normal(0, 1)}}


def pump(x: FloatArray) -> FloatArray:
    return 0.6 * x[:, 0] + 0.8 * x[:, 1]


def valve(x: FloatArray) -> FloatArray:
    """A model with two inputs of its own, W and Z."""
    return 0.4 * x[:, 0] + 0.5 * x[:, 1] - 0.5 * x[:, 2]


VALVE = Unit(valve, [normal(0.2, 1), normal(0, 0.5)], name="valve")
PUMPS = [Unit(name="pump_a"), Unit(offset=-0.3, name="pump_b")]
SYSTEM = Structure("pump_a & pump_b | valve")


def failing(unit: Unit, threshold: float, v: float) -> float:
    if unit.model is valve:
        return float(ndtr((0.1 + 0.4 * v + unit.offset - threshold) / math.hypot(0.5, 0.25)))
    return float(ndtr((0.6 * v + unit.offset - threshold) / 0.8))


def exact(units: Sequence[Unit], structure: SystemStructure, criterion: Criterion) -> float:
    """Sum over the states of the units, and one integral over the common cause."""
    names = [unit.name or f"u{i}" for i, unit in enumerate(units)]
    renamed = structure
    if isinstance(structure, Structure):
        text = structure.expression
        for i, name in enumerate(names):
            text = text.replace(name, f"u{i}")
        renamed = Structure(text)
    states = list(product((False, True), repeat=len(units)))
    broken = np.array([works for works in states if not works_as(renamed, works)])
    missions = criterion.missions
    number = missions.planned if isinstance(missions, Binomial) else missions
    flown = missions.p if isinstance(missions, Binomial) else 1.0

    def integrand(v: float) -> float:
        p = np.array([failing(unit, criterion.threshold, v) for unit in units])
        one = float(np.where(broken, 1.0 - p, p).prod(axis=1).sum())
        failure = -math.expm1(number * math.log1p(-flown * min(one, 1.0 - 1e-16)))
        return failure * math.exp(-0.5 * v * v)

    return quad(integrand, -9, 9, epsabs=0, epsrel=1e-9)[0] / math.sqrt(2 * math.pi)


CRITERIA = [Criterion(0.6), Criterion(1.0, missions=3), Criterion(0.8, missions=Binomial(4, 0.6))]


@pytest.mark.parametrize(
    "method",
    [
        MonteCarlo(systems=20_000),
        ConditionalMonteCarlo(blocks=100, missions_per_draw=4),
        OpenTURNSMonteCarlo(target_cov=0.03, max_samples=20_000),
    ],
    ids=lambda one: one.name,
)
def test_simulation_takes_units_of_any_kind(method: ReliabilityMethod) -> None:
    """`Unit` with a model, inputs and offset of its own was ``unsupported`` everywhere."""
    units = [*PUMPS, VALVE]
    problem = Problem(pump, **INPUTS, units=units, structure=SYSTEM)
    result = method.estimate(problem, CRITERIA, rng=5)
    for criterion, row in zip(CRITERIA, result, strict=True):
        truth = exact(units, SYSTEM, criterion)
        assert abs(row.pf - truth) < 4.5 * row.std_error, (row, truth)
        assert row.std_error < 0.1 * truth


def test_conditional_monte_carlo_states_an_honest_error_for_units_that_differ() -> None:
    """Each unit keeps its own responses when they are put together anew: no bias over 60 seeds."""
    units = [*PUMPS, VALVE]
    problem = Problem(pump, **INPUTS, units=units, structure=KOutOfN(2))
    criterion = Criterion(0.6, missions=2)
    truth, method = exact(units, KOutOfN(2), criterion), ConditionalMonteCarlo(blocks=12)
    rows = [method.estimate(problem, criterion, rng=seed)[0] for seed in range(60)]
    z = np.array([(row.pf - truth) / row.std_error for row in rows])
    assert abs(z.mean()) < 0.65
    assert 0.6 < z.std() < 1.5


def test_tau_compares_units_that_differ() -> None:
    """In series, by simulation: an offset larger than tau alone sets the units apart."""
    units = [Unit(), Unit(offset=50.0)]
    problem = Problem(pump, **INPUTS, units=units)
    asked = [Criterion(100.0, tau=40.0), Criterion(100.0, tau=60.0)]
    for method in (MonteCarlo(systems=100), ConditionalMonteCarlo(blocks=2)):
        assert [row.pf for row in method.estimate(problem, asked, rng=1)] == [1.0, 0.0]


@pytest.mark.parametrize(
    ("method", "tolerance"),
    [
        (PolynomialChaos(runs=25, max_degree=2), 1e-8),
        (Kriging(runs=40, kernel="gaussian", trend="linear"), 1e-5),
        (FFNISaddlepoint(nodes_shared=24), 1e-4),
        (FFNIPearson(nodes_shared=24), 1e-4),
    ],
    ids=lambda one: getattr(one, "name", ""),
)
@pytest.mark.parametrize("structure", [Series(), CutSets([[0, 1], [1, 2]])])
def test_offsets_need_no_surface_of_their_own(
    method: ReliabilityMethod, tolerance: float, structure: SystemStructure
) -> None:
    units = [Unit(), Unit(offset=-0.3), Unit(offset=0.2)]
    problem = Problem(pump, **INPUTS, units=units, structure=structure)
    result = method.estimate(problem, CRITERIA, rng=2)
    for criterion, row in zip(CRITERIA, result, strict=True):
        assert row.status in {"converged", "unchecked"}
        assert row.pf == pytest.approx(exact(units, structure, criterion), rel=tolerance)


def test_offsets_of_units_that_share_everything() -> None:
    """Nothing individual: the structure of the offsets is the offset of the system."""
    units = [Unit(), Unit(offset=0.5), Unit(offset=1.0)]
    problem = Problem(
        lambda x: x[:, 0], shared={"V": normal(0, 1)}, units=units, structure=KOutOfN(2)
    )
    row = PolynomialChaos(runs=10).estimate(problem, Criterion(1.5, missions=7), rng=1)[0]
    assert row.pf == pytest.approx(float(ndtr(-1.0)), rel=1e-6)


@pytest.mark.parametrize(
    ("method", "structure"),
    [
        (PolynomialChaos(runs=50, max_degree=2), SYSTEM),
        (PolynomialChaos(runs=50, max_degree=2), KOutOfN(2)),
        (Kriging(runs=60, kernel="gaussian", trend="linear"), Series()),
    ],
    ids=lambda one: getattr(one, "name", ""),
)
def test_a_surface_for_each_kind_of_units(
    method: ReliabilityMethod, structure: SystemStructure
) -> None:
    """Units with models and inputs of their own, which had to be simulated."""
    units = [*PUMPS, VALVE, Unit(valve, VALVE.individual, 0.1, name="spare")]
    problem = Problem(pump, **INPUTS, units=units, structure=structure)
    result = method.estimate(problem, [*CRITERIA, Criterion(4.0)], rng=2)
    for criterion, row in zip([*CRITERIA, Criterion(4.0)], result, strict=True):
        truth = exact(units, structure, criterion)
        assert row.status == "converged"
        assert abs(row.pf - truth) < 2.0 * row.std_error
        assert row.pf == pytest.approx(truth, rel=3e-4)
        assert row.n_evals <= 60


@pytest.mark.parametrize(
    "method",
    [FFNISaddlepoint(nodes_shared=20), FFNIPearson(nodes_shared=20), FFNI(outer=GaussOuter(20))],
    ids=lambda one: one.name,
)
def test_moments_of_each_kind_at_the_same_shared_nodes(method: ReliabilityMethod) -> None:
    """FFNI lays out a design for each kind, and checks all of them together."""
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM)
    result = method.estimate(problem, CRITERIA)
    for criterion, row in zip(CRITERIA, result, strict=True):
        assert row.pf == pytest.approx(exact([*PUMPS, VALVE], SYSTEM, criterion), rel=1e-6)
        assert row.status == "converged"
    assert 20 * (5 + 25) < result.n_evals < 20 * (5 + 25) + 400
    three = {"outer": GaussOuter(3)} if isinstance(method, FFNI) else {"nodes_shared": 3}
    coarse = replace(method, **three).estimate(problem, Criterion(3.0))[0]
    assert coarse.status == "doubtful"
    assert "over the shared inputs, pf changes by" in coarse.message
    tight = method.estimate(problem, CRITERIA, max_evals=599)
    assert {row.status for row in tight} == {"failed"}
    assert tight.n_evals == 0


@pytest.mark.parametrize("inner", [FullFactorial(), DimensionReduction(2)])
def test_refined_moments_of_several_kinds(inner: FullFactorial | DimensionReduction) -> None:
    """A rule over the polynomials of all kinds is refined until the system's answers stand."""
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM)
    result = FFNI(inner).estimate(problem, CRITERIA)
    for criterion, row in zip(CRITERIA, result, strict=True):
        assert row.pf == pytest.approx(exact([*PUMPS, VALVE], SYSTEM, criterion), rel=1e-3)
        assert row.status == "converged"
    details = result.details
    assert isinstance(details, FFNIDetails)
    assert len(details.of_other_kinds) == 1
    unchecked = FFNI(inner).estimate(problem, Criterion(3.0), max_evals=120)
    assert unchecked[0].status == "unchecked"
    # the check of one kind alone, for which there is room, is not begun
    assert unchecked.n_evals == 3 * (5 + 25) + 2 * 4
    few = FFNI(inner).estimate(problem, CRITERIA, max_evals=50)
    assert {row.status for row in few} == {"failed"}
    assert few.n_evals == 0


def synchronized(
    units: Sequence[Unit], threshold: float, tau: float, missions: int | Binomial = 1
) -> float:
    """Success under tau of pumps and valves in series, whose responses are normal given V."""
    v, s = np.meshgrid(np.linspace(-8.0, 8.0, 161), np.linspace(-9.0, threshold, 1501))
    means, stds = zip(
        *(
            (0.1 + 0.4 * v + unit.offset, math.hypot(0.5, 0.25))
            if unit.model is valve
            else (0.6 * v + unit.offset, 0.8)
            for unit in units
        ),
        strict=True,
    )
    z = [(s - mean) / std for mean, std in zip(means, stds, strict=True)]
    near = [ndtr(a) - ndtr(a - tau / std) for a, std in zip(z, stds, strict=True)]
    first = sum(
        np.exp(-0.5 * a**2) / std * math.prod(near[:i] + near[i + 1 :])
        for i, (a, std) in enumerate(zip(z, stds, strict=True))
    )
    over_s = np.trapezoid(first, s[:, 0], axis=0) / math.sqrt(2.0 * math.pi)
    density = np.exp(-0.5 * v[0] ** 2) / math.sqrt(2.0 * math.pi)
    number, flown = (
        (missions.planned, missions.p) if isinstance(missions, Binomial) else (missions, 1.0)
    )
    return float(np.trapezoid((1.0 - flown + flown * over_s) ** number * density, v[0]))


def test_simulation_of_units_that_differ_under_tau() -> None:
    """Own models, inputs and offsets; tau small and large, missions fixed and binomial."""
    units = [*PUMPS, replace(VALVE, offset=0.2)]
    problem = Problem(pump, **INPUTS, units=units)
    asked = [
        Criterion(2.0, tau=tau, missions=missions)
        for tau in (0.8, 2.0)
        for missions in (1, 3, Binomial(4, 0.3))
    ]
    truth = [1.0 - synchronized(units, c.threshold, c.tau, c.missions) for c in asked]
    for method in (
        MonteCarlo(systems=3_000),
        ConditionalMonteCarlo(blocks=100),
        SubsetSimulation(samples=200),
    ):
        result = method.estimate(problem, asked, rng=3)
        for row, exact_pf in zip(result, truth, strict=True):
            assert row.status == "converged", (method, row)
            assert abs(row.pf - exact_pf) < 4.5 * row.std_error, (method, row, exact_pf)


def test_surfaces_that_differ_under_tau() -> None:
    """The sum over which unit comes first, with the surfaces of two kinds and an offset."""
    units = [PUMPS[1], VALVE]
    problem = Problem(pump, **INPUTS, units=units)
    method = PolynomialChaos(runs=40, max_degree=2)
    row = method.estimate(problem, Criterion(1.5, tau=1.2), rng=2)[0]
    assert row.status == "converged"
    assert row.reliability == pytest.approx(synchronized(units, 1.5, 1.2), rel=1e-4)


def test_kinds_and_offsets_under_tau_by_moments() -> None:
    """FFNI integrates over which unit comes first, too, and checks it."""
    units = [PUMPS[1], VALVE]
    problem = Problem(pump, **INPUTS, units=units)
    row = FFNIPearson(nodes_shared=16).estimate(problem, Criterion(1.5, tau=1.2))[0]
    assert row.status == "converged"
    assert row.reliability == pytest.approx(synchronized(units, 1.5, 1.2), rel=1e-4)


@pytest.mark.parametrize(("bend", "status"), [(0.01, "converged"), (0.3, "doubtful")])
def test_the_error_of_each_surface_is_one_of_the_system(bend: float, status: str) -> None:
    """One kind whose surface few runs leave open widens the interval, and is doubted by name."""

    def bent(x: FloatArray) -> FloatArray:
        return np.asarray(pump(x) + bend * np.sin(4.0 * x[:, 1]))

    method = PolynomialChaos(runs=60, max_degree=3)
    equal = Problem(pump, **INPUTS, units=2)
    one_bent = Problem(pump, **INPUTS, units=[Unit(name="a"), Unit(bent, name="b")])
    smooth, row = (
        method.estimate(problem, Criterion(2.0), rng=1)[0] for problem in (equal, one_bent)
    )
    assert (smooth.status, row.status) == ("converged", status)
    if status == "doubtful":
        assert "b: the surface predicts runs left out only to" in row.message
        return
    v, u = np.linspace(-8.0, 8.0, 161), np.linspace(-8.0, 8.0, 16_001)
    weights = [np.exp(-0.5 * z**2) / np.exp(-0.5 * z**2).sum() for z in (v, u)]
    own = 0.8 * u + bend * np.sin(4.0 * u)
    works = np.array([weights[1] @ (0.6 * w + own <= 2.0) for w in v])
    truth = float(weights[0] @ (1.0 - works * ndtr((2.0 - 0.6 * v) / 0.8)))
    assert row.std_error > 10.0 * smooth.std_error
    assert abs(row.pf - truth) < 2.0 * row.std_error


def test_units_of_several_kinds_that_share_everything() -> None:
    """Nothing individual: what the structure makes of the surfaces is one surface."""
    units = [Unit(lambda x: x[:, 0]), Unit(lambda x: 0.5 - 2.0 * x[:, 0]), Unit(offset=-9.0)]
    problem = Problem(
        lambda x: x[:, 0], shared={"V": normal(0, 1)}, units=units, structure=Structure("u0 | u1")
    )
    row = PolynomialChaos(runs=40).estimate(problem, Criterion(-0.1, missions=7), rng=1)[0]
    truth = float(ndtr(0.3) - ndtr(-0.1))
    assert abs(row.pf - truth) < 2.0 * row.std_error
    assert row.pf == pytest.approx(truth, rel=5e-3)


@pytest.mark.parametrize("method", [Kriging(runs=60), PolynomialChaos(runs=60)])
def test_a_unit_without_inputs_of_its_own_beside_others(method: ReliabilityMethod) -> None:
    """Given the shared input it fails for certain: what nodes would step over is a crossing."""
    for structure in STRUCTURES[1::4]:
        system = LinearUnits(structure, "one without inputs of its own")
        asked = [Criterion(1.0), Criterion(3.5), Criterion(1.0, missions=Binomial(4, 0.7))]
        rows = method.estimate(system.problem(), asked, rng=1)
        assert {row.status for row in rows} == {"converged"}
        for row, threshold in zip(rows[:2], (1.0, 3.5), strict=True):
            assert row.pf == pytest.approx(system.pf(threshold, 1), rel=1e-4)
            assert row.std_error < 5e-3 * row.pf


def test_units_without_inputs_of_their_own_are_refused_where_nodes_stand_still() -> None:
    problem = LinearUnits(Series(), "one without inputs of its own").problem()
    for name in ("ffni", "ffni-spa", "ffni-pearson"):
        reason = build(name).supports(problem, Criterion(1.0))
        assert reason is not None
        assert "fail or work for certain" in reason
    for name in ("kriging", "pce"):
        assert build(name).supports(problem, Criterion(1.0, tau=1.0)) is not None
    units = [Unit(), Unit(lambda x: -x[:, 0])]
    problem = Problem(lambda x: x[:, 0], shared={"V": normal(0, 1)}, units=units)
    for name in ("ffni", "ffni-spa", "ffni-pearson"):
        assert build(name).supports(problem, Criterion(1.0)) is not None


def test_a_budget_is_divided_among_kinds() -> None:
    """All runs of both surfaces are counted, and grow together."""
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM)
    result = Kriging().estimate(problem, Criterion(0.6), max_evals=41, rng=1)
    details = result.details
    assert isinstance(details, KrigingDetails)
    sizes = [one.surface.y.size for one in (details, *details.of_other_kinds)]
    assert sizes == [19, 21]
    assert result.n_evals == 40
    assert result[0].status == "budget_exhausted"
    few = Kriging().estimate(problem, Criterion(0.6), max_evals=13, rng=1)[0]
    assert few.status == "failed"
    assert "surfaces over 2 and 3 inputs needs at least 14 runs" in few.message


@pytest.mark.parametrize("structure", [SYSTEM, Series()])
def test_a_design_point_for_each_sort_of_units(structure: SystemStructure) -> None:
    """FORM took equal units only, and left those not in series ``unchecked``; it is exact here."""
    units = [*PUMPS, VALVE, Unit(valve, VALVE.individual, 0.1, name="spare")]
    problem = Problem(pump, **INPUTS, units=units, structure=structure)
    asked = [*CRITERIA, Criterion(4.0), Criterion(math.inf)]
    result = OpenTURNSFORM().estimate(problem, asked, rng=2)
    for criterion, row in zip(asked[:-1], result, strict=False):
        assert row.pf == pytest.approx(exact(units, structure, criterion), rel=1e-8)
        assert row.status == "converged"
        assert row.std_error < 0.05 * row.pf
    assert (result[4].pf, result[4].status) == (0.0, "doubtful")
    assert result[0].n_evals_row < result.n_evals


@pytest.mark.parametrize(
    ("bend", "start", "threshold"),
    [
        (0.0, 0.0, 2.2),
        # what units share does less than their planes say, beyond the design point of each
        (-3.0, 3.0, 2.2),
        # and a cause that all have in common, too rare to matter to one of them
        (5.0, 4.0, 3.2),
    ],
)
def test_planes_are_looked_at_where_units_that_differ_fail_together(
    bend: float, start: float, threshold: float
) -> None:
    """In parallel FORM was ``unchecked`` whatever the response did there."""

    def shared(v: FloatArray) -> FloatArray:
        return 0.6 * v + bend * np.maximum(v - start, 0.0)

    offsets = np.array([0.0, -0.3, 0.2])
    units = [Unit(offset=offset) for offset in offsets]
    problem = Problem(
        lambda x: shared(x[:, 0]) + 0.8 * x[:, 1], **INPUTS, units=units, structure=Parallel()
    )
    z = np.linspace(-9.0, 9.0, 9001)
    chance = ndtr((shared(z) + offsets[:, None] - threshold) / 0.8).prod(axis=0)
    truth = np.trapezoid(chance * np.exp(-0.5 * z**2), z) / math.sqrt(2.0 * math.pi)
    row = OpenTURNSFORM().estimate(problem, Criterion(threshold))[0]
    if bend == 0.0:
        assert row.status == "converged"
        assert row.pf == pytest.approx(truth, rel=1e-8)
    else:
        assert abs(row.pf / truth - 1.0) > 0.05
        assert row.status == "doubtful"


def test_many_units_whose_failure_is_hardly_met_are_doubted() -> None:
    """151 in parallel, 18 % off and ``converged``: all places that were looked at were the same."""

    def of(a: float, b: float, c: float) -> Any:
        return lambda x: a * x[:, 0] + c * x[:, 0] ** 2 + b * x[:, 1]

    first, second = of(0.378, 0.483, 0.176), of(0.802, 0.475, 0.212)
    units = [
        Unit(own, offset=offset)
        for own in (first, second)
        for offset in (-0.4, 0.0, 0.3)
        for _ in range(25)
    ]
    problem = Problem(first, **INPUTS, units=units, structure=Parallel())
    row = OpenTURNSFORM().estimate(problem, Criterion(6.0, missions=3))[0]
    assert row.status == "doubtful"


def test_more_directions_than_are_integrated_on_a_grid() -> None:
    """The error of a drawn integral in series was taken for one of the system, and doubted."""
    inputs = {"shared": [normal(0, 1)] * 4, "individual": {"U": normal(0, 1)}}
    units = [Unit(lambda x, j=j: 0.6 * x[:, j] + 0.8 * x[:, 4]) for j in range(4)]
    problem = Problem(pump, **inputs, units=units, structure=KOutOfN(2))
    row = OpenTURNSFORM().estimate(problem, Criterion(1.5))[0]
    p = float(ndtr(-1.5))
    truth = 4.0 * p**3 * (1.0 - p) + p**4
    assert row.status == "converged"
    assert abs(row.pf - truth) < 3.0 * row.std_error


@pytest.mark.parametrize(
    ("structure", "bend", "turn"),
    [
        # what is seen at one unit's own point is not taken for a cause in common
        (Parallel(), 0.006, 0.01),
        (KOutOfN(2), 0.006, 0.01),
        # planes at the units' own points are 9 % off: others touch where the system fails
        (Parallel(), 0.01, 0.0),
        (KOutOfN(2), -0.02, 0.0),
    ],
)
def test_curvature_where_units_fail_together_is_the_stated_error(
    structure: SystemStructure, bend: float, turn: float
) -> None:
    """All such rows were doubted. Against a sum over V."""
    offsets = np.array([0.0, -0.3, 0.2])
    problem = Problem(
        lambda x: 0.6 * x[:, 0] + bend * x[:, 0] ** 2 + (0.8 + turn * x[:, 0]) * x[:, 1],
        **INPUTS,
        units=[Unit(offset=offset) for offset in offsets],
        structure=structure,
    )
    z = np.linspace(-9.0, 9.0, 361)
    index = (2.2 - offsets[:, None] - 0.6 * z - bend * z**2) / (0.8 + turn * z)
    found = SystemUnits.of(problem).diagram
    assert found is not None
    failure, _ = found.probabilities(ndtr(-index), ndtr(index))
    density = np.exp(-0.5 * z**2)
    truth = failure @ density / density.sum()
    row = OpenTURNSFORM().estimate(problem, Criterion(2.2))[0]
    assert row.status == "converged"
    assert 0.003 < abs(row.pf / truth - 1.0) < 0.06
    assert abs(row.pf - truth) < 2.0 * row.std_error


def test_units_that_no_run_brings_to_their_limit_leave_their_system_an_answer() -> None:
    """One sort of units without a design point made the row of the whole system ``failed``."""

    def level(x: FloatArray) -> FloatArray:
        return np.full(len(x), 0.5)

    def bounded(x: FloatArray) -> FloatArray:
        return np.tanh(pump(x))

    for own, structure, threshold, truth in (
        (level, Series(), 2.0, ndtr(-2.0)),
        (level, Parallel(), 2.0, 0.0),
        (level, Series(), -1.5, 1.0),
        (level, Parallel(), -1.5, ndtr(1.5)),
        (bounded, Series(), 2.0, ndtr(-2.0)),
    ):
        problem = Problem(pump, **INPUTS, units=[Unit(), Unit(own)], structure=structure)
        row = OpenTURNSFORM().estimate(problem, Criterion(threshold))[0]
        assert row.status == "doubtful"
        assert row.pf == pytest.approx(truth, rel=1e-9)
        assert "taken for one that always" in row.message


def test_a_curved_limit_state_of_one_sort_is_doubted() -> None:
    """What a second look shows at one unit's point reaches the verdict of the system."""
    curved = Unit(lambda x: pump(x) - 0.2 * x[:, 1] ** 2, name="curved")
    problem = Problem(pump, **INPUTS, units=[Unit(), curved])
    row = OpenTURNSFORM().estimate(problem, Criterion(2.0), rng=1)[0]
    assert row.status == "doubtful"
    assert "not its plane" in row.message


def test_active_kriging_learns_what_decides_a_system_of_several_kinds() -> None:
    """Offsets and kinds were ``unsupported``: one surface for each kind, learned together."""
    units = [*PUMPS, VALVE]
    problem = Problem(pump, **INPUTS, units=units, structure=SYSTEM)
    result = ActiveKriging(kernel="gaussian").estimate(problem, CRITERIA, rng=2)
    details = result.details
    for criterion, row in zip(CRITERIA, result, strict=True):
        assert row.status == "converged", row.message
        assert abs(row.pf - exact(units, SYSTEM, criterion)) <= 3.0 * row.std_error
    both = [details, *details.of_other_kinds]
    assert [one.surface.u.shape[1] for one in both] == [2, 3]
    assert all(one.checks[-1].passed for one in both)
    assert details.history_runs[-1] == sum(one.surface.y.size for one in both) < result.n_evals


@pytest.mark.thorough
def test_active_kriging_sees_units_apart_by_their_offsets_under_tau() -> None:
    units = [Unit(), Unit(offset=0.4), Unit(offset=0.4)]
    problem, asked = Problem(pump, **INPUTS, units=units), Criterion(1.5, tau=2.0)
    row = ActiveKriging(kernel="gaussian").estimate(problem, asked, rng=1)[0]
    known = PolynomialChaos(runs=30).estimate(problem, asked, rng=1)[0]
    assert row.status == "converged", row.message
    assert row.pf == pytest.approx(known.pf, rel=1e-3)


def test_units_that_never_fail_are_no_extrapolation_of_their_system() -> None:
    """A threshold that no run comes near is a doubt where it decides: alone, and in parallel."""
    method = ActiveKriging(kernel="gaussian", runs=60)
    for structure, status in ((Series(), "converged"), (Parallel(), "doubtful")):
        units = [Unit(), Unit(offset=-12.0)]
        problem = Problem(pump, **INPUTS, units=units, structure=structure)
        row = method.estimate(problem, Criterion(2.0), rng=1)[0]
        assert row.status == status, row.message
    assert "no run has come near the threshold" in row.message


def test_active_kriging_of_units_that_share_all_of_their_inputs() -> None:
    """One surface with offsets is answered; several are refused before any run, with a remedy."""
    shared = {"shared": {"V": normal(0, 1)}}
    alike = [Unit(offset=offset) for offset in (0.0, 0.5, -1.0)]
    problem = Problem(lambda x: x[:, 0], **shared, units=alike, structure=KOutOfN(2))
    row = ActiveKriging(kernel="gaussian").estimate(problem, Criterion(2.0), rng=1)[0]
    # the second largest offset is that of the system
    assert row.pf == pytest.approx(float(ndtr(-2.0)), rel=1e-3)
    problem = Problem(lambda x: x[:, 0], **shared, units=[Unit(), Unit(lambda x: x[:, 0] ** 2)])
    row = ActiveKriging().estimate(problem, Criterion(2.0), rng=1)[0]
    assert (row.status, row.n_evals) == ("unsupported", 0)
    assert "let one model return what the structure makes of them" in row.message


SIMULATE = {"mc", "conditional-mc", "openturns-mc"}
SURFACES = ["kriging", "active-kriging", "pce"]
ANSWER = [*sorted(SIMULATE), *SURFACES, "ffni", "ffni-spa", "ffni-pearson", "openturns-form"]


@pytest.mark.parametrize("name", ANSWER)
def test_what_a_method_cannot_answer_it_says_before_any_run(name: str) -> None:
    method = build(name)
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM)
    assert method.supports(problem, Criterion(1.0)) is None
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE])
    under_tau = name not in ("ffni-spa", "openturns-form")
    assert (method.supports(problem, Criterion(1.0, tau=1.0)) is None) == under_tau


def test_no_public_question_is_unsupported_by_every_method() -> None:
    """All structures, units and missions; tau in series, where "all of them" has a meaning."""
    methods = [build(name) for name in available()]
    for structure, differing in product(STRUCTURES, OFFSETS):
        problem = LinearUnits(structure, differing).problem()
        for criterion in (*CRITERIA, Criterion(1.0, tau=1.0)):
            answering = [m.name for m in methods if m.supports(problem, criterion) is None]
            if criterion.tau is None:
                surfaces = SURFACES if "without" not in differing else ["kriging", "pce"]
                assert {"mc", "conditional-mc", "openturns-mc", *surfaces} < {*answering}
            else:
                assert bool(answering) == isinstance(structure, Series)
    partnered = replace(LinearUnits(Parallel(), "kinds").problem(), low_fidelity=pump)
    assert build("multifidelity-mc").supports(partnered, CRITERIA[0]) is not None
    units = [replace(unit, low_fidelity=unit.model) for unit in partnered.units]  # type: ignore
    partnered = replace(partnered, units=units)
    assert build("multifidelity-mc").supports(partnered, CRITERIA[0]) is None


def test_units_of_one_kind_are_one_problem() -> None:
    """A model that all units share is that of the problem; without offsets they are equal."""
    own = [Unit(valve, VALVE.individual, name=name) for name in "ab"]
    problem = Problem(pump, **INPUTS, units=own)
    assert problem.exchangeable
    assert problem.model is valve
    assert problem.inputs.n_individual == 2
    row = PolynomialChaos(runs=40, max_degree=2).estimate(problem, Criterion(0.8), rng=1)[0]
    assert row.pf == pytest.approx(exact(own, Series(), Criterion(0.8)), rel=1e-5)


class Rig:
    def bend(self, x: FloatArray) -> FloatArray:
        return pump(x)


def test_equal_models_and_inputs_are_one_kind() -> None:
    """Inputs that are written out again, and a method that is named again, are the same."""
    rig = Rig()
    units = [Unit(rig.bend, [normal(0, k)]) for k in (1, 2, 1, 2)]
    kinds = Problem(pump, **INPUTS, units=units).kinds
    assert kinds.of_units is not None
    assert kinds.of_units.tolist() == [0, 1, 0, 1]


def mixture(weight: float) -> Any:
    return ot.Mixture([ot.Normal(0.0, 1.0), ot.Normal(3.0, 1.0)], [weight, 1.0 - weight])


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ([ot.Normal()], [ot.Normal()] * 2),  # in the other order OpenTURNS may crash
        ([ot.Normal()] * 2, [ot.Normal()]),
        ([mixture(0.5)], [mixture(0.9)]),
        ([ot.TruncatedDistribution(mixture(0.5), 0.0, 1.0)],
         [ot.TruncatedDistribution(mixture(0.9), 0.0, 1.0)]),
        ([ot.MaximumDistribution(ot.Normal(), 2)], [ot.MaximumDistribution(ot.Normal(), 5)]),
        ([ot.Normal()], [ot.Normal(0.0, 1.0 + 1e-9)]),
    ],
)  # fmt: skip
def test_inputs_that_openturns_calls_equal_are_two_kinds(first: Any, second: Any) -> None:
    """A unit answered with another's inputs, `converged`, by every method."""

    def total(x: FloatArray) -> FloatArray:
        return np.asarray(x.sum(axis=1))

    units = [Unit(total, first), Unit(total, second), Unit(total, first)]
    kinds = Problem(total, **INPUTS, units=units).kinds
    assert kinds.of_units is not None
    assert kinds.of_units.tolist() == [0, 1, 0]


def test_other_moments_of_a_shared_input_reach_all_kinds() -> None:
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE])
    problem = problem.with_moments(means={"V": 2.0}).with_moments(means={"U": 1.0})
    first, second = problem.kinds.inputs
    assert first.means.tolist() == [2.0, 1.0]
    assert second.means.tolist() == [2.0, 0.2, 0.0]


def test_a_number_of_units_may_be_as_large_as_it_likes() -> None:
    """Kinds are kept for units that are named, not for a billion that are alike."""
    problem = Problem(pump, **INPUTS, units=10**9)
    row = PolynomialChaos(runs=25, max_degree=2).estimate(problem, Criterion(8.0), rng=1)[0]
    exact_pf = quad(
        lambda v: -math.expm1(1e9 * float(log_ndtr((8.0 - 0.6 * v) / 0.8))) * math.exp(-v * v / 2),
        -9, 9, epsrel=1e-9,
    )[0]  # fmt: skip
    assert abs(row.pf - exact_pf / math.sqrt(2.0 * math.pi)) < 3.0 * row.std_error


def test_what_looks_at_one_unit_refuses_units_of_several_kinds() -> None:
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE])
    for analysis in (conditional_sobol, pick_freeze):
        with pytest.raises(ValueError, match="give units of one model with the same inputs"):
            analysis(problem, samples=64)


def test_a_failed_run_of_one_kind_leaves_the_other_rows_alone() -> None:
    def lost(x: FloatArray) -> FloatArray:
        if (x[:, 1] > 1.0).any():
            raise ArithmeticError("out of range")
        return valve(x)

    units = [*PUMPS, Unit(lost, VALVE.individual, name="valve")]
    problem = Problem(pump, **INPUTS, units=units, structure=SYSTEM)
    row = MonteCarlo(systems=300).estimate(problem, Criterion(0.6), rng=1)[0]
    whole = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM)
    known = MonteCarlo(systems=300).estimate(whole, Criterion(0.6), rng=1)[0]
    assert row.n_failed > 0
    assert row.pf_low <= known.pf <= row.pf_high
    assert row.pf_low < row.pf_high
    assert "out of range" in row.message


def test_units_that_differ_are_stored(tmp_path) -> None:  # type: ignore[no-untyped-def]
    problem = Problem(pump, **INPUTS, units=[*PUMPS, VALVE], structure=SYSTEM, version="1")
    with evaluation.Store(tmp_path / "runs.sqlite") as store:
        first, second = (
            MonteCarlo(systems=50).estimate(
                problem, Criterion(0.6), rng=1, evaluator=Evaluator(store=store)
            )[0]
            for _ in range(2)
        )
    assert (first.n_reused, second.n_reused) == (0, 150)
    assert first.pf == second.pf


def test_own_inputs_need_shared_ones_that_are_independent() -> None:
    joint = Problem(pump, **INPUTS).inputs.distribution
    assert Problem(pump, inputs=joint, shared=["V"], units=[VALVE]).inputs.dimension == 3
    tied = normal_copula({"V": normal(0, 1), "U": normal(0, 1)}, np.array([[1, 0.5], [0.5, 1]]))
    with pytest.raises(ValueError, match="shared and individual inputs depend on each other"):
        Problem(pump, inputs=tied, shared=["V"], units=[VALVE])
    with pytest.raises(ValueError, match="input 'V' is named twice"):
        Problem(pump, **INPUTS, units=[Unit(individual={"V": normal(0, 1)})])
