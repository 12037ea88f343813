"""The runs of an estimate are kept on request, whatever the method, and in bounded memory."""

import numpy as np
import pytest

from uqfold.evaluation import Evaluator
from uqfold.evaluation.samples import KeptSamples
from uqfold.inputs import normal
from uqfold.methods import available
from uqfold.problems import Problem, Unit
from uqfold.problems.criterion import Criterion
from uqfold.testing import LinearNormalSystem

SYSTEM = LinearNormalSystem()
SURFACES = {"kriging", "pce", "active-kriging", "auto"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough if name in SURFACES else [])
        for name in available()
    ],
)
def test_every_method_keeps_its_runs(name: str) -> None:
    problem = Problem(
        SYSTEM.response,
        inputs=SYSTEM.problem().inputs.distribution,
        shared=["V"],
        low_fidelity=SYSTEM.response,
    )
    method, limit = available()[name](), Criterion(12.0)
    result = method.estimate(
        problem, limit, max_evals=700, rng=3, evaluator=Evaluator(samples=True)
    )
    frame = result.samples
    assert frame is not None
    assert len(frame) == result.n_evals
    assert list(frame.columns[:5]) == ["run", *problem.inputs.names, "response"]
    x = frame[list(problem.inputs.names)].to_numpy()
    np.testing.assert_array_equal(frame["response"], SYSTEM.response(x))
    plain = method.estimate(problem, limit, max_evals=700, rng=3)
    assert plain.samples is None
    np.testing.assert_array_equal(plain.pf, result.pf)


def test_many_runs_are_thinned_out_evenly() -> None:
    kept = KeptSamples(100)
    rng = np.random.default_rng(1)
    x = rng.random((1_000, 2))
    kept.label(phase="first", weight=np.arange(300.0))
    for part in np.split(x[:300], [7, 7, 80]):
        kept.add(part, part.sum(axis=1))
    kept.label(phase="then")
    for row in x[300:]:
        kept.add(row[None], row[None, 0])
    frame = kept.frame(["a", "run"])
    every = frame.attrs["every"]
    assert 50 < len(frame) <= 100
    np.testing.assert_array_equal(frame["run"], np.arange(0, 1_000, every))
    np.testing.assert_array_equal(frame[["a", "run (input)"]], x[::every])
    first = frame[frame["phase"] == "first"]
    np.testing.assert_array_equal(first["weight"], first["run"])
    assert frame[frame["phase"] == "then"]["weight"].isna().all()


def test_weights_of_the_answer_make_the_answer() -> None:
    problem = Problem(SYSTEM.response, inputs=SYSTEM.problem().inputs.distribution, shared=["V"])
    result = available()["importance-sampling"]().estimate(
        problem, 13.0, max_evals=4_000, rng=3, evaluator=Evaluator(samples=True)
    )
    assert result.samples is not None
    answer = result.samples[result.samples["phase"] == "answer"]
    pf = float((answer["weight"] * (answer["response"] > 13.0)).mean())
    assert pf == pytest.approx(result[0].pf)


def test_systems_kinds_of_units_and_failed_runs_are_told() -> None:
    units = [
        Unit(),
        Unit(individual={"W": normal(0.0, 2.0), "X": normal(1.0, 1.0)}, model=lambda x: x[:, 1]),
    ]
    problem = Problem(
        lambda x: np.where(x[:, 0] > 1.0, np.nan, x[:, 1]),
        shared={"V": normal(0.0, 1.0)},
        individual={"U": normal(0.0, 1.0)},
        units=units,
    )
    result = available()["subset-simulation"]().estimate(
        problem, 2.0, max_evals=2_000, rng=3, evaluator=Evaluator(samples=500)
    )
    frame = result.samples
    assert frame is not None
    assert list(frame.columns[:6]) == ["run", "V", "U / W", "X", "kind of unit", "response"]
    lost = frame["response"].isna()
    np.testing.assert_array_equal(lost, (frame["V"] > 1.0) & (frame["kind of unit"] == 0.0))
    assert len(frame) <= 500


def test_a_run_that_never_was_leaves_an_empty_frame() -> None:
    result = available()["mc"]().estimate(
        SYSTEM.problem(), 12.0, max_evals=1, rng=3, evaluator=Evaluator(samples=True)
    )
    assert result[0].status == "failed"
    assert result.samples is not None
    assert result.samples.empty
