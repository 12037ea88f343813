"""A joint distribution is taken apart: analytic where it can be, in any order, and never a hang."""

import math
import time
from types import SimpleNamespace
from typing import Any

import numpy as np
import openturns as ot
import pytest

from uqfold import Problem
from uqfold.evaluation import Evaluator, deadline
from uqfold.inputs import joint_inputs, product_inputs
from uqfold.inputs.dependence import CopulaPart, JointPart, NormalPart
from uqfold.methods import MonteCarlo


def correlated(r: float) -> Any:
    matrix = ot.CorrelationMatrix(2)
    matrix[0, 1] = r
    return matrix


def four(*copulas: Any) -> Any:
    joint = ot.JointDistribution([ot.Normal()] * 4, ot.BlockIndependentCopula(list(copulas)))
    joint.setDescription(list("abcd"))
    return joint


def test_a_shared_input_of_a_later_block_costs_no_integration() -> None:
    # one row took more than 30 s
    joint = four(ot.NormalCopula(correlated(0.5)), ot.NormalCopula(correlated(-0.8)))
    started = time.process_time()
    inputs = joint_inputs(joint, shared=["c"])
    x = inputs.from_standard_normal(np.eye(4))
    assert time.process_time() - started < 5.0
    assert inputs.names == ("c", "a", "b", "d")
    right = np.eye(4)
    right[0, 3], right[3, 3] = -0.8, 0.6
    right[1, 2], right[2, 2] = 0.5, math.sqrt(0.75)
    np.testing.assert_allclose(x, right, atol=1e-14)
    assert inputs.conditioning == ((), (), ("a",), ("c",))
    np.testing.assert_allclose(inputs.to_standard_normal(x), np.eye(4), atol=1e-14)
    # the OpenTURNS form is analytic, too, and leads to the same inputs
    again = joint_inputs(inputs.distribution)
    np.testing.assert_allclose(again.from_standard_normal(np.eye(4)), x, atol=1e-14)


def test_pairs_of_any_copula_stay_pairs_in_any_order() -> None:
    inputs = joint_inputs(four(ot.ClaytonCopula(2.0), ot.GumbelCopula(3.0)), shared=["d", "b"])
    assert inputs.names == ("d", "b", "a", "c")
    u = np.random.default_rng(0).standard_normal((200, 4))
    x = inputs.from_standard_normal(u)
    # both copulas are symmetric, so that each pair may be drawn by itself
    for copula, pair in ((ot.ClaytonCopula(2.0), [1, 2]), (ot.GumbelCopula(3.0), [0, 3])):
        alone = joint_inputs(ot.JointDistribution([ot.Normal()] * 2, copula))
        np.testing.assert_allclose(x[:, pair], alone.from_standard_normal(u[:, pair]), rtol=1e-12)
    other = u.copy()
    other[:, 2:] = 0.3
    np.testing.assert_array_equal(inputs.from_standard_normal(other)[:, :2], x[:, :2])
    reordered = joint_inputs(inputs.distribution)
    assert all(isinstance(part, CopulaPart) for part in reordered.parts.dependent)
    np.testing.assert_array_equal(reordered.from_standard_normal(u), x)


def test_a_block_of_one_is_free() -> None:
    copula = ot.BlockIndependentCopula(
        [ot.IndependentCopula(1), ot.ClaytonCopula(2.0), ot.IndependentCopula(1)]
    )
    inputs = joint_inputs(ot.JointDistribution([ot.Normal()] * 4, copula), shared=["X3", "X2"])
    assert [part.columns for part in inputs.parts.dependent] == [(1, 3)]
    u = np.random.default_rng(0).standard_normal((20, 4))
    np.testing.assert_allclose(inputs.from_standard_normal(u)[:, :3], u[:, :3], atol=1e-14)


def test_uncorrelated_normals_come_apart() -> None:
    matrix = ot.CorrelationMatrix(5)
    matrix[0, 3], matrix[1, 4] = 0.5, 0.2
    inputs = joint_inputs(ot.Normal([0.0] * 5, [1.0] * 5, matrix))
    assert [part.columns for part in inputs.parts.dependent] == [(0, 3), (1, 4)]
    assert all(isinstance(part, NormalPart) for part in inputs.parts.dependent)


WHOLE = {
    "student": ot.Student(4.0, [1.0, 2.0], [1.0, 3.0], correlated(0.5)),
    "mixture": ot.Mixture(
        [ot.Normal([0, 0], [1, 1], correlated(0.3)), ot.Normal([3, 1], [1, 2], correlated(-0.3))]
    ),
    "kernels": ot.KernelSmoothing().build(ot.Normal(2).getSample(30)),
}


@pytest.mark.parametrize("name", list(WHOLE))
def test_a_joint_without_a_copula_of_its_own_is_kept_whole(name: str) -> None:
    whole = WHOLE[name]
    inputs = product_inputs(whole, {"free": ot.Gumbel()}, names=["p", "q", "free"])
    assert isinstance(inputs.parts.dependent[0], JointPart)
    u = np.random.default_rng(0).standard_normal((20, 3))
    x = inputs.from_standard_normal(u)
    own = ot.Function(ot.InverseRosenblattEvaluation(ot.Distribution(whole)))
    np.testing.assert_array_equal(x[:, :2], np.array(own(ot.Sample(u[:, :2]))))
    np.testing.assert_allclose(inputs.to_standard_normal(x), u, atol=1e-5)
    density = np.array(ot.Distribution(whole).computeLogPDF(x[:, :2])).ravel()
    np.testing.assert_allclose(inputs.log_density(x)[0], density)
    # other moments of one marginal leave the copula as it is
    moved = inputs.with_moments(means={"p": 9.0})
    y = moved.from_standard_normal(u)
    np.testing.assert_allclose(y[:, 0] - 9.0, x[:, 0] - inputs.means[0], atol=1e-5)
    np.testing.assert_array_equal(y[:, 1], x[:, 1])
    np.testing.assert_allclose(moved.log_density(y)[0], density, atol=1e-4)


def test_density_splits_into_shared_and_individual() -> None:
    joint = four(ot.NormalCopula(correlated(0.5)), ot.ClaytonCopula(2.0))
    inputs = joint_inputs(joint, shared=["c", "b"])
    x = np.random.default_rng(0).standard_normal((10, 4))
    shared, individual = inputs.log_density(x)
    np.testing.assert_allclose(shared, -0.5 * (x[:, :2] ** 2).sum(axis=1) - math.log(2 * math.pi))
    columns = x[:, [2, 1, 0, 3]]  # back to a, b, c, d
    np.testing.assert_allclose(
        shared + individual, np.array(joint.computeLogPDF(columns)).ravel(), rtol=1e-9
    )


def test_normal_copulas_keep_their_tails() -> None:
    joint = ot.JointDistribution(
        [ot.Exponential(1.0), ot.Normal()], ot.NormalCopula(correlated(0.5))
    )
    x = joint_inputs(joint).from_standard_normal(np.array([[9.0, 0.0]]))
    # exp(-x) = Phi(-9); a probability formed as 1 - p ends at 1e-16
    assert x[0, 0] == pytest.approx(43.628, abs=1e-3)
    assert x[0, 1] == pytest.approx(4.5, rel=1e-12)


def test_a_singular_correlation_is_refused() -> None:
    matrix = ot.CorrelationMatrix(2)
    matrix[0, 1] = 1.0
    with pytest.raises((ValueError, TypeError), match="definite"):
        joint_inputs(ot.Normal([0.0, 0.0], [1.0, 1.0], matrix))


def test_a_time_limit_ends_the_drawing_of_slow_inputs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every time limit holds while inputs are drawn: by a clock that only the input moves."""
    calls = []
    clock = SimpleNamespace(monotonic=lambda: 1e-3 * len(calls))
    monkeypatch.setattr(deadline, "time", clock)

    class Slow(ot.PythonDistribution):
        def __init__(self) -> None:
            super().__init__(1)

        def getRange(self) -> Any:
            return ot.Interval(0.0, 1.0)

        def computeCDF(self, x: Any) -> float:
            calls.append(x[0])
            return min(max(x[0], 0.0), 1.0)

    inputs = {"x": ot.Distribution(Slow())}
    problem = Problem.from_limit_state(lambda x: 0.5 - x[:, 0], inputs)
    calls.clear()
    evaluator = Evaluator(max_seconds=0.5)
    row = MonteCarlo(systems=1_000_000).estimate(problem, rng=1, evaluator=evaluator)[0]
    assert "limit" in row.message
    # a whole block of systems asked for more than 8,000
    assert 500 <= len(calls) < 2_000
