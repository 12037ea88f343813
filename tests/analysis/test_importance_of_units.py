"""Importance of units with a common cause, against quadrature over it."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import quad
from scipy.special import ndtr

from uqfold import Criterion, Parallel, Problem, Structure, Unit
from uqfold.analysis import importance_of_units
from uqfold.inputs import normal
from uqfold.methods import PolynomialChaos
from uqfold.typing import FloatArray

OFFSETS = np.array([0.0, -0.3, 0.2])
METHOD = PolynomialChaos(runs=25, max_degree=2)


def pump(x: FloatArray) -> FloatArray:
    return 0.6 * x[:, 0] + 0.8 * x[:, 1]


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    problem = Problem(
        pump,
        shared={"V": normal(0, 1)},
        individual={"U": normal(0, 1)},
        units=[Unit(offset=float(one)) for one in OFFSETS],
        structure=Structure("u0 & u1 | u2"),
    )
    return importance_of_units(problem, [Criterion(1.0), Criterion(1.6, missions=3)], METHOD, rng=1)


def system(p: FloatArray, missions: int) -> float:
    failure = (p[0] + p[1] - p[0] * p[1]) * p[2]
    return -math.expm1(missions * math.log1p(-min(failure, 1.0 - 1e-16)))


def expected(threshold: float, missions: int, unit: int | None, fate: float, apart: bool) -> float:
    """E_v of the failure of the system with one unit's fate decided, or of E_v of its units."""

    def over_v(value) -> float:  # type: ignore[no-untyped-def]
        density = math.sqrt(2.0 * math.pi)
        return float(
            quad(lambda v: value(v) * math.exp(-0.5 * v * v) / density, -9, 9, epsrel=1e-10)[0]
        )

    def units(v: float) -> FloatArray:
        return np.asarray(ndtr((0.6 * v + OFFSETS - threshold) / 0.8))

    def decided(p: FloatArray) -> float:
        p = p.copy()
        if unit is not None:
            p[unit] = fate
        return system(p, missions)

    if apart:
        return decided(np.array([over_v(lambda v, i=i: units(v)[i]) for i in range(3)]))
    return over_v(lambda v: decided(units(v)))


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize(("threshold", "missions"), [(1.0, 1), (1.6, 3)])
def test_measures_of_units_with_a_common_cause(
    table: pd.DataFrame, threshold: float, missions: int, apart: bool
) -> None:
    """No analysis said which unit matters, nor what the common cause does to the answer."""
    rows = table[table.threshold == threshold]
    end = "_independent" if apart else ""
    pf = expected(threshold, missions, None, 0.0, apart)
    assert rows[f"pf{end}"].tolist() == pytest.approx([pf] * 3, rel=1e-6)
    for i, row in enumerate(rows.to_dict("records")):
        broken = expected(threshold, missions, i, 1.0, apart)
        perfect = expected(threshold, missions, i, 0.0, apart)
        assert row[f"birnbaum{end}"] == pytest.approx(broken - perfect, rel=1e-6)
        assert row[f"fussell_vesely{end}"] == pytest.approx((pf - perfect) / pf, rel=1e-6)
        assert row[f"risk_achievement_worth{end}"] == pytest.approx(broken / pf, rel=1e-6)
        reduction = math.inf if perfect == 0.0 else pf / perfect
        assert row[f"risk_reduction_worth{end}"] == pytest.approx(reduction, rel=1e-6)


def test_the_table_says_what_the_method_says(table: pd.DataFrame) -> None:
    assert table.unit.tolist() == ["u0", "u1", "u2"] * 2
    assert table.missions.tolist() == ["1"] * 3 + ["3"] * 3
    assert table.status.tolist() == ["converged"] * 6
    assert table.pf_unit.tolist()[:3] == pytest.approx(ndtr(OFFSETS - 1.0).tolist(), rel=1e-6)
    # redundancy is worth less than independence makes believe
    assert (table.pf > 1.5 * table.pf_independent).all()


def test_what_has_no_importance_is_refused() -> None:
    options = {"shared": {"V": normal(0, 1)}, "units": 2}
    together = Problem(lambda x: x[:, 0], **options, structure=Parallel())
    with pytest.raises(ValueError, match="nothing is individual: its units fail together"):
        importance_of_units(together, Criterion(1.0))
    series = Problem(pump, individual={"U": normal(0, 1)}, **options)
    with pytest.raises(ValueError, match="under tau units matter together"):
        importance_of_units(series, Criterion(1.0, tau=1.0))
