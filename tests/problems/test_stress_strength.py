"""Redundant units under one stress: the published formula, and missions by quadrature over it."""

from __future__ import annotations

import math

import pytest
from scipy.integrate import quad
from scipy.stats import binom

from uqfold import Criterion, KOutOfN
from uqfold.methods import PolynomialChaos
from uqfold.problems import stress_strength


@pytest.mark.parametrize(
    ("units", "works", "strength", "published"),
    [(3, 1, 1.0, 1 / 4), (4, 2, 1.0, 2 / 5), (4, 1, 20.0, 24 / (21 * 22 * 23 * 24))],
)
def test_one_mission_is_the_published_formula(
    units: int, works: int, strength: float, published: float
) -> None:
    problem = stress_strength(units, works, strength)
    assert problem.structure == KOutOfN(works)
    assert problem.references is not None
    found = {one.criterion: one.pf for one in problem.references}
    assert found[Criterion(0.0)] == pytest.approx(published, rel=1e-13)
    assert found[Criterion(3.0)] == pytest.approx(math.exp(-3.0) * published, rel=1e-13)


@pytest.mark.parametrize(("units", "works", "strength"), [(4, 1, 20.0), (10, 3, 7.5)])
def test_missions_share_their_stress(units: int, works: int, strength: float) -> None:
    references = stress_strength(units, works, strength).references
    assert references is not None

    def fails(stress: float, missions: int) -> float:
        one = binom.sf(units - works, units, -math.expm1(-stress / strength))
        return -math.expm1(missions * math.log1p(-min(one, 1.0 - 1e-16)))

    for missions in (3, 10):
        exact = quad(lambda s, m=missions: fails(s, m) * math.exp(-s), 0.0, 90.0, epsrel=1e-11)[0]
        found = references.lookup(Criterion(0.0, missions=missions))
        assert found is not None
        assert found.pf == pytest.approx(exact, rel=1e-9)


def test_an_expansion_in_the_inputs_own_polynomials_is_right() -> None:
    """The response is linear in the inputs, and not in any normal variable."""
    problem = stress_strength()
    assert problem.references is not None
    result = PolynomialChaos(runs=40).estimate(problem, rng=1)
    for row, reference in zip(result, problem.references, strict=True):
        assert row.status == "converged"
        assert row.pf == pytest.approx(reference.pf, rel=1e-3)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"units": 0}, "units = 0"),
        ({"units": 101}, "units = 101"),
        ({"units": 3, "works": 4}, "works = 4"),
        ({"strength": 0.0}, "strength = 0"),
    ],
)
def test_wrong_arguments_are_refused(wrong: dict[str, int], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        stress_strength(**wrong)
