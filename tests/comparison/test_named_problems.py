"""Problems with a name."""

from pathlib import Path

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


def test_a_file_of_ones_own_is_a_problem_too(tmp_path: Path) -> None:
    file = tmp_path / "my_problem.py"
    file.write_text("import uqfold\n\n\ndef mine():\n    return uqfold.problems.series()\n")
    own = named_problem(f"{file}:mine")
    assert (own.name, own.max_evals, own.problem().name) == ("mine", 100_000, "series")
    with pytest.raises(ValueError, match="has no function 'other'"):
        named_problem(f"{file}:other")
    with pytest.raises(ValueError, match=r"there is no file nowhere\.py"):
        named_problem("nowhere.py:mine")
