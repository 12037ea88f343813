"""Marginals with other moments: the family stays where moments determine it."""

from typing import Any

import openturns as ot
import pytest

from uqfold.inputs import joint_inputs, product_inputs
from uqfold.inputs.moments import finite_moments as moments
from uqfold.inputs.moments import with_moments

KEPT = [
    ot.Normal(1.0, 2.0),
    ot.LogNormal(0.0, 0.3, 0.5),
    ot.Gamma(2.0, 3.0, 1.0),
    ot.WeibullMin(2.0, 3.0, 1.0),
    ot.Beta(2.0, 3.0, -4.0, 4.0),
]
STRETCHED = [ot.Uniform(0.0, 1.0), ot.Gumbel(1.0, 2.0), ot.TruncatedNormal(0.0, 1.0, -2.0, 2.0)]


@pytest.mark.parametrize("marginal", KEPT + STRETCHED, ids=lambda m: m.getClassName())
def test_the_result_has_the_moments_asked_for(marginal: Any) -> None:
    mean, std = moments(marginal)
    made = with_moments(marginal, mean + 0.1 * std, 1.1 * std)
    assert moments(made) == pytest.approx((mean + 0.1 * std, 1.1 * std), rel=1e-8)
    same = with_moments(marginal, mean, std)
    for level in (1e-6, 0.3, 1.0 - 1e-6):
        expected = marginal.computeQuantile(level)[0]
        assert same.computeQuantile(level)[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("marginal", KEPT[1:], ids=lambda m: m.getClassName())
def test_a_family_with_bounds_keeps_them(marginal: Any) -> None:
    mean, std = moments(marginal)
    made = with_moments(marginal, mean + 0.1 * std, 1.1 * std)
    assert made.getImplementation().getClassName() == marginal.getClassName()
    before, after = marginal.getRange(), made.getRange()
    assert after.getLowerBound()[0] == pytest.approx(before.getLowerBound()[0], abs=1e-12)
    assert after.getFiniteUpperBound()[0] == before.getFiniteUpperBound()[0]


def test_any_other_marginal_is_shifted_and_stretched() -> None:
    made = with_moments(ot.Uniform(0.0, 1.0), 3.0, ot.Uniform(0.0, 2.0).getStandardDeviation()[0])
    assert made.computeQuantile(0.25)[0] == pytest.approx(2.5)
    assert made.getRange().getUpperBound()[0] == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("marginal", "mean", "std", "message"),
    [
        (ot.Normal(), 0.0, 0.0, "standard deviation 0"),
        (ot.Normal(), float("nan"), 1.0, "mean nan"),
        (ot.Beta(2.0, 3.0, -4.0, 4.0), 5.0, 1.0, "cannot have mean 5"),
        (ot.LogNormal(0.0, 0.3, 0.5), 0.2, 1.0, "cannot have mean 0.2"),
        (ot.Student(1.0), 0.0, 1.0, "no finite mean"),
    ],
)
def test_impossible_moments_are_refused(
    marginal: Any, mean: float, std: float, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        with_moments(marginal, mean, std)


def test_inputs_with_other_moments() -> None:
    inputs = product_inputs({"v": ot.Normal(5, 1)}, {"a": ot.Normal(0, 1), "b": ot.Uniform(1, 2)})
    changed = inputs.with_moments(means={"v": 6.0}, standard_deviations={"b": 0.1})
    assert changed.names == inputs.names
    assert changed.n_shared == 1
    assert changed.means.tolist() == pytest.approx([6.0, 0.0, 1.5])
    assert changed.standard_deviations.tolist() == pytest.approx([1.0, 1.0, 0.1])
    with pytest.raises(ValueError, match=r"means = .*'k' is not one of the inputs \['v'"):
        inputs.with_moments(means={"k": 1.0})


def test_dependence_stays() -> None:
    joint = ot.JointDistribution([ot.Normal(5, 1), ot.Normal(0, 1)], ot.ClaytonCopula(2.0))
    changed = joint_inputs(joint).with_moments(means={"X0": 7.0})
    assert changed.distribution.getCopula() == joint.getCopula()
    assert changed.means.tolist() == [7.0, 0.0]
