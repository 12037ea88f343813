"""The evaluator: counting per row, budget, failed runs of every kind, policies, progress."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uqfold.evaluation import (
    BudgetExceededError,
    EvaluationSession,
    Evaluator,
    FailedRunError,
)
from uqfold.testing.counting import RowCount

BATCH_ROWS = 4096  # in this process, unless the settings say otherwise
GIVE_UP_AFTER = 64  # failed runs, when there was no other


class Recorded:
    """A model that keeps the batches it was given, and apart what only shows how it is called."""

    def __init__(self, response: Callable[[np.ndarray], Any]) -> None:
        self.response = response
        self.batches: list[np.ndarray] = []
        self.count = RowCount()

    def __call__(self, x: np.ndarray) -> Any:
        if self.count.add(x):
            self.batches.append(x.copy())
        return self.response(x)

    @property
    def rows(self) -> int:
        return sum(len(batch) for batch in self.batches)


def opened(
    response: Callable[[np.ndarray], Any], max_evals: int | None = None, **settings: Any
) -> tuple[EvaluationSession, Recorded]:
    model = Recorded(response)
    return Evaluator(**settings).session(model, 2, max_evals), model


def total(x: np.ndarray) -> np.ndarray:
    return x.sum(axis=1)


def rows(n: int) -> np.ndarray:
    """Rows (i, 0.5): the first column tells them apart."""
    return np.column_stack([np.arange(n, dtype=float), np.full(n, 0.5)])


def test_every_row_counts_once() -> None:
    session, model = opened(total)
    np.testing.assert_array_equal(session.evaluate(rows(10)), np.arange(10) + 0.5)
    session.evaluate(rows(5))
    assert session.n_evals == model.rows == 15
    assert session.n_failed == 0
    assert session.first_failure == ""


def test_the_same_row_twice_is_two_runs() -> None:
    session, _ = opened(total)
    session.evaluate(np.zeros((7, 2)))
    assert session.n_evals == 7


def test_batches_do_not_change_the_answer() -> None:
    whole, _ = opened(total)
    session, model = opened(total, batch_rows=4)
    np.testing.assert_array_equal(session.evaluate(rows(10)), whole.evaluate(rows(10)))
    assert [len(batch) for batch in model.batches] == [4, 4, 2]
    np.testing.assert_array_equal(np.vstack(model.batches), rows(10))


def test_default_batches() -> None:
    session, model = opened(total)
    session.evaluate(rows(BATCH_ROWS + 1))
    assert [len(batch) for batch in model.batches] == [BATCH_ROWS, 1]


def test_no_rows_are_no_runs() -> None:
    session, model = opened(total, max_evals=0)
    assert session.evaluate(np.empty((0, 2))).shape == (0,)
    assert session.n_evals == 0
    assert model.batches == []


@pytest.mark.parametrize(
    "x", [np.zeros(2), np.zeros((3, 1)), np.zeros((3, 3)), np.zeros((1, 1, 2)), 1.0, [[1.0]]]
)
def test_rows_of_another_shape_are_refused_before_any_run(x: Any) -> None:
    session, model = opened(total)
    with pytest.raises(ValueError, match=r"^X = .*: give real numbers of shape \(n, 2\)"):
        session.evaluate(x)
    assert session.n_evals == len(model.batches) == 0


def test_nan_in_the_inputs_is_the_methods_mistake_not_a_failed_run() -> None:
    session, model = opened(total)
    x = rows(5)
    x[3, 1] = math.nan
    with pytest.raises(ValueError, match=r"row 3 of X holds NaN: \[ *3\. *nan\]"):
        session.evaluate(x)
    assert session.n_evals == session.n_failed == len(model.batches) == 0


def test_infinite_inputs_are_allowed() -> None:
    session, _ = opened(total)
    assert session.evaluate(np.array([[math.inf, 1.0]]))[0] == math.inf


def test_lists_and_transposed_arrays_are_taken() -> None:
    session, model = opened(total)
    np.testing.assert_array_equal(session.evaluate([[1, 2], [3, 4]]), [3.0, 7.0])  # type: ignore[arg-type]
    session.evaluate(np.ones((2, 6)).T)
    assert all(batch.dtype == np.float64 for batch in model.batches)


def test_a_model_that_spoils_its_argument_harms_nobody() -> None:
    def spoiling(x: np.ndarray) -> np.ndarray:
        x *= 2.0
        return x[:, 0]

    session, _ = opened(spoiling)
    x = rows(4)
    before = x.copy()
    y = session.evaluate(x)
    np.testing.assert_array_equal(x, before)
    np.testing.assert_array_equal(y, 2 * x[:, 0])


def test_a_model_that_reuses_its_answer_harms_nobody() -> None:
    buffer = np.empty(2)

    def reusing(x: np.ndarray) -> np.ndarray:
        buffer[: len(x)] = x[:, 0]
        return buffer[: len(x)]

    session, _ = opened(reusing, batch_rows=2)
    first = session.evaluate(rows(2))
    session.evaluate(rows(2) + 10.0)
    np.testing.assert_array_equal(first, [0.0, 1.0])


@pytest.mark.parametrize("kind", [int, np.float32, object, list])
def test_numbers_of_any_kind_become_float64(kind: Any) -> None:
    session, _ = opened(lambda x: list(x[:, 0]) if kind is list else x[:, 0].astype(kind))
    y = session.evaluate(rows(2))
    assert y.dtype == np.float64
    np.testing.assert_array_equal(y, [0.0, 1.0])


# Budget


def test_budget_is_kept_and_a_refused_batch_costs_nothing() -> None:
    session, model = opened(total, max_evals=10)
    assert session.remaining == 10
    session.evaluate(rows(6))
    assert session.remaining == 4
    with pytest.raises(BudgetExceededError, match=r"5 more runs .* only 4 of max_evals = 10"):
        session.evaluate(rows(5))
    assert session.n_evals == model.rows == 6
    session.evaluate(rows(4))
    assert session.remaining == 0
    with pytest.raises(BudgetExceededError):
        session.evaluate(rows(1))


def test_without_a_budget_there_is_always_room() -> None:
    session, _ = opened(total)
    assert session.remaining > 10**15


def test_failed_runs_cost_as_much_as_others() -> None:
    session, _ = opened(lambda x: np.where(x[:, 0] < 3, np.nan, 0.0), max_evals=8)
    session.evaluate(rows(8))
    assert session.remaining == 0
    assert session.n_failed == 3


# Failed runs


def test_nan_stays_open_and_infinities_are_responses() -> None:
    session, _ = opened(
        lambda x: np.choose(x[:, 0].astype(int) % 4, [1.0, np.nan, np.inf, -np.inf])
    )
    y = session.evaluate(rows(8))
    np.testing.assert_array_equal(y, [1.0, np.nan, np.inf, -np.inf] * 2)
    assert session.n_failed == 2
    assert session.first_failure == "the model returned NaN at x = [1, 0.5]"


def raising_at(*bad: int) -> Callable[[np.ndarray], np.ndarray]:
    def response(x: np.ndarray) -> np.ndarray:
        hit = np.isin(x[:, 0], bad)
        if hit.any():
            raise ArithmeticError(f"no convergence in {int(hit.sum())} rows")
        return total(x)

    return response


def test_a_row_that_raises_does_not_take_its_neighbours_along() -> None:
    session, model = opened(raising_at(3, 17))
    y = session.evaluate(rows(32))
    assert np.flatnonzero(np.isnan(y)).tolist() == [3, 17]
    good = np.delete(np.arange(32), [3, 17])
    np.testing.assert_array_equal(y[good], good + 0.5)
    assert session.n_evals == 32
    assert session.n_failed == 2
    assert session.first_failure == (
        "the model raised ArithmeticError: no convergence in 1 rows at x = [3, 0.5]"
    )
    # halving: far fewer calls than one per row
    assert len(model.batches) < 24


@settings(max_examples=50)
@given(st.integers(1, 70), st.sets(st.integers(0, 69), max_size=6), st.integers(1, 80))
def test_exactly_the_raising_rows_fail(n: int, bad: set[int], batch_rows: int) -> None:
    bad = {i for i in bad if i < n}
    if len(bad) == n:
        return
    session, _ = opened(raising_at(*bad), batch_rows=batch_rows)
    y = session.evaluate(rows(n))
    assert set(np.flatnonzero(np.isnan(y)).tolist()) == bad
    assert (session.n_evals, session.n_failed) == (n, len(bad))


def test_a_run_that_raises_has_failed() -> None:
    session, _ = opened(lambda x: 1 // 0)
    assert np.isnan(session.evaluate(rows(3))).all()
    assert session.n_failed == 3
    assert "ZeroDivisionError" in session.first_failure


def test_complex_numbers_do_not_pass_as_their_real_parts() -> None:
    session, _ = opened(lambda x: np.emath.sqrt(x[:, 0] - 1.0))
    y = session.evaluate(rows(3))
    np.testing.assert_array_equal(y, [np.nan, 0.0, 1.0])
    assert session.first_failure == "the model returned a complex number at x = [0, 0.5]"


def test_ctrl_c_passes() -> None:
    def response(x: np.ndarray) -> np.ndarray:
        raise KeyboardInterrupt

    session, model = opened(response)
    with pytest.raises(KeyboardInterrupt):
        session.evaluate(rows(8))
    assert len(model.batches) == 1


# Policies


def test_count_as_failure_makes_failed_runs_infinite() -> None:
    session, _ = opened(
        lambda x: np.where(x[:, 0] == 1, np.nan, x[:, 0]), failed_runs="count-as-failure"
    )
    np.testing.assert_array_equal(session.evaluate(rows(3)), [0.0, np.inf, 2.0])
    assert session.n_failed == 1


@pytest.mark.parametrize(
    ("response", "reason"),
    [
        (raising_at(5), r"raised ArithmeticError: .* at x = \[5, 0\.5\]"),
        (lambda x: np.where(x[:, 0] == 5, np.nan, 0.0), r"returned NaN at x = \[5, 0\.5\]"),
    ],
)
def test_raise_ends_at_the_first_failed_run(response: Any, reason: str) -> None:
    session, model = opened(response, failed_runs="raise", batch_rows=4)
    with pytest.raises(FailedRunError, match=reason):
        session.evaluate(rows(400))
    # the batch of that row was the last one
    assert max(batch[:, 0].max() for batch in model.batches) == 7.0
    assert session.n_evals == 8


def test_raise_without_failed_runs_changes_nothing() -> None:
    session, _ = opened(total, failed_runs="raise")
    np.testing.assert_array_equal(session.evaluate(rows(3)), np.arange(3) + 0.5)


@pytest.mark.parametrize("policy", ["", "ignore", None, "Bound"])
def test_unknown_policies_are_refused(policy: Any) -> None:
    with pytest.raises(TypeError if policy is None else ValueError, match="choose from"):
        Evaluator(failed_runs=policy)


@pytest.mark.parametrize("batch_rows", [0, -5])
def test_batches_hold_at_least_one_row(batch_rows: int) -> None:
    with pytest.raises(ValueError, match=f"batch_rows = {batch_rows}: give a whole number >= 1"):
        Evaluator(batch_rows=batch_rows)


# Giving up


@pytest.mark.parametrize("policy", ["bound", "count-as-failure"])
@pytest.mark.parametrize(
    "response",
    [lambda x: np.full(len(x), np.nan), lambda x: 1 // 0],
    ids=["nan", "raising"],
)
def test_a_model_that_always_fails_is_given_up(response: Any, policy: Any) -> None:
    session, model = opened(response, failed_runs=policy)
    with pytest.raises(FailedRunError, match=r"all of the first \d+ runs failed; the model r"):
        session.evaluate(rows(3 * BATCH_ROWS))
    # not one call per row, and no second batch
    assert len(model.batches) < 4 * GIVE_UP_AFTER
    assert session.n_evals <= BATCH_ROWS


def test_giving_up_adds_up_over_small_batches() -> None:
    session, model = opened(lambda x: np.full(len(x), np.nan), batch_rows=10)
    with pytest.raises(FailedRunError, match="all of the first 70 runs failed"):
        session.evaluate(rows(1000))
    assert model.rows == 70


def test_one_good_run_is_reason_to_go_on() -> None:
    session, _ = opened(lambda x: np.where(x[:, 0] == 40, 1.0, np.nan), batch_rows=10)
    y = session.evaluate(rows(1000))
    assert session.n_failed == np.isnan(y).sum() == 999


def test_a_good_row_behind_a_failed_half_is_found_while_there_is_reason_to_look() -> None:
    # fewer failures than the limit: every row is tried by itself
    n = GIVE_UP_AFTER - 1
    session, _ = opened(raising_at(*range(n)))
    y = session.evaluate(rows(n + 1))
    assert np.flatnonzero(~np.isnan(y)).tolist() == [n]


# Progress


def test_progress_is_told_after_every_batch() -> None:
    seen: list[tuple[int, int | None]] = []
    session, _ = opened(
        total, batch_rows=4, progress=lambda done, expected: seen.append((done, expected))
    )
    session.evaluate(rows(5))
    session.expected = 9
    session.evaluate(rows(4))
    assert seen == [(4, None), (5, None), (9, 9)]


def test_sessions_of_one_evaluator_do_not_share_counts() -> None:
    evaluator = Evaluator()
    first = evaluator.session(total, 2, None)
    first.evaluate(rows(5))
    second = evaluator.session(total, 2, 7)
    assert second.n_evals == 0
    assert second.remaining == 7
