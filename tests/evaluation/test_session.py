"""Streams, models of one sample, and the settings of the evaluator."""

import itertools
from collections.abc import Iterator

import numpy as np
import pytest

from tests.evaluation import models
from uqfold.evaluation import BudgetExceededError, Evaluator, per_sample
from uqfold.evaluation.session import EvaluationSession
from uqfold.typing import FloatArray, Model


def opened(model: Model, max_evals: int | None = None, **settings: object) -> EvaluationSession:
    return Evaluator(**settings).session(model, 2, max_evals)  # type: ignore[arg-type]


def test_a_stream_draws_blocks_only_as_they_are_needed() -> None:
    drawn: list[int] = []

    def blocks() -> Iterator[FloatArray]:
        for i in itertools.count():
            drawn.append(i)
            yield models.rows(10, seed=i)

    model = models.Counting()
    session = opened(model)
    for i, y in enumerate(session.stream(blocks())):
        np.testing.assert_array_equal(y, models.quadratic(models.rows(10, seed=i)))
        assert drawn[-1] == i
        if i == 4:
            break
    assert (session.n_evals, model.rows) == (50, 50)


def test_a_stream_gives_what_the_budget_allows_and_then_refuses() -> None:
    session = opened(models.quadratic, 25)
    taken = []
    with pytest.raises(BudgetExceededError):  # noqa: PT012 - the blocks before it count
        for y in session.stream(models.rows(10, seed=i) for i in range(3)):
            taken.append(y)
    assert len(taken) == 2
    assert (session.n_evals, session.remaining) == (20, 5)


def test_a_scalar_function_is_run_row_by_row() -> None:
    calls = []

    def function(x: FloatArray) -> float:
        calls.append(x.shape)
        return models.scalar(x)

    x = models.rows(200)
    session = opened(per_sample(function))
    y = session.evaluate(x)
    # not once more because of the failures
    assert calls == [(2,)] * 200
    bad = x[:, 1] > models.FATAL
    np.testing.assert_array_equal(y[~bad], [models.scalar(row) for row in x[~bad]])
    assert np.isnan(y[bad]).all()
    assert "ArithmeticError: too far" in session.first_failure
    two = opened(per_sample(lambda x: x))
    assert np.isnan(two.evaluate(x[:1])).all()
    assert "expected one number" in two.first_failure


@pytest.mark.parametrize(
    "settings",
    [
        {"failed_runs": "ignore"},
        {"batch_rows": 0},
        {"max_seconds": 0.0},
        {"seconds_per_run": -1.0},
        {"max_seconds": float("inf")},
    ],
)
def test_settings_out_of_range_are_refused(settings: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(settings))):
        Evaluator(**settings)  # type: ignore[arg-type]


def test_what_is_no_executor_is_refused() -> None:
    with pytest.raises(TypeError, match="Processes"):
        Evaluator(executor=4)  # type: ignore[arg-type]
