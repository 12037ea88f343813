"""Problems with a name."""

import pickle
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from uqfold.comparison import available_problems, named_problem


@pytest.fixture(autouse=True)
def _modules_as_before(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield
    for name in ("my_problem", "with_neighbour", "beside_it", "bad"):
        sys.modules.pop(name, None)


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
    assert (
        budgets.items()
        >= {
            "folding-wing": 40_000,
            "folding-wing-random-lengths": 40_000,
            "series": 2_000_000,
            "four-bar": 2_000_000,
        }.items()
    )


def test_an_unknown_name_is_refused_with_the_choices() -> None:
    with pytest.raises(
        ValueError,
        match=r"name = 'wing': choose from 'folding-wing', .*'series', 'four-bar'",
    ):
        named_problem("wing")


def test_a_file_of_ones_own_is_a_problem_too(tmp_path: Path) -> None:
    file = tmp_path / "my_problem.py"
    file.write_text("import uqfold\n\n\ndef mine():\n    return uqfold.problems.series()\n")
    own = named_problem(f"{file}:mine")
    assert (own.name, own.max_evals, own.problem().name) == ("my_problem-mine", 100_000, "series")
    with pytest.raises(ValueError, match="has no function 'other'"):
        named_problem(f"{file}:other")
    with pytest.raises(ValueError, match=r"there is no file nowhere\.py"):
        named_problem("nowhere.py:mine")


def test_a_file_finds_its_neighbours_as_when_python_runs_it(tmp_path: Path) -> None:
    (tmp_path / "beside_it.py").write_text("def model(x):\n    return x[:, 0]\n")
    file = tmp_path / "with_neighbour.py"
    file.write_text(
        "import uqfold\nfrom scipy import stats\nfrom beside_it import *\n\n"
        "def problem():\n    return uqfold.Problem(model, individual={'a': stats.norm(0, 1)})\n"
    )
    problem = named_problem(f"{file}:problem").problem()
    assert problem.model.__module__ == "beside_it"
    assert pickle.loads(pickle.dumps(problem.model)) is problem.model
    assert sys.path[0] == str(tmp_path)  # other processes take it over


NO_FACTORY = "must be a function without arguments that returns a uqfold.Problem, but "


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def given(x):\n    return x", f"bad.py: given {NO_FACTORY}missing a required argument"),
        ("given = 3", f"bad.py: given {NO_FACTORY}3 is not a callable object"),
        ("def given():\n    return 3", f"bad.py: given {NO_FACTORY}it returns int"),
        ("def given():\n\n    return 1 / 0", "bad.py, line 3: ZeroDivisionError: division by"),
        ("import sys\nsys.exit('no\\nlicence')", "bad.py, line 2: SystemExit: no licence"),
        ("import nowhere_at_all", "bad.py, line 1: ModuleNotFoundError: No module named"),
        ("\ndef (:", "bad.py, line 2: SyntaxError: invalid syntax"),
    ],
)
def test_what_a_file_does_wrong_is_told_in_one_line(text: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.py"
    file.write_text(text + "\n")
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        named_problem(f"{file}:given").problem()
    assert "\n" not in str(caught.value)


def test_a_file_without_a_function_is_told_how_to_give_one() -> None:
    with pytest.raises(ValueError, match=r"give FILE\.py:FUNCTION, as in m\.py:problem"):
        named_problem("m.py")
