"""What a result shows in a terminal and in a notebook."""

import numpy as np
import openturns as ot
import pytest

import uqfold
from uqfold.analysis import chaos_sobol, design_threshold
from uqfold.methods import ReliabilityResult


@pytest.fixture(scope="module")
def result() -> ReliabilityResult:
    method = uqfold.methods.build("ffni-spa")
    grid = uqfold.criteria([2.0, 9.0], missions=[1, 5])
    return method.estimate(uqfold.problems.series(), grid)


def test_a_result_prints_as_a_short_table(result: ReliabilityResult) -> None:
    """Printing one used to write out all that its surface was made of."""
    head, columns, *rows = str(result).splitlines()
    assert head.startswith(f"ReliabilityResult: ffni-spa, {result.n_evals} evaluations, ")
    assert "tau" not in columns
    assert "missions" in columns
    pf = columns.split().index("pf")
    assert [float(row.split()[pf + 1]) for row in rows[:4]] == pytest.approx(
        list(result.pf), rel=1e-3
    )
    assert len(str(result)) < 1500
    assert "rows 1, 3: " in str(result)


def test_a_notebook_shows_a_result_as_a_table(result: ReliabilityResult) -> None:
    """With what was said about its rows below."""
    html = result._repr_html_()
    assert html.count("<tr") == 1 + len(result)
    assert result[1].message
    assert "<p>rows 1, 3: " in html


def test_text_of_a_model_is_no_part_of_the_page() -> None:
    """An error of a model may say anything."""
    problem = uqfold.Problem(_fails, inputs=ot.Normal(1))
    result = uqfold.methods.MonteCarlo().estimate(problem, uqfold.criteria(1.0), max_evals=10)
    assert "<b>no</b>" in str(result)
    assert "<b>no</b>" not in result._repr_html_()


def _fails(x: np.ndarray) -> np.ndarray:
    raise ValueError("<b>no</b>")


def test_a_limit_state_is_shown_as_one() -> None:
    """Not as the smallest number below zero."""
    problem = uqfold.Problem.from_limit_state(lambda x: 1.0 - x[:, 0], ot.Normal(1))
    result = uqfold.methods.MonteCarlo().estimate(problem, max_evals=1000)
    assert "g <= 0" in str(result)
    assert "e-324" not in str(result) + str(problem.default_criteria)


def test_answers_of_an_analysis_print_as_tables() -> None:
    """They used to print all their records, one after the other."""
    indices = chaos_sobol(uqfold.problems.series())
    lines = str(indices).splitlines()
    assert len(lines) == 2 + len(indices)
    assert indices._repr_html_().count("<tr") == 1 + len(indices)


def test_a_problem_prints_its_inputs() -> None:
    """One line for each, with its unit where it has one."""
    problem = uqfold.problems.folding_wing()
    head, columns, *rows = str(problem).splitlines()
    assert head == "folding-wing: deployment time (s), 4 units, Series()"
    assert columns.split() == ["input", "unit", "shared", "distribution", "mean", "std"]
    assert [row.split()[0] for row in rows] == list(problem.inputs.names)
    assert problem._repr_html_().count("<tr") == 1 + len(rows)


def test_a_design_does_not_print_its_curve() -> None:
    """Its answer used to stand among hundreds of numbers."""
    surface = uqfold.methods.PolynomialChaos(runs=20)
    design = design_threshold(uqfold.problems.series(), 0.01, (1.5, 4.0), method=surface)
    assert len(repr(design)) < 1000
