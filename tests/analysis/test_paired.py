"""Paired differences against exact answers, also of a response that is rough."""

from collections.abc import Callable

import numpy as np
import pytest

from uqfold import Problem
from uqfold.analysis import paired_differences
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import normal
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.structure import Parallel
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.typing import FloatArray

CRITERIA = (
    Criterion(9.5, None, 2),
    Criterion(12.0, None, 10),
    Criterion(14.0, None, 2),
    Criterion(12.5, 3.0, Binomial(10, 0.7)),
    Criterion(16.0, 4.0, Binomial(10, 0.7)),
)
SMALL, LARGE = 0.002, 0.02


def smooth(x: FloatArray) -> FloatArray:
    return 10.0 + 0.3 * x[:, 0] + 0.6 * x[:, 1] + 0.8 * x[:, 2] + x[:, 3]


def rough(x: FloatArray) -> FloatArray:
    """A scatter in the changed input that is as large as what its spread does."""
    return smooth(x) + 0.02 * np.sin(1e5 * x[:, 3])


def problem(
    std: float, model: Callable[[FloatArray], FloatArray] = smooth, **more: object
) -> Problem:
    individual = {"U": normal(0.0, 1.0), "W": normal(0.0, 1.0), "C": normal(0.0, std)}
    return Problem(
        model,
        shared={"V": normal(0.0, 1.0)},
        individual=individual,
        units=3,
        **more,  # type: ignore[arg-type]
    )


def exact(criterion: Criterion, std: float, noise: float = 0.0) -> float:
    own = float(np.sqrt(1.0 + std**2 + noise**2))
    return LinearNormalSystem(individual_std=own).pf(criterion)


@pytest.mark.parametrize(
    ("model", "noise", "criteria", "draws"),
    [
        (smooth, 0.0, CRITERIA[:3], 60),
        (smooth, 0.0, CRITERIA[3:], 16),
        (rough, 0.02 / np.sqrt(2.0), CRITERIA[:3], 60),
    ],
)
def test_differences_of_parts_in_a_million_are_those_of_exact_answers(
    model: Callable[[FloatArray], FloatArray],
    noise: float,
    criteria: tuple[Criterion, ...],
    draws: int,
) -> None:
    found = paired_differences(problem(SMALL, model), problem(LARGE, model), criteria, draws, rng=3)
    assert (found.changed, found.n_evals) == ("C", draws * 52 + 4)
    for row, criterion in zip(found.rows, criteria, strict=True):
        gain = exact(criterion, LARGE, noise) - exact(criterion, SMALL, noise)
        assert abs(row.difference - gain) < 4.0 * row.std_error
        if model is smooth:
            # counting failures in as many runs would be a thousand times too coarse
            assert row.std_error < abs(gain) < 1e-3


def test_a_seed_repeats_and_problems_in_the_other_order_differ_by_the_sign() -> None:
    first, second = problem(SMALL), problem(LARGE)
    one = paired_differences(first, second, CRITERIA[:2], 10, rng=5)
    assert one == paired_differences(first, second, CRITERIA[:2], 10, rng=one.seed)
    other = paired_differences(second, first, CRITERIA[:2], 10, rng=5)
    for row, mirrored in zip(one.rows, other.rows, strict=True):
        assert row.difference == pytest.approx(-mirrored.difference, rel=1e-9)
    frame = one.to_frame()
    assert frame["missions"].tolist() == ["2", "10"]
    assert frame["pf_other"].sub(frame["pf"]).to_numpy() == pytest.approx(frame["difference"])


def test_what_it_cannot_compare_is_refused_before_any_run() -> None:
    first, second = problem(SMALL), problem(LARGE)
    with pytest.raises(ValueError, match="differ: none; give two"):
        paired_differences(first, first, CRITERIA)
    with pytest.raises(ValueError, match="draws = 1"):
        paired_differences(first, second, CRITERIA, 1)
    with pytest.raises(ValueError, match="exchangeable"):
        paired_differences(first, problem(LARGE, structure=Parallel()), CRITERIA)
    with pytest.raises(TypeError, match="give a Problem"):
        paired_differences(first, "second", CRITERIA)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="the same inputs"):
        paired_differences(first, LinearNormalSystem().problem(), CRITERIA)
    with pytest.raises(TypeError, match="evaluator = 42"):
        paired_differences(first, second, CRITERIA, evaluator=42)  # type: ignore[arg-type]
    with pytest.raises(BudgetExceededError):
        paired_differences(first, second, CRITERIA, max_evals=1_000)


def test_a_response_that_does_not_rise_along_the_lines_is_refused() -> None:
    def bent(x: FloatArray) -> FloatArray:
        return smooth(x) - 0.3 * x[:, 1] ** 2

    with pytest.raises(ValueError, match="does not rise steadily"):
        paired_differences(problem(SMALL, bent), problem(LARGE, bent), CRITERIA, 4, rng=0)
    with pytest.raises(ValueError, match="infinite or failed"):
        paired_differences(
            problem(SMALL, lambda x: np.where(x[:, 1] > 3.0, np.inf, smooth(x))),
            problem(LARGE, lambda x: np.where(x[:, 1] > 3.0, np.inf, smooth(x))),
            CRITERIA,
            4,
            rng=0,
        )
