"""Problems with a name."""

import pytest

from uqfold.comparison import available_problems, named_problem


@pytest.mark.parametrize("name", ["folding-wing", "series", "four-bar"])
def test_a_name_builds_its_problem_with_criteria_and_references(name: str) -> None:
    one = named_problem(name)
    problem = one.problem()
    assert problem.name == one.name == name
    assert problem.default_criteria is not None
    assert problem.references is not None


def test_the_one_without_references_has_criteria() -> None:
    problem = named_problem("folding-wing-random-lengths").problem()
    assert problem.name == "folding-wing-random-lengths"
    assert problem.default_criteria is not None
    assert problem.references is None


def test_budgets_suit_the_cost_of_the_model() -> None:
    budgets = {name: one.max_evals for name, one in available_problems().items()}
    assert budgets == {
        "folding-wing": 40_000,
        "folding-wing-random-lengths": 40_000,
        "series": 2_000_000,
        "four-bar": 2_000_000,
    }


def test_an_unknown_name_is_refused_with_the_choices() -> None:
    with pytest.raises(
        ValueError,
        match="name = 'wing': choose from 'folding-wing', 'folding-wing-random-lengths', 'ser",
    ):
        named_problem("wing")
