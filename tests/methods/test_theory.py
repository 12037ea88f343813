"""What methods state of themselves, for the methods section of reports."""

import pytest

import uqfold
from tests.comparison.fakes import Quick
from uqfold.methods import ReliabilityMethod, available
from uqfold.methods.theory import Theory

METHODS = {name: method for name, method in available().items() if method.theory.summary}


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


def test_conditional_monte_carlo_says_for_which_systems_its_formula_holds() -> None:
    theory = available()["conditional-mc"].theory
    assert "In series of equal units" in theory.summary
    assert theory.equations[0].lead.startswith("In series of n equal units")
    assert theory.equations[1].lead.startswith("in all other systems")


def test_a_method_without_a_note_is_described_by_its_docstring() -> None:
    assert Theory.of(Quick).summary == "Answers at once, whatever the problem."
    assert len(METHODS) >= 9
    for method in METHODS.values():
        assert Theory.of(method) == method.theory


def test_a_comparison_keeps_it() -> None:
    frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    (entry,) = frame.attrs["uqfold-comparison"]["methods"]
    assert entry["theory"]["equations"][1]["source"] == "Eqs. (33), (41)"
