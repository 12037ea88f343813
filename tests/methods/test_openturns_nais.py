"""NAIS of OpenTURNS: an error from repetitions, and doubts about regions that it loses."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from uqfold.evaluation import Evaluator
from uqfold.inputs import normal
from uqfold.methods import OpenTURNSNAIS
from uqfold.methods.importance_search import ImportanceSearch
from uqfold.methods.openturns_nais import Repeated
from uqfold.methods.repetitions import Repetitions
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray

QUICK = OpenTURNSNAIS(samples=100)


def largest(x: FloatArray) -> FloatArray:
    return x[:, 0]


def standard_normal(model: object = largest) -> Problem:
    inputs = {f"u{i}": normal(0.0, 1.0) for i in range(2)}
    return Problem(model, individual=inputs)  # type: ignore[arg-type]


def test_answer_and_error_hold() -> None:
    pf, problem = 1e-4, standard_normal()
    asked = Criterion(float(-ndtri(pf)))
    rows = [QUICK.estimate(problem, asked, max_evals=9_000, rng=seed)[0] for seed in range(3)]
    assert sum(row.ci_low <= pf <= row.ci_high for row in rows) >= 2
    for row in rows:
        assert abs(row.pf - pf) < 4.5 * row.std_error < 0.7 * pf
        assert row.n_evals <= 9_000


@pytest.mark.thorough
def test_missions_tau_and_units_are_those_of_the_system() -> None:
    system = LinearNormalSystem(units=2, shared_std=0.5)
    asked = [Criterion(13.0, missions=2), Criterion(14.0, tau=5.0)]
    result = QUICK.estimate(system.problem(), asked, max_evals=60_000, rng=1)
    for criterion, row in zip(asked, result, strict=True):
        assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error < 2.0 * row.pf


@pytest.mark.thorough
def test_a_region_that_its_densities_lose_is_a_doubt(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that looks at one side alone is no answer for two sides."""
    pf, problem = 2e-3, standard_normal(lambda x: np.abs(x[:, 0]))
    asked = Criterion(float(-ndtri(0.5 * pf)))
    both = QUICK.estimate(problem, asked, max_evals=40_000, rng=3)[0]
    assert abs(both.pf - pf) < 4.0 * both.std_error
    margin = Repeated._margin

    def one_sided(self: Repeated, high: FloatArray) -> FloatArray:
        own = margin(self, high)
        return np.where(self.last[:, 0] > 0.0, own, -1.0 - np.abs(own))

    heights = Repeated._heights

    def noted(self: Repeated, u: FloatArray, **labels: object) -> tuple[FloatArray, FloatArray]:
        self.last = np.array(u)
        return heights(self, u, **labels)

    monkeypatch.setattr(Repeated, "last", None, raising=False)
    monkeypatch.setattr(Repeated, "_margin", one_sided)
    monkeypatch.setattr(Repeated, "_heights", noted)
    lost = QUICK.estimate(problem, asked, max_evals=40_000, rng=3)[0]
    assert lost.status == "doubtful"
    assert "of the failures that climbs found lie where samples are rare" in lost.message


def test_heavy_and_skewed_weights_are_doubts() -> None:
    search = object.__new__(ImportanceSearch)
    search.witnesses = None
    found = object.__new__(Repeated)
    found.size, found._densities = 1_000, [None] * 10
    found._largest, found._powers = 1.0, np.array([1e-2, 1e-2, 1e-2]) * 10
    values = Repetitions(np.full(10, 1e-2))
    assert found.doubts(search, values) == []
    found._largest = 3.0
    assert found.doubts(search, values) == ["one sample makes 3 % of pf"]
    found._largest, found._powers = 1.0, np.array([1e-2, 1e-1, 10.0]) * 10
    assert "too skewed" in found.doubts(search, values)[0]


def test_failed_runs_target_and_time() -> None:
    def failing(x: FloatArray) -> FloatArray:
        return np.where((x[:, 0] > 2.0) & (x[:, 1] > 0.0), np.nan, x[:, 0])

    row = QUICK.estimate(standard_normal(failing), 3.0, max_evals=9_000, rng=1)[0]
    tail = float(ndtr(-3.0))
    assert row.status == "doubtful"
    assert row.pf_low == pytest.approx(0.5 * tail, rel=0.5)
    assert row.pf_high == pytest.approx(0.5 * (tail + float(ndtr(-2.0))), rel=0.5)
    method = replace(QUICK, repetitions=12)
    some = method.estimate(standard_normal(), 3.0, rng=1)
    assert some.details.sets[0].pf.size == 12
    short = replace(QUICK, repetitions=500).estimate(standard_normal(), 3.0, max_evals=6_000, rng=1)
    assert "of 500 repetitions" in short[0].message
    early = replace(QUICK, target_cov=0.15).estimate(standard_normal(), 3.0, rng=1)
    assert early[0].std_error < 0.15 * early[0].pf
    cut = QUICK.estimate(standard_normal(), 3.0, rng=1, evaluator=Evaluator(max_seconds=1e-3))
    assert cut[0].status in ("failed", "doubtful")


def test_a_plateau_has_no_way_to_failure() -> None:
    steps = standard_normal(lambda x: np.where(x[:, 0] > 3.0, 1.0, 0.0))
    row = QUICK.estimate(steps, 0.5, max_evals=9_000, rng=1)[0]
    assert row.status == "doubtful"
    assert row.ci_low <= float(ndtr(-3.0)) <= row.ci_high
    assert "finds no way to failure" in row.message
