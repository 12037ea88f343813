"""The joint distribution: order of the inputs, Rosenblatt transformation, tails, sampling."""

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import openturns as ot
import pytest
from scipy import stats
from scipy.special import ndtr, ndtri

from uqfold.inputs import JointInputs, joint_inputs, normal, product_inputs
from uqfold.inputs.gauss import gauss_rule

LIMIT = 4.5  # standard errors


def named(distribution: Any, *names: str) -> Any:
    distribution.setDescription(list(names))
    return distribution


def clayton(theta: float = 2.0) -> Any:
    """Load and speed, linked by a Clayton copula."""
    marginals = [ot.Normal(10, 2), ot.LogNormal(0, 0.3)]
    return named(ot.JointDistribution(marginals, ot.ClaytonCopula(theta)), "load", "speed")


def cdf(inputs: JointInputs, column: int, x: np.ndarray) -> np.ndarray:
    """Distribution function of one marginal at a column of rows."""
    values = inputs.marginals[column].computeCDF(ot.Sample(x[:, [column]]))
    return np.array(values, dtype=np.float64).ravel()


def test_inputs_of_another_problem_are_taken_as_they_are() -> None:
    """Another structure of the same units could not be asked for without writing all anew."""
    first = product_inputs({"v": normal(5, 1)}, {"a": stats.expon(scale=2.0)})
    again = joint_inputs(first)
    assert again.names == first.names
    assert again.n_shared == 1
    assert again.parts is first.parts
    assert joint_inputs(first, names=["x", "y"]).names == ("x", "y")
    assert joint_inputs(first, ["v"]).n_shared == 1
    for shared, names in ((["a"], None), ([], ["x"])):
        with pytest.raises(ValueError, match="it says itself how many"):
            joint_inputs(first, shared, names)


def test_product_of_named_blocks() -> None:
    inputs = product_inputs({"v": normal(5, 1)}, {"a": normal(0, 1), "b": ot.Uniform(1, 2)})
    assert inputs.names == ("v", "a", "b")
    assert (inputs.dimension, inputs.n_shared, inputs.n_individual) == (3, 1, 2)
    assert inputs.shared_names == ("v",)
    assert inputs.individual_names == ("a", "b")
    assert inputs.independent
    assert [m.getMean()[0] for m in inputs.marginals] == [5.0, 0.0, 1.5]
    assert repr(inputs) == "JointInputs(shared: v; individual: a, b)"
    assert repr(product_inputs(None, normal(0, 1))) == "JointInputs(shared: none; individual: X0)"


def test_blocks_keep_their_own_dependence_only() -> None:
    inputs = product_inputs(clayton(), {"a": normal(0, 1)})
    assert inputs.names == ("load", "speed", "a")
    assert inputs.n_shared == 2
    assert not inputs.independent
    x = inputs.sample(np.random.default_rng(0), 20_000)
    tau, _ = stats.kendalltau(x[:, 0], x[:, 1])
    error = math.sqrt(2 * (2 * 20_000 + 5) / (9 * 20_000 * 19_999))  # of tau at independence
    # Kendall's tau of the Clayton copula is theta / (theta + 2)
    assert abs(tau - 0.5) < LIMIT * error
    for column in (0, 1):
        assert abs(stats.kendalltau(x[:, column], x[:, 2])[0]) < LIMIT * error


def test_components_that_nobody_named() -> None:
    assert product_inputs(ot.Normal(2), ot.Normal(1)).names == ("x1", "x2", "x3")
    assert product_inputs(None, ot.Normal(2)).names == ("X0", "X1")
    assert product_inputs({"v": normal(0, 1)}, ot.Normal(1)).names == ("v", "X0")


def test_a_name_given_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="input 'a' is named twice"):
        product_inputs({"a": normal(0, 1)}, {"a": normal(0, 1)})
    with pytest.raises(ValueError, match="name each once"):
        product_inputs(normal(0, 1), normal(0, 1), names=["a", "a"])


def test_joint_form_moves_the_shared_inputs_to_the_front() -> None:
    correlation = ot.CorrelationMatrix(3)
    correlation[0, 2] = 0.6
    correlation[0, 1] = -0.3
    joint = named(
        ot.JointDistribution(
            [ot.Normal(), ot.Gumbel(), ot.Uniform()], ot.NormalCopula(correlation)
        ),
        "a",
        "b",
        "c",
    )
    inputs = joint_inputs(joint, ["c", "b"])
    assert inputs.names == ("c", "b", "a")
    assert inputs.n_shared == 2
    x = inputs.sample(np.random.default_rng(1), 50_000)
    # back to normal scores, whose correlations are those of the copula, reordered
    scores = np.column_stack([ndtri(cdf(inputs, i, x)) for i in range(3)])
    expected = np.array([[1, 0, 0.6], [0, 1, -0.3], [0.6, -0.3, 1]])
    error = (1 - expected**2) / math.sqrt(len(x))
    assert np.all(np.abs(np.corrcoef(scores.T) - expected) <= LIMIT * error + 1e-12)
    unchanged = joint_inputs(joint, ["a", "b"])
    assert unchanged.names == ("a", "b", "c")


def test_names_given_instead_of_those_of_the_distribution() -> None:
    inputs = joint_inputs(ot.Normal(3), ["width"], names=["speed", "width", "force"])
    assert inputs.names == ("width", "speed", "force")


@pytest.mark.parametrize(
    ("shared", "names", "message"),
    [
        (["z"], None, r"shared input 'z' is not one of the inputs \['load', 'speed'\]"),
        (["load", "load"], None, "name each once"),
        ([], ["a"], "1 names for 2 inputs"),
        ([], ["a", "a"], "name each once"),
    ],
)
def test_wrong_names_are_refused(shared: list[str], names: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        joint_inputs(clayton(), shared, names)


@pytest.mark.parametrize("shared", ["load", "speed"])
def test_first_standard_normals_alone_determine_the_shared_inputs(shared: str) -> None:
    inputs = joint_inputs(clayton(), [shared])
    rng = np.random.default_rng(0)
    u = rng.standard_normal((200, 2))
    x = inputs.from_standard_normal(u)
    other = np.column_stack([u[:, 0], rng.standard_normal(200)])
    np.testing.assert_array_equal(inputs.from_standard_normal(other)[:, 0], x[:, 0])
    # and they have the shared marginal
    np.testing.assert_allclose(cdf(inputs, 0, x), ndtr(u[:, 0]), rtol=1e-12)
    # while the individual input does depend on the shared one
    moved = np.column_stack([u[:, 0] + 0.5, u[:, 1]])
    assert np.abs(inputs.from_standard_normal(moved)[:, 1] - x[:, 1]).min() > 1e-4


@pytest.mark.parametrize("shared", ["load", "speed"])
@pytest.mark.parametrize("theta", [0.5, 2.0, 8.0])
def test_individual_inputs_follow_their_conditional_distribution(shared: str, theta: float) -> None:
    inputs = joint_inputs(clayton(theta), [shared])
    u = np.random.default_rng(0).standard_normal((300, 2))
    x = inputs.from_standard_normal(u)
    a, b = cdf(inputs, 0, x), cdf(inputs, 1, x)
    # P(B <= b | A = a) of the Clayton copula; it has to be the second uniform variable
    conditional = a ** (-theta - 1) * (a**-theta + b**-theta - 1) ** (-1 / theta - 1)
    np.testing.assert_allclose(conditional, ndtr(u[:, 1]), rtol=1e-7)


def test_two_shared_and_two_individual_inputs_of_one_copula() -> None:
    correlation = ot.CorrelationMatrix(4)
    for i in range(4):
        for j in range(i):
            correlation[i, j] = 0.5
    joint = named(ot.JointDistribution([ot.Normal()] * 4, ot.NormalCopula(correlation)), *"abcd")
    inputs = joint_inputs(joint, ["d", "b"])
    assert inputs.names == ("d", "b", "a", "c")
    u = np.random.default_rng(3).standard_normal((100, 4))
    x = inputs.from_standard_normal(u)
    v = u.copy()
    v[:, 2:] = np.random.default_rng(4).standard_normal((100, 2))
    np.testing.assert_array_equal(inputs.from_standard_normal(v)[:, :2], x[:, :2])
    # the Rosenblatt transformation of a normal copula is its Cholesky factor
    root = np.linalg.cholesky(0.5 * np.eye(4) + 0.5)
    np.testing.assert_allclose(x, u @ root.T, atol=1e-9)


TAILED = [
    ot.Normal(5, 2),
    ot.LogNormal(0, 0.5),
    ot.Gumbel(1, 0),
    ot.Gamma(2, 1),
    ot.Exponential(1.0),
]


@pytest.mark.parametrize("marginal", TAILED, ids=lambda m: m.getClassName())
def test_independent_inputs_keep_their_digits_in_both_tails(marginal: Any) -> None:
    # the last bit of a probability near one must not decide about a tail of 1e-12
    inputs = product_inputs(None, [marginal, ot.Normal()])
    assert inputs.independent
    u = np.array([-9.0, -7.0, -4.0, 4.0, 7.0, 9.0])
    x = inputs.from_standard_normal(np.column_stack([u, u]))[:, 0]
    lower = [marginal.computeCDF(value) for value in x[:3]]
    upper = [marginal.computeComplementaryCDF(value) for value in x[3:]]
    np.testing.assert_allclose(lower, ndtr(u[:3]), rtol=1e-9)
    np.testing.assert_allclose(upper, ndtr(-u[3:]), rtol=1e-9)


def test_dependent_inputs_are_good_to_tails_of_a_billionth() -> None:
    inputs = joint_inputs(clayton(), ["load"])
    u = np.array([-6.0, -3.0, 3.0, 6.0])
    x = inputs.from_standard_normal(np.column_stack([u, np.zeros(4)]))
    np.testing.assert_allclose((x[:, 0] - 10) / 2, u, rtol=1e-7)


def test_sample_has_the_marginals_and_repeats_with_its_seed() -> None:
    inputs = product_inputs({"v": ot.Gumbel(2, 1)}, {"a": ot.Uniform(0, 3), "b": normal(1, 2)})
    x = inputs.sample(np.random.default_rng(7), 20_000)
    assert x.shape == (20_000, 3)
    for column in range(3):
        assert stats.kstest(cdf(inputs, column, x), "uniform").pvalue > 1e-4
    np.testing.assert_array_equal(x, inputs.sample(np.random.default_rng(7), 20_000))
    assert not np.array_equal(x, inputs.sample(np.random.default_rng(8), 20_000))


def test_sampling_leaves_the_global_generator_of_openturns_alone() -> None:
    ot.RandomGenerator.SetSeed(11)
    expected = ot.RandomGenerator.Generate()
    ot.RandomGenerator.SetSeed(11)
    joint_inputs(clayton(), ["load"]).sample(np.random.default_rng(0), 100)
    assert ot.RandomGenerator.Generate() == expected


@pytest.mark.parametrize("inputs", [product_inputs(None, ot.Normal(2)), joint_inputs(clayton())])
def test_shapes_of_standard_normal_rows(inputs: JointInputs) -> None:
    assert inputs.from_standard_normal(np.empty((0, 2))).shape == (0, 2)
    assert inputs.from_standard_normal(np.zeros((1, 2))).shape == (1, 2)
    assert inputs.from_standard_normal([[0, 1], [1, 0]]).dtype == np.float64  # type: ignore[arg-type]
    for wrong in (np.zeros(2), np.zeros((3, 1)), np.zeros((2, 3)), np.zeros((1, 2, 2))):
        with pytest.raises(ValueError, match=r"^u = .*: give real numbers of shape \(n, 2\)"):
            inputs.from_standard_normal(wrong)


def test_gauss_rule_of_a_column() -> None:
    inputs = product_inputs({"v": normal(5, 1)}, {"a": ot.Uniform(0, 1)})
    for column, marginal in enumerate([ot.Normal(5, 1), ot.Uniform(0, 1)]):
        for got, expected in zip(
            inputs.gauss_rule(column, 4), gauss_rule(marginal, 4), strict=True
        ):
            np.testing.assert_array_equal(got, expected)


@pytest.mark.parametrize(
    ("mean", "std"),
    [(0, 0), (0, -1), (math.nan, 1), (0, math.nan), (math.inf, 1), (0, math.inf)],
)
def test_impossible_normals_are_refused(mean: float, std: float) -> None:
    with pytest.raises(ValueError, match=r"(mean|std) = .*: give a (finite|positive) number"):
        normal(mean, std)


def test_inputs_survive_pickling() -> None:
    inputs = joint_inputs(clayton(), ["speed"])
    u = np.random.default_rng(0).standard_normal((5, 2))
    before = inputs.from_standard_normal(u)
    again = pickle.loads(pickle.dumps(inputs))
    assert again.names == inputs.names
    np.testing.assert_array_equal(again.from_standard_normal(u), before)


@pytest.mark.parametrize(
    "inputs",
    [
        product_inputs({"v": normal(5, 1)}, {"a": ot.Uniform(1, 2), "b": ot.Gumbel(1.0, 2.0)}),
        joint_inputs(clayton(), shared=["speed"]),
    ],
    ids=["independent", "clayton"],
)
def test_transformation_there_and_back(inputs: JointInputs) -> None:
    u = np.random.default_rng(5).standard_normal((200, inputs.dimension))
    back = inputs.to_standard_normal(inputs.from_standard_normal(u))
    np.testing.assert_allclose(back, u, atol=1e-8)
    with pytest.raises(ValueError, match=r"^x = .*: give real numbers of shape"):
        inputs.to_standard_normal(u[:, :1])


def test_normal_inputs_transform_exactly_far_out() -> None:
    inputs = product_inputs({"v": normal(5, 2)}, None)
    u = inputs.to_standard_normal(np.array([[5 + 2 * 30.0]]))
    assert u[0, 0] == pytest.approx(30.0, rel=1e-14)


def test_values_beyond_a_bound_have_infinite_normal_variables() -> None:
    inputs = product_inputs({"v": ot.Uniform(1, 2)}, {"a": normal(0, 1)})
    u = inputs.to_standard_normal(np.array([[0.9, 0.0], [2.1, 0.0], [1.5, 3.0]]))
    np.testing.assert_allclose(u, [[-np.inf, 0.0], [np.inf, 0.0], [0.0, 3.0]], atol=1e-12)
    low, high = inputs.bounds
    assert (low.tolist(), high.tolist()) == ([1.0, -np.inf], [2.0, np.inf])


def test_default_names_alone_are_replaced() -> None:
    # two distributions that nobody named are both called X0
    assert product_inputs(ot.Normal(), ot.Normal()).names == ("x1", "x2")
    assert product_inputs([ot.Normal()], ot.Normal(2)).names == ("x1", "x2", "x3")


@pytest.mark.parametrize(
    ("shared", "individual"),
    [
        ({"X0": ot.Normal()}, ot.Normal()),
        (ot.Normal(), {"X0": ot.Normal()}),
        ({"X0": ot.Normal()}, {"X0": ot.Normal()}),
        (named(ot.Normal(2), "X0", "speed"), ot.Normal()),
    ],
)
def test_a_name_given_by_hand_is_never_replaced(shared: Any, individual: Any) -> None:
    with pytest.raises(ValueError, match=r"input 'X0' is named twice: .*names="):
        product_inputs(shared, individual)
    count = 1 + len(product_inputs(shared, None).names)
    given = [f"n{i}" for i in range(count)]
    assert product_inputs(shared, individual, given).names == tuple(given)


def test_names_are_text() -> None:
    with pytest.raises(TypeError, match=r"names of inputs\[0\] = 1: give text"):
        product_inputs(None, {1: ot.Normal()})


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs /proc")
def test_drawing_again_and_again_takes_no_more_memory() -> None:
    def resident() -> float:
        status = Path("/proc/self/status").read_text().splitlines()
        [line] = [line for line in status if line.startswith("VmRSS")]
        return int(line.split()[1]) / 1024

    inputs = product_inputs(None, [ot.Normal()] * 20)
    u = np.random.default_rng(0).standard_normal((4096, 20))
    inputs.from_standard_normal(u)
    before = resident()
    for _ in range(40):  # 26 MB of numbers; each was once kept eight times over
        inputs.from_standard_normal(u)
    assert resident() - before < 20.0
