"""Importance sampling on the model, where a cheap partner says that failures are."""

from dataclasses import dataclass, replace

import numpy as np
import openturns as ot
import pytest
from scipy.special import ndtr

import uqfold
from uqfold.inputs import normal
from uqfold.methods.automatic_check import SurfaceModel
from uqfold.methods.guided_sampling import GuidedSampling
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.typing import FloatArray


def plane(x: FloatArray) -> FloatArray:
    return np.asarray((x[:, 0] + x[:, 1]) / np.sqrt(2.0))


def turned(x: FloatArray) -> FloatArray:
    """Twenty degrees off."""
    return np.asarray(0.906 * x[:, 0] + 0.423 * x[:, 1])


def either(x: FloatArray) -> FloatArray:
    return np.asarray(np.abs(plane(x)))


PROBLEM = uqfold.Problem(plane, inputs=ot.Normal(2), low_fidelity=plane, name="plane")
TRUE = float(ndtr(-4.0))
CRITERIA = uqfold.criteria(4.0)


def test_a_right_partner_leaves_hardly_an_error() -> None:
    """Three in 100,000 within a few per cent, as one more wrong verdict would have it."""
    row = GuidedSampling(refined=False).estimate(PROBLEM, CRITERIA, max_evals=1_000, rng=1)[0]
    assert row.status == "converged"
    assert 200 <= row.n_evals <= 500
    assert 0.0 < row.std_error <= 0.05 * row.pf
    assert abs(row.pf - TRUE) < 4.0 * row.std_error
    assert row.ci_low < TRUE < row.ci_high


def test_a_wrong_partner_biases_nothing() -> None:
    """Over seeds the answers scatter about the truth as they say, whatever the partner says."""
    problem = replace(PROBLEM, low_fidelity=turned)
    apart = []
    for seed in range(8):
        row = GuidedSampling().estimate(problem, CRITERIA, max_evals=3_000, rng=seed)[0]
        if row.status == "converged":
            apart.append((row.pf - TRUE) / row.std_error)
    assert len(apart) >= 4
    assert np.abs(apart).max() < 4.0
    assert abs(np.mean(apart)) < 4.0 / np.sqrt(len(apart))


def test_a_region_that_the_partner_does_not_know_is_seen_or_doubted() -> None:
    """Half of the failures lie on the other side."""
    problem = replace(PROBLEM, model=either, low_fidelity=plane)
    for seed in range(3):
        row = GuidedSampling().estimate(problem, CRITERIA, max_evals=3_000, rng=seed)[0]
        known = row.status == "converged" and row.pf == pytest.approx(2.0 * TRUE, rel=0.2)
        assert row.status in ("doubtful", "failed") or known


def test_a_climb_on_the_model_finds_what_the_partner_does_not_know() -> None:
    """Most failures lie in a ball that is nearer than the plane, where no sample of it comes."""

    def or_ball(x: FloatArray) -> FloatArray:
        away = np.linalg.norm(x - np.array([-2.5, 0.0, 0.0]), axis=1)
        return np.asarray(np.maximum(x[:, 0] - 3.5, 0.5 - away))

    def or_far(x: FloatArray) -> FloatArray:
        return np.asarray(np.maximum(x[:, 0] - 3.5, x[:, 1] - 4.0))

    inputs = {f"u{i}": normal(0.0, 1.0) for i in range(3)}
    known = uqfold.Problem(lambda x: x[:, 0] - 3.5, individual=inputs)
    asked = uqfold.criteria(0.0)
    ball = replace(known, model=or_ball, low_fidelity=known.model)
    row = GuidedSampling().estimate(ball, asked, max_evals=4_000, rng=0)[0]
    assert row.status == "failed"
    assert "failures elsewhere" in row.message
    # an eighth of them is no reason to give up, and is sampled with the others
    far = replace(known, model=or_far, low_fidelity=known.model)
    rows = [GuidedSampling().estimate(far, asked, max_evals=20_000, rng=i)[0] for i in range(4)]
    exact = -np.expm1(np.log1p(-ndtr(-3.5)) + np.log1p(-ndtr(-4.0)))
    clean = [row for row in rows if row.status == "converged"]
    assert any(abs(row.pf - exact) < 4.0 * row.std_error < 0.3 * exact for row in clean)
    # too few runs to look
    plain = replace(known, low_fidelity=known.model)
    row = GuidedSampling().estimate(plain, asked, max_evals=700, rng=0)[0]
    assert row.status == "doubtful"
    assert "too few" in row.message


@dataclass(frozen=True)
class _Pupil:
    """A partner that is right once it has seen the model."""

    taught: tuple[int, ...] = ()

    def __call__(self, x: FloatArray) -> FloatArray:
        return plane(x) if self.taught else turned(x)

    def learned(self, x: FloatArray, y: FloatArray, rng: np.random.Generator) -> "_Pupil":
        assert np.array_equal(y, plane(x))
        return _Pupil((*self.taught, len(x)))


def test_a_partner_that_can_learn_is_taught_until_it_knows() -> None:
    """One lesson of a hundred runs, and another one that finds nothing to teach."""
    problem = replace(PROBLEM, low_fidelity=_Pupil())
    result = GuidedSampling().estimate(problem, CRITERIA, max_evals=3_000, rng=1)
    row, details = result[0], result.details.sets[0]
    assert row.status == "converged"
    assert row.pf == pytest.approx(TRUE, rel=0.1)
    assert details.missed == details.invented == 0


def test_a_surface_learns_from_runs_at_its_limit() -> None:
    """A plane fitted at the centre foretells the bend further out only once it has seen it."""
    inputs = uqfold.Problem(plane, inputs=ot.Normal(2)).inputs
    rng = np.random.default_rng(1)
    u = rng.standard_normal((30, 2))
    bent = u[:, 0] + 0.1 * u[:, 1] ** 2
    first = SurfaceModel(fit_gaussian_process(u, u[:, 0] + 0.0 * bent, trend=1, rng=rng), inputs)
    new = np.column_stack([np.full(40, 3.0), np.linspace(-3.0, 3.0, 40)])
    there = new[:, 0] + 0.1 * new[:, 1] ** 2
    taught = first.learned(new, there, rng)
    assert taught is not None
    assert np.abs(first(new) - there).max() > 0.8
    assert np.abs(taught(new) - there).max() < 0.1
    assert first.learned(np.zeros((2_000, 2)), np.zeros(2_000), rng) is None


def test_a_partner_that_never_fails_leads_nowhere() -> None:
    """No run of the model is spent on it."""
    problem = replace(PROBLEM, low_fidelity=lambda x: np.minimum(plane(x), 1.0))
    row = GuidedSampling().estimate(problem, CRITERIA, max_evals=1_000, rng=1)[0]
    assert (row.status, row.n_evals) == ("failed", 0)
    assert "by the partner" in row.message


def test_failed_runs_are_bounded() -> None:
    """Both ends hold the truth."""

    def broken(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] > 3.0, np.nan, plane(x))

    problem = replace(PROBLEM, model=broken, low_fidelity=plane)
    rows = [
        GuidedSampling(refined=False).estimate(problem, CRITERIA, max_evals=500, rng=seed)[0]
        for seed in range(3)
    ]
    assert {row.status for row in rows} == {"doubtful"}
    assert sum(row.pf_low < TRUE < row.pf_high * 1.05 for row in rows) >= 2


def test_a_frequent_failure_needs_no_density() -> None:
    """It is counted, helped by the partner."""
    row = GuidedSampling().estimate(PROBLEM, uqfold.criteria(0.5), max_evals=2_000, rng=1)[0]
    assert row.status == "converged"
    assert row.n_evals <= 600
    assert abs(row.pf - ndtr(-0.5)) < 4.0 * row.std_error < 0.2 * row.pf


def test_what_it_cannot_do_is_unsupported() -> None:
    """A problem without a partner."""
    problem = uqfold.Problem(plane, inputs=ot.Normal(2))
    row = GuidedSampling().estimate(problem, CRITERIA, rng=1)[0]
    assert row.status == "unsupported"
    assert "partner" in row.message
    with pytest.raises(ValueError, match=r"target_cov = 0\.0"):
        GuidedSampling(target_cov=0.0)
