"""Influence of the surface on pf, against finite differences of the system algebra itself."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.structure import KOutOfN
from uqfold.system.conditional import system_failure, system_failures_of_kinds
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.decision_diagram import diagram
from uqfold.system.influence import influences
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

Z = np.linspace(-8.0, 8.0, 401)


def bent(z: FloatArray) -> FloatArray:
    """Response as a rising function of one standard-normal variable."""
    return np.asarray(10.0 + z + 0.1 * z * np.abs(z))


def response(f: FloatArray) -> ConditionalResponse:
    return ConditionalResponse(TabulatedDistribution(f, Z))


def bump(z: FloatArray, centre: float) -> FloatArray:
    return np.asarray(np.exp(-0.5 * ((z - centre) / 0.4) ** 2))


def pf(f: FloatArray, units: int, criterion: Criterion) -> float:
    found = system_failure(
        [response(f)], [1.0], units, criterion.threshold, criterion.tau, criterion.missions
    )
    return found.pf


CRITERIA = [
    Criterion(11.5),
    Criterion(9.0, missions=3),
    Criterion(12.0, missions=Binomial(4, 0.6)),
    Criterion(12.0, tau=2.5),
    Criterion(10.5, tau=1.0),
    Criterion(14.0, tau=3.0, missions=2),
    Criterion(30.0, tau=2.0),
    Criterion(11.0, tau=50.0),
]


@pytest.mark.parametrize("units", [1, 2, 4])
@pytest.mark.parametrize("criterion", CRITERIA, ids=str)
def test_influence_is_the_derivative_of_pf(units: int, criterion: Criterion) -> None:
    """Raise the surface a little around one place, and see what happens to pf."""
    f = bent(Z)
    ((found,),) = influences(response(f), units, [criterion])
    fine = np.linspace(-8.0, 8.0, 40_001)
    density = np.exp(-0.5 * fine**2) / math.sqrt(2.0 * math.pi)
    rest = found.rest(bent(fine))
    # where the level is crossed, and how steep the surface is there
    crossing = np.interp(criterion.threshold, bent(fine), fine)
    slope = 1.0 + 0.2 * abs(crossing)
    at_level = math.exp(-0.5 * crossing**2) / math.sqrt(2.0 * math.pi) / slope
    if not bent(fine[:1])[0] < criterion.threshold < bent(fine[-1:])[0]:
        at_level = 0.0
    step = 1e-5
    for centre in (-2.0, -0.8, 0.0, 1.0, 2.2):
        weight = bump(fine, centre)
        predicted = float(found.jumps[0]) * at_level * float(bump(np.array([crossing]), centre)[0])
        predicted += float(np.sum(density * rest * weight) * (fine[1] - fine[0]))
        up, down = (pf(f + sign * step * bump(Z, centre), units, criterion) for sign in (1.0, -1.0))
        change = (up - down) / (2.0 * step)
        assert predicted == pytest.approx(change, rel=0.02, abs=2e-3), centre


SORTS = {"offsets": np.array([0.0, 0.4, -0.3]), "of_sorts": np.array([0, 2, 1, 0, 2])}
DIFFERENT = [
    # three sorts of two kinds, two units of which are alike: in series, and 3 of 5
    SystemUnits(5, None, of_kinds=np.array([0, 0, 1]), **SORTS),
    SystemUnits(
        5, diagram(KOutOfN(3), tuple("abcde")), of_kinds=np.array([0, 0, 1]), **SORTS
    ),
]  # fmt: skip


ASKED = [(DIFFERENT[0], one) for one in CRITERIA[2:6]] + [
    # under tau all units must work
    (DIFFERENT[1], one) for one in CRITERIA if one.tau is None
]  # fmt: skip


@pytest.mark.parametrize(("units", "criterion"), ASKED, ids=str)
def test_influence_of_units_that_differ(units: SystemUnits, criterion: Criterion) -> None:
    """Raise one surface in one place, wherever its units with their offsets are decided."""
    surfaces = [bent(Z), 9.9 + 0.8 * Z]

    def pf_of(raised: Sequence[FloatArray]) -> float:
        responses = [[response(one)] for one in raised]
        return system_failures_of_kinds(responses, [1.0], units, [criterion])[0].pf

    found = influences([response(one) for one in surfaces], units, [criterion])
    fine = np.linspace(-8.0, 8.0, 40_001)
    density = np.exp(-0.5 * fine**2) / math.sqrt(2.0 * math.pi)
    step = 1e-5
    for kind, (f, (own,)) in enumerate(zip(surfaces, found, strict=True)):
        values = np.interp(fine, Z, f)
        for centre in (-0.8, 0.6, 1.5):
            weight = bump(fine, centre)
            predicted = float(np.sum(density * own.rest(values) * weight) * (fine[1] - fine[0]))
            for level, jump in zip(own.levels, own.jumps, strict=True):
                at = np.interp(level, values, fine)
                if values[0] < level < values[-1]:
                    slope = np.interp(at, fine, np.gradient(values, fine))
                    height = math.exp(-0.5 * at**2) / math.sqrt(2.0 * math.pi) / slope
                    predicted += jump * height * float(bump(np.array([at]), centre)[0])
            up, down = (
                pf_of([one + sign * step * bump(Z, centre) * (place == kind)
                       for place, one in enumerate(surfaces)])
                for sign in (1.0, -1.0)
            )  # fmt: skip
            assert predicted == pytest.approx((up - down) / (2.0 * step), rel=0.02, abs=2e-3)


@pytest.mark.parametrize("units", [1, 3])
@pytest.mark.parametrize("criterion", CRITERIA, ids=str)
def test_failure_of_one_mission_is_roughly_that_of_the_algebra(
    units: int, criterion: Criterion
) -> None:
    ((found,),) = influences(response(bent(Z)), units, [criterion])
    exact = pf(bent(Z), units, Criterion(criterion.threshold, criterion.tau))
    assert found.failure == pytest.approx(exact, rel=0.01, abs=1e-12)


def test_constant_and_missing_responses_have_no_spread_part() -> None:
    asked = [Criterion(1.0, tau=0.5), Criterion(-1.0, tau=0.5)]
    (constant,) = influences(ConditionalResponse(AtomicDistribution((0.0,))), 3, asked)
    assert [round(one.failure, 12) for one in constant] == [0.0, 1.0]
    assert all((one.rest(np.array([0.0, 0.5])) == 0.0).all() for one in constant)
    (nothing,) = influences(ConditionalResponse(None, p_never=1.0), 3, asked)
    assert all(one.jumps == 0.0 for one in nothing)
