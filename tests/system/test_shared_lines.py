"""Units without variables of their own beside others with them, against closed forms."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

from uqfold import Criterion, CutSets, KOutOfN, Parallel, Problem, Series, Unit
from uqfold.inputs import normal
from uqfold.problems.structure import SystemStructure
from uqfold.system.lines import FINITE, MISSING, NEVER
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem
from uqfold.system.surface_layout import laid_out
from uqfold.typing import FloatArray, IntArray

Surface = Callable[[FloatArray], FloatArray]


def system_of(
    surfaces: Sequence[Surface],
    own: Sequence[int],
    n_shared: int,
    structure: SystemStructure,
    asked: Sequence[Criterion],
    *,
    complete: bool = True,
) -> SurfaceSystem:
    units = [
        Unit(surface, [normal(0, 1)] * count) for surface, count in zip(surfaces, own, strict=True)
    ]
    shared = [normal(0, 1)] * n_shared
    problem = Problem(surfaces[0], shared=shared, units=units, structure=structure)
    sizes = [n_shared + count for count in own]
    given = SystemUnits.of(problem)
    return laid_out(surfaces, sizes, n_shared, given, asked, complete=complete)


def last(u: FloatArray) -> FloatArray:
    return 0.6 * u[:, -2] + 0.8 * u[:, -1]


def over_v(fails: Callable[[float], float], jumps: Sequence[float]) -> float:
    edges = sorted({-9.0, 9.0, *(j for j in jumps if abs(j) < 9.0)})
    parts = itertools.pairwise(edges)
    whole = sum(
        quad(lambda v: math.exp(-0.5 * v * v) * fails(v), *ends, epsabs=0.0, limit=200)[0]
        for ends in parts
    )
    return float(whole / math.sqrt(2.0 * math.pi))


@pytest.mark.parametrize("threshold", [0.3, 3.0, 5.0])
@pytest.mark.parametrize(
    ("structure", "fails"),
    [
        (Series(), lambda a, b, c: 1.0 - (1.0 - a) * (1.0 - b) * (1.0 - c)),
        (Parallel(), lambda a, b, c: a * b * c),
        (KOutOfN(2), lambda a, b, c: a * b + a * c + b * c - 2.0 * a * b * c),
        (CutSets([[0, 1], [2]]), lambda a, b, c: 1.0 - (1.0 - a * b) * (1.0 - c)),
    ],
)
def test_one_shared_variable(
    structure: SystemStructure, fails: Callable[..., float], threshold: float
) -> None:
    """Two units that V alone decides, one of them on both sides, and one with a variable."""
    surfaces = [lambda u: u[:, 0], lambda u: 0.4 * u[:, 0] ** 2 - 1.0, last]
    asked = [Criterion(threshold), Criterion(threshold, missions=3)]
    system = system_of(surfaces, [0, 0, 1], 1, structure, asked)
    responses = system.responses(surfaces)
    bend = math.sqrt((threshold + 1.0) / 0.4)
    for row, missions in enumerate((1, 3)):

        def given(v: float, missions: int = missions) -> float:
            c = float(ndtr((0.6 * v - threshold) / 0.8))
            one = fails(float(v > threshold), float(abs(v) > bend), c)
            return -math.expm1(missions * math.log1p(-one)) if one < 1.0 else 1.0

        truth = over_v(given, [threshold, bend, -bend])
        found = system.failures_given(responses, asked)[row]
        assert found.pf == pytest.approx(truth, rel=3e-4)
        assert found.pf + found.reliability == pytest.approx(1.0)
    assert (system.integration_errors(responses, asked) < 1e-3).all()


@pytest.mark.parametrize("n_shared", [2, 3, pytest.param(4, marks=pytest.mark.thorough)])
def test_several_shared_variables(n_shared: int) -> None:
    """Units that the first and the second decide, one that has some of the last: a product."""
    surfaces = [
        lambda u: u[:, 0],
        lambda u: u[:, 1],
        lambda u: 0.6 * u[:, n_shared - 1] + 0.8 * u[:, -1],
    ]
    asked = [Criterion(t) for t in (0.0, 2.0)]
    for structure in (Parallel(), Series()):
        system = system_of(surfaces, [0, 0, 1], n_shared, structure, asked)
        responses = system.responses(surfaces)
        errors = system.integration_errors(responses, asked)
        found = system.failures_given(responses, asked)
        for one, error, criterion in zip(found, errors, asked, strict=True):
            t = criterion.threshold
            if n_shared > 2:
                both = ndtr(-t) ** 3, ndtr(t) ** 3
            else:
                # the second one decides on its own unit and has a share in the last
                both = (
                    ndtr(-t) * over_v(lambda v, t=t: float(v > t) * ndtr((0.6 * v - t) / 0.8), [t]),
                    ndtr(t) * over_v(lambda v, t=t: float(v <= t) * ndtr((t - 0.6 * v) / 0.8), [t]),
                )
            value, truth = (
                (one.pf, both[0]) if structure == Parallel() else (one.reliability, both[1])
            )
            # an error of the index is this one of a tail, relative
            assert abs(value / truth - 1.0) < 3.0 * error * 7.0 + 1e-4
            assert value == pytest.approx(truth, rel=0.05)


def test_crossings_move_as_a_surface_does() -> None:
    """Surfaces drawn from a posterior move jumps by less than any nodes are apart."""
    surfaces = [lambda u: u[:, 0], last]
    asked = [Criterion(3.0)]
    system = system_of(surfaces, [0, 1], 1, Series(), asked)
    steps = (0.0, 1e-4, 1e-3)
    paths = [lambda u, one=one: np.array([one(u) + step for step in steps]) for one in surfaces]
    moved = system.changes(surfaces, paths, asked)[:, 0]
    assert moved[0] == 0.0
    assert moved[2] / moved[1] == pytest.approx(10.0, rel=0.02)


def test_infinite_and_failed_responses_count_as_failures() -> None:
    """A half of one kind's inputs has none, and that unit fails there."""

    def outcomes(kind: int) -> Callable[[FloatArray], IntArray]:
        return lambda u: np.where(u[:, 0] > 0.0, kind, FINITE)

    surfaces = [lambda u: u[:, 0], last]
    asked = [Criterion(9.0)]
    system = system_of(surfaces, [0, 1], 1, Series(), asked, complete=False)
    for kind in (NEVER, MISSING):
        for first, second in ((kind, FINITE), (FINITE, kind)):
            [found] = system.failures(surfaces, asked, [outcomes(first), outcomes(second)])
            # outcomes are told apart to half a step between stations
            assert found.pf == pytest.approx(0.5, abs=0.06)


def test_noise_of_a_response_makes_a_chance_of_what_was_certain() -> None:
    surfaces = [lambda u: u[:, 0], last]
    asked = [Criterion(2.0)]
    system = system_of(surfaces, [0, 1], 1, Parallel(), asked)
    [found] = system.failures(surfaces, asked, noise=[0.5, 0.3])

    def given(v: float) -> float:
        return float(ndtr((v - 2.0) / 0.5) * ndtr((0.6 * v - 2.0) / math.hypot(0.8, 0.3)))

    assert found.pf == pytest.approx(over_v(given, [2.0]), rel=1e-3)


def test_no_unit_has_variables_of_its_own() -> None:
    """Far out on both sides of one variable a unit fails that another one hides by its size."""
    surfaces = [lambda u: u[:, 0], lambda u: -u[:, 0], lambda u: u[:, 1] ** 2 - 3.0]
    asked = [Criterion(4.0)]
    system = system_of(surfaces, [0, 0, 0], 2, Series(), asked)
    responses = system.responses(surfaces)
    [found] = system.failures_given(responses, asked)
    works = (1.0 - 2.0 * ndtr(-4.0)) * (1.0 - 2.0 * ndtr(-math.sqrt(7.0)))
    assert found.pf == pytest.approx(1.0 - works, rel=5e-4)
    assert system.integration_errors(responses, asked) < 1e-3
