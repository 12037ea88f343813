"""The named cases."""

import pytest

from uqfold.comparison import available_cases, named_case


@pytest.mark.parametrize("name", ["folding-wing", "series", "four-bar"])
def test_a_case_builds_its_problem_with_criteria_and_references(name: str) -> None:
    case = named_case(name)
    problem = case.problem()
    assert problem.name == case.name == name
    assert problem.default_criteria is not None
    assert problem.references is not None


def test_the_case_without_references_has_criteria() -> None:
    problem = named_case("folding-wing-random-lengths").problem()
    assert problem.name == "folding-wing-random-lengths"
    assert problem.default_criteria is not None
    assert problem.references is None


def test_budgets_suit_the_cost_of_the_model() -> None:
    budgets = {name: case.max_evals for name, case in available_cases().items()}
    assert budgets == {
        "folding-wing": 40_000,
        "folding-wing-random-lengths": 40_000,
        "series": 2_000_000,
        "four-bar": 2_000_000,
    }


def test_an_unknown_case_is_refused_with_the_choices() -> None:
    with pytest.raises(
        ValueError,
        match="name = 'wing': choose from 'folding-wing', 'folding-wing-random-lengths', 'ser",
    ):
        named_case("wing")
