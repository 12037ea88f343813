"""What methods state of themselves, for the methods section of reports."""

import pytest

import uqfold
from uqfold.methods import ActiveKriging, Kriging, PolynomialChaos, ReliabilityMethod, available

METHODS = {
    **available(),
    **{method.name: method for method in (Kriging, PolynomialChaos, ActiveKriging)},
}


@pytest.mark.parametrize("name", METHODS)
def test_every_method_states_idea_equations_and_references(name: str) -> None:
    method: type[ReliabilityMethod] = METHODS[name]
    theory = method.theory
    assert len(theory.summary) > 100
    assert theory.equations
    assert theory.references
    for equation in theory.equations:
        assert equation.latex
        assert not equation.lead.endswith((".", ":"))
    # no two methods share one text
    others = {other.theory.summary for key, other in METHODS.items() if key != name}
    assert theory.summary not in others


def test_a_comparison_keeps_it() -> None:
    frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    (entry,) = frame.attrs["uqfold-comparison"]["methods"]
    assert entry["theory"]["equations"][1]["source"] == "Eqs. (33), (41)"
