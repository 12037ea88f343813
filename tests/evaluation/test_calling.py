"""How a model is called is found out before its responses count."""

import math
import os
import signal
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import openturns as ot
import pandas as pd
import pytest

import uqfold
from tests.evaluation import models
from uqfold.evaluation import EvaluationSession, Evaluator, ModelError, Processes, Store, per_sample
from uqfold.evaluation.calling import MOST_COMPARED, REPEATS
from uqfold.inputs import normal
from uqfold.methods import ActiveKriging, ConditionalMonteCarlo, FFNIPearson, Kriging, MonteCarlo
from uqfold.problems import Problem
from uqfold.testing.counting import RowCount

PF = 0.016947426762344637  # Phi(-3 / sqrt 2)


def of_one_sample(x: np.ndarray) -> float:
    a, b = x
    return a - b


def by_index(x: np.ndarray) -> float:
    return x[0] - x[1]


def limit_state(g: Callable[[np.ndarray], Any]) -> Problem:
    return Problem.from_limit_state(g, {"a": normal(5.0, 1.0), "b": normal(2.0, 1.0)})


def opened(model: Any, dimension: int = 2, **settings: Any) -> EvaluationSession:
    return Evaluator(**settings).session(model, dimension, None)


def rows(n: int, d: int = 2) -> np.ndarray:
    return np.random.default_rng(n).standard_normal((n, d)) + 3.0


# A model of one sample, not wrapped


@pytest.mark.parametrize("g", [of_one_sample, by_index])
@pytest.mark.parametrize(
    "method",
    [ConditionalMonteCarlo(), MonteCarlo(systems=2000), FFNIPearson(), Kriging()],
    ids=lambda method: method.name,
)
def test_a_model_of_one_sample_not_wrapped_is_refused_by_name(method: Any, g: Any) -> None:
    row = method.estimate(limit_state(g), rng=1, max_evals=20_000)[0]
    assert (row.status, math.isnan(row.pf)) == ("failed", True)
    assert "takes one sample x (2,)" in row.message
    assert "per_sample" in row.message


@pytest.mark.parametrize("g", [of_one_sample, by_index])
def test_wrapped_it_has_the_right_answer(g: Any) -> None:
    row = MonteCarlo(systems=2000, target_cov=0.3).estimate(limit_state(per_sample(g)), rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - PF) < 4.0 * row.std_error


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 8, 64, 128])
@pytest.mark.parametrize("d", [1, 2, 3, 4])
@pytest.mark.parametrize(
    "g",
    [
        lambda x: x[0] - x[-1],
        lambda x: float(x[0]) - float(x[-1]),
        sum,
        lambda x: sum(value for value in x) / len(x),
        np.sum,
        lambda x: np.sum(x) / len(x),
        lambda x: np.sum(x**2, axis=0),
        lambda x: x.mean(),
        lambda x: [x[0]] * 1,
        lambda x: x.max(),
        lambda x: max(*x, 0.0),
        lambda x: np.array([x[0]]).ravel(),
    ],
)
def test_a_function_of_one_sample_gives_its_own_numbers_or_none(g: Any, d: int, n: int) -> None:
    x = rows(n, d)
    expected = [float(np.ravel(g(row))[0]) for row in x]
    session = opened(g, d)
    try:
        y = session.evaluate(x)
    except ModelError as error:
        assert "per_sample" in str(error)  # noqa: PT017 - either is right
        return
    good = ~np.isnan(y)
    np.testing.assert_allclose(y[good], np.array(expected)[good])


def test_nothing_is_halved_until_a_shape_fits_by_chance() -> None:
    sizes: list[int] = []

    def model(x: np.ndarray) -> np.ndarray:
        sizes.append(len(x))
        return x[0] - x[1]

    with pytest.raises(ModelError, match=r"one sample x \(2,\), not rows X \(n, 2\)"):
        opened(model).evaluate(rows(64))
    # 64 rows, and one sample (2,)
    assert sizes == [64, 2]


# Rows that depend on each other


@pytest.mark.parametrize(
    "model",
    [
        lambda x: x[:, 0] - x[:, 0].mean(),
        lambda x: (x[:, 0] - x[:, 0].mean()) / x[:, 0].std(),
        lambda x: x[:, 0] / np.linalg.norm(x[:, 0]),
        lambda x: np.cumsum(x[:, 0]),
        lambda x: np.sort(x[:, 0]),
        lambda x: x[::-1, 0],
        lambda x: np.roll(x[:, 0], 1),
        lambda x: np.full(len(x), x.sum()),
        lambda x: 1000.0 + x[:, 0] - x[:, 0].mean(),
        lambda x: x[:, 0] + np.random.default_rng(0).standard_normal(len(x)),
        lambda x: x[:, 0] + np.arange(len(x)),
    ],
)
@pytest.mark.parametrize("n", [3, 50, 5000])
@pytest.mark.filterwarnings("ignore:invalid value")
def test_a_model_that_mixes_rows_is_refused(model: Any, n: int) -> None:
    with pytest.raises(ModelError, match="alone"):
        opened(model).evaluate(rows(n))
    # one by one they have a meaning
    assert opened(lambda x: x[:, 0] - x[:, 0].mean(), batch_rows=1).evaluate(rows(3)).size == 3


def clipped(x: np.ndarray, share: float = 0.05) -> np.ndarray:
    y = x[:, 0] - x[:, 1]
    return np.clip(y, *np.quantile(y, [share, 1.0 - share])) if len(y) > 10 else y


@pytest.mark.parametrize(
    "method", [MonteCarlo(), ConditionalMonteCarlo(), Kriging(), ActiveKriging()], ids=str
)
def test_a_model_that_clips_at_the_ends_of_a_batch_is_refused_without_a_limit(method: Any) -> None:
    row = method.estimate(limit_state(clipped), rng=1, max_evals=4000)[0]
    assert row.status == "failed", row
    assert "depends on the rows beside it" in row.message
    with pytest.raises(ModelError, match="beside it"):
        opened(lambda x: clipped(x, 1e-3)).evaluate(rows(5000))


def test_rows_are_compared_again_where_batches_are_much_larger() -> None:
    session = opened(clipped)
    session.evaluate(rows(10))
    with pytest.raises(ModelError, match="beside it"):
        session.evaluate(rows(100))


@pytest.mark.parametrize(
    "model",
    [
        lambda x: np.float32(1.0) * x.astype(np.float32) @ np.array([1.0, 2.0], np.float32),
        lambda x: 1e9 + x @ np.array([1.0, 2.0]),
        lambda x: np.squeeze(x[:, :1]),
        lambda x: x[:, :1],
        lambda x: list(x[:, 0]),
        lambda x: np.where(x[:, 0] > 3.0, np.inf, x[:, 0]),
        lambda x: np.where(x[:, 0] > 3.0, np.nan, x[:, 0]),
        lambda x: np.full(len(x), 5.0),
        lambda x: np.full(len(x), 1e308) * np.sign(x[:, 0] - 3.0),
        lambda x: x[:, 0] * (1.0 + 1e-9 * len(x)),  # as a solver's tolerance may have it
    ],
)
def test_rows_that_agree_up_to_rounding_pass(model: Any) -> None:
    x = rows(40)
    y = opened(model).evaluate(x)
    np.testing.assert_array_equal(y, np.reshape(model(x), 40))


def test_a_noisy_model_stays_possible() -> None:
    rng = np.random.default_rng(3)
    count = RowCount()

    def noisy(x: np.ndarray) -> np.ndarray:
        count.add(x)
        return x[:, 0] + 0.1 * rng.standard_normal(len(x))

    for n in range(2, 60):
        session = opened(noisy)
        assert np.abs(session.evaluate(rows(n)) - rows(n)[:, 0]).max() < 1.0
        assert session.n_evals == n
    # what it costs beyond its evaluations
    assert count.rows <= sum(range(2, 60)) + 58 * MOST_COMPARED * (1 + REPEATS)


# What finding out costs


def test_a_few_rows_are_run_again_alone_and_count_nowhere() -> None:
    seen: list[int] = []

    def model(x: np.ndarray) -> np.ndarray:
        seen.append(len(x))
        return x[:, 0]

    session = Evaluator(batch_rows=8).session(model, 2, 10)
    session.evaluate(rows(10))
    assert seen == [8, 1, 1, 1, 1, 2]
    assert (session.n_evals, session.remaining) == (10, 0)


def test_models_of_one_sample_and_single_rows_cost_nothing_more() -> None:
    seen: list[tuple[int, ...]] = []

    def sample(x: np.ndarray) -> float:
        seen.append(x.shape)
        return float(x[0])

    opened(per_sample(sample)).evaluate(rows(10))
    assert seen == [(2,)] * 10
    seen.clear()

    def model(x: np.ndarray) -> np.ndarray:
        seen.append(x.shape)
        return x[:, 0]

    opened(model, batch_rows=1).evaluate(rows(10))
    assert seen == [(1, 2)] * 10


def test_a_model_of_which_rows_fail_is_still_found_out() -> None:
    def model(x: np.ndarray) -> np.ndarray:
        if (x[:, 0] > 3.0).any():
            raise ArithmeticError("too far")
        return x[:, 1]

    x = rows(40)
    y = opened(model).evaluate(x)
    np.testing.assert_array_equal(y, np.where(x[:, 0] > 3.0, np.nan, x[:, 1]))

    def mixing(x: np.ndarray) -> np.ndarray:
        return model(x) - x[:, 1].mean()

    with pytest.raises(ModelError):
        opened(mixing).evaluate(x)


@pytest.fixture(scope="module")
def pool() -> Any:
    with Processes(2) as processes:
        yield processes


def test_executors_find_out_too(pool: Processes) -> None:
    with ThreadPoolExecutor(2) as threads:
        for executor in (pool, threads):
            for settings in ({}, {"batch_rows": 2}):
                with pytest.raises(ModelError, match="per_sample"):
                    opened(by_index, executor=executor, **settings).evaluate(rows(40))
                with pytest.raises(ModelError, match="beside it"):
                    opened(mixing_rows, executor=executor, **settings).evaluate(rows(40))
    with pytest.raises(ModelError, match="per_sample"):
        opened(of_one_sample, executor=pool, seconds_per_run=60.0).evaluate(rows(40))


def mixing_rows(x: np.ndarray) -> np.ndarray:
    return x[:, 0] - x[:, 0].mean()


def test_nothing_of_a_refused_model_is_stored(tmp_path: Path) -> None:
    path = tmp_path / "runs.db"
    problem = models.problem(mixing_rows)
    for executor in (None, ThreadPoolExecutor(2)):
        evaluator = Evaluator(store=path, batch_rows=5, executor=executor)
        with pytest.raises(ModelError):
            evaluator.open(problem, None).evaluate(rows(60))
        with Store(path) as store:
            assert len(store) == 0


# What is not a number, and what is masked


@pytest.mark.parametrize(
    ("returned", "named"),
    [
        (lambda x: x[:, 0] > 0.0, "dtype bool"),
        (lambda x: [True] * len(x), "a bool"),
        (lambda x: x[:, 0].astype("M8[s]"), r"dtype datetime64\[s\]"),
        (lambda x: x[:, 0].astype("m8[s]"), r"dtype timedelta64\[s\]"),
        (lambda x: np.zeros(len(x), [("y", float)]), r"dtype \[\('y'"),
        (lambda x: ["1_5"] * len(x), "dtype <U3"),
        (lambda x: [b"1"] * len(x), r"dtype \|S1"),
        (lambda x: (value for value in x[:, 0]), "generator"),
        (lambda x: {"y": x}, "dict"),
        (lambda x: [[1.0], [1.0, 2.0]], "not an array"),
        (lambda x: None, "return statement"),
        (lambda x: np.array([print] * len(x)), "builtin_function"),
    ],
)
def test_what_is_no_number_is_refused(returned: Any, named: str) -> None:
    with pytest.raises(ModelError, match=named):
        opened(returned).evaluate(rows(5))
    row = MonteCarlo(systems=200).estimate(limit_state(returned), rng=1)[0]
    assert (row.status, math.isnan(row.pf)) == ("failed", True)


def masked(x: np.ndarray) -> np.ma.MaskedArray:
    return np.ma.array(np.where(x[:, 0] > 3.0, -1e20, x[:, 1]), mask=x[:, 0] > 3.0)


@pytest.mark.parametrize("model", [masked, lambda x: list(masked(x))], ids=["array", "list"])
def test_a_masked_entry_is_a_failed_run(model: Any) -> None:
    x = rows(50)
    session = opened(model)
    y = session.evaluate(x)
    np.testing.assert_array_equal(y, np.where(x[:, 0] > 3.0, np.nan, x[:, 1]))
    assert session.n_failed == np.count_nonzero(x[:, 0] > 3.0)
    result = MonteCarlo(systems=500).estimate(limit_state(model), rng=1)
    assert result.n_failed > 0
    # each failed run is open
    assert result[0].pf_high - result[0].pf_low == pytest.approx(result.n_failed / 500)
    assert result[0].status == "doubtful"


def failing(entry: Any) -> Callable[[np.ndarray], Any]:
    return lambda x: [entry if one > 3.0 else float(one) for one in x[:, 0]]


def failing_sample(entry: Any) -> Any:
    return per_sample(lambda x: entry if x[0] > 3.0 else float(x[0]))


@pytest.mark.parametrize(
    ("model", "named"),
    [
        (masked, "a masked entry"),
        (lambda x: masked(x).reshape(-1, 1), "a masked entry"),
        (failing(np.ma.masked), "a masked entry"),
        (failing_sample(np.ma.masked), "a masked entry"),
        (failing(None), "None"),
        (failing_sample(None), "None"),
        (failing(pd.NA), "<NA>"),
        (lambda x: pd.Series(failing(None)(x), index=range(9, 9 + len(x)), dtype=object), "None"),
        (lambda x: np.emath.sqrt(3.0 - x[:, 0]), "a complex number"),
        (failing_sample(1j), "a complex number"),
        (failing_sample(10**400), "a number too large for a float"),
        (failing(math.nan), "NaN"),
        (failing_sample(math.nan), "NaN"),
    ],
)
def test_a_failed_run_is_told_as_what_the_model_returned(model: Any, named: str) -> None:
    """A masked entry was told as "returned NaN"."""
    x = rows(50)
    place = f"x = [{x[x[:, 0] > 3.0][0, 0]:.6g}, "
    # the sign of a limit state changes nothing
    for one in (model, limit_state(model).model):
        session = opened(one)
        session.evaluate(x)
        assert session.first_failure.startswith(f"the model returned {named} at {place}")


@pytest.mark.parametrize("shape", [(-1,), (-1, 1)])
@pytest.mark.parametrize("kind", [int, np.float32, np.float16, ">f8", object, "longdouble"])
def test_real_numbers_of_any_kind_are_taken(kind: Any, shape: tuple[int, ...]) -> None:
    x = np.arange(12.0).reshape(6, 2)
    y = opened(lambda x: x[:, 0].astype(kind).reshape(shape)).evaluate(x)
    assert y.dtype == np.float64
    np.testing.assert_array_equal(y, x[:, 0])


# (n, 1), as OpenTURNS has it


@pytest.mark.parametrize(
    "model",
    [
        ot.SymbolicFunction(["a", "b"], ["a - b"]),
        ot.PythonFunction(2, 1, lambda x: [x[0] - x[1]]),
        ot.PythonFunction(2, 1, func_sample=lambda x: np.asarray(x) @ [[1.0], [-1.0]]),
        ot.MemoizeFunction(ot.SymbolicFunction(["a", "b"], ["a - b"])),
        lambda x: ot.Sample((x[:, 0] - x[:, 1]).reshape(-1, 1)),
        lambda x: (x[:, 0] - x[:, 1]).reshape(-1, 1),
    ],
)
def test_a_column_of_responses_is_taken_as_openturns_gives_it(model: Any) -> None:
    x = rows(30)
    np.testing.assert_allclose(opened(model).evaluate(x), x[:, 0] - x[:, 1])
    row = MonteCarlo(systems=20_000).estimate(limit_state(model), rng=1)[0]
    assert abs(row.pf - PF) < 4.0 * row.std_error
    two = ot.SymbolicFunction(["a", "b"], ["a - b", "a + b"])
    with pytest.raises(ModelError, match=r"shape \(30, 2\)"):
        opened(two).evaluate(x)


# Other arguments than one array


@pytest.mark.parametrize(
    "model",
    [
        lambda a, b: a - b,
        lambda *, a, b: a - b,
        lambda: 1.0,
        lambda x: x["a"] - x["b"],
        lambda x: x["a"].to_numpy(),
        lambda x: x.a - x.b,
    ],
)
@pytest.mark.parametrize("wrapped", [False, True])
def test_a_model_that_expects_other_arguments_is_told_the_remedy(model: Any, wrapped: bool) -> None:
    """Two positional arguments, or inputs by name: refused before any budget is spent."""
    row = MonteCarlo(systems=300).estimate(
        limit_state(per_sample(model) if wrapped else model), rng=1
    )[0]
    assert (row.status, row.n_evals) == ("failed", 0)
    called, first = ("one sample x (2,)", "x[0]") if wrapped else ("rows X (n, 2)", "X[:, 0]")
    assert f"It is called with {called}" in row.message
    assert first in row.message
    if not wrapped or "as the only argument" in row.message:
        assert "per_sample(" in row.message


def test_an_error_of_the_model_s_own_making_stays_a_failed_run() -> None:
    def inner(a: float, b: float) -> float:
        return a - b

    def model(x: np.ndarray) -> np.ndarray:
        if (x[:, 0] > 5.0).any():
            return inner(x)  # type: ignore[call-arg,arg-type,return-value]
        return x[:, 0]

    x = rows(200)
    session = opened(model)
    assert np.isnan(session.evaluate(x)).sum() == np.count_nonzero(x[:, 0] > 5.0) > 0
    assert "missing 1 required positional argument" in session.first_failure


# sys.exit() in a model


def leaving(x: np.ndarray) -> np.ndarray:
    if (x[:, 1] > models.FATAL).any():
        raise SystemExit(0)
    return models.quadratic(x)


def leaving_sample(x: np.ndarray) -> float:
    return float(leaving(x[None, :])[0])


def closing(x: np.ndarray) -> np.ndarray:
    if (x[:, 1] > models.FATAL).any():
        raise GeneratorExit
    return models.quadratic(x)


class Aborted(BaseException):
    pass


def aborting(x: np.ndarray) -> np.ndarray:
    if (x[:, 1] > models.FATAL).any():
        raise Aborted("no mesh")
    return models.quadratic(x)


@pytest.mark.parametrize("model", [leaving, per_sample(leaving_sample), aborting, closing])
@pytest.mark.parametrize("where", ["here", "threads", "processes"])
def test_sys_exit_in_a_model_is_a_failed_run(model: Any, where: str, pool: Processes) -> None:
    """So is GeneratorExit, which left `estimate`."""
    x, bad = models.with_one_bad_row(40)
    with ThreadPoolExecutor(2) as threads:
        executor = {"here": None, "threads": threads, "processes": pool}[where]
        session = opened(model, executor=executor)
        y = session.evaluate(x)
    assert np.flatnonzero(np.isnan(y)).tolist() == [bad]
    told = {aborting: "Aborted: no mesh", closing: "GeneratorExit"}.get(model, "SystemExit: 0")
    assert told in session.first_failure
    row = MonteCarlo(systems=200).estimate(models.problem(model), uqfold.criteria(1.0), rng=1)[0]
    assert row.pf_high > row.pf_low


def interrupting(x: np.ndarray) -> np.ndarray:
    if (x[:, 1] > models.FATAL).any():
        raise KeyboardInterrupt
    return models.quadratic(x)


@pytest.mark.parametrize("where", ["here", "threads", "processes"])
def test_an_interrupt_that_a_model_raises_ends_the_program_everywhere(
    where: str, pool: Processes
) -> None:
    """In worker processes it counted as a failed run."""
    x, _ = models.with_one_bad_row(40)
    with ThreadPoolExecutor(2) as threads:
        executor = {"here": None, "threads": threads, "processes": pool}[where]
        with pytest.raises(KeyboardInterrupt):
            opened(interrupting, executor=executor).evaluate(x)
        # and the workers go on
        y = opened(models.quadratic, executor=executor).evaluate(x)
    np.testing.assert_array_equal(y, models.quadratic(x))


def leave(number: int, frame: object) -> None:
    raise SystemExit(3)


@pytest.mark.skipif(not hasattr(signal, "SIGUSR1"), reason="needs signals")
def test_a_handler_of_a_signal_ends_the_program_while_the_model_runs() -> None:
    def model(x: np.ndarray) -> np.ndarray:
        os.kill(os.getpid(), signal.SIGUSR1)
        return x[:, 0]

    before = signal.signal(signal.SIGUSR1, leave)
    try:
        with pytest.raises(SystemExit):
            opened(model).evaluate(rows(5))
    finally:
        signal.signal(signal.SIGUSR1, before)


# What a model's errors say


class SilentError(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no text")


class LoudError(Exception):
    def __str__(self) -> str:
        return "\x1b[31m" + "\ud800\x00" + "a" * 10_000_000 + "\x1b]0;title\x07 end"


class LoudAttributeError(SilentError, AttributeError):
    """Is looked at for what the model expects."""


def raising_in_one_row(error: type[Exception]) -> Callable[[np.ndarray], np.ndarray]:
    def model(x: np.ndarray) -> np.ndarray:
        if (x[:, 0] > 5.0).any():
            raise error
        return x[:, 0]

    return model


SOME = np.column_stack([np.arange(8.0), np.zeros(8)])


@pytest.mark.parametrize("wrapped", [False, True])
@pytest.mark.parametrize("error", [SilentError, LoudError, LoudAttributeError])
def test_an_error_is_a_failed_run_whatever_its_text_does(error: Any, wrapped: bool) -> None:
    """An exception whose text cannot be told is one failed run; a text is cut and made visible."""
    rows_model = raising_in_one_row(error)
    model = per_sample(lambda x: rows_model(x[None, :])[0]) if wrapped else rows_model
    session = opened(model)
    y = session.evaluate(SOME)
    assert np.isnan(y[6:]).all()
    assert session.n_failed == 2
    np.testing.assert_array_equal(y[:6], SOME[:6, 0])
    told = session.first_failure
    assert told.startswith(f"the model raised {error.__name__}: ")
    assert told.endswith("at x = [6, 0]")
    assert len(told) < 600
    assert told.isprintable()
    assert told.encode()
    assert ("its text cannot be told" in told) == (error is not LoudError)
    assert ("end at x" in told) == (error is LoudError)


def test_an_estimate_with_such_an_error_has_an_answer() -> None:
    """One run of many that fails so costs its share of pf, not the whole estimate."""
    model = raising_in_one_row(SilentError)
    problem = Problem.from_limit_state(model, {"a": normal(3.0, 1.0), "b": normal(2.0, 1.0)})
    row = MonteCarlo(systems=500).estimate(problem, rng=1)[0]
    assert row.status == "doubtful"
    assert 0 < row.n_failed < 50
    assert "SilentError" in row.message


@pytest.mark.parametrize("wrapped", [False, True])
def test_a_nan_that_signals_is_a_failed_run(wrapped: bool) -> None:
    def model(x: np.ndarray) -> list[Decimal]:
        return [Decimal("sNaN") if row[0] > 5.0 else Decimal(row[0]) for row in x]

    session = opened(per_sample(lambda x: model(x[None, :])[0]) if wrapped else model)
    y = session.evaluate(SOME)
    np.testing.assert_array_equal(y, [*SOME[:6, 0], np.nan, np.nan])
    assert session.first_failure == "the model returned NaN at x = [6, 0]"


class Unready:
    def __float__(self) -> float:
        raise RuntimeError("not \x1b yet")


class Unpacked:
    def __array__(self, *args: Any, **kwargs: Any) -> np.ndarray:
        raise RuntimeError("\x1b[2J" * 1000)


def test_an_object_that_is_no_array_after_all_is_no_response() -> None:
    with pytest.raises(ModelError, match="a Unpacked that is not an array") as caught:
        opened(lambda x: Unpacked()).evaluate(SOME)
    assert len(str(caught.value)) < 900
    assert str(caught.value).isprintable()


def test_an_object_that_is_no_float_after_all_is_no_response() -> None:
    with pytest.raises(ModelError, match=r"a Unready \(RuntimeError: not \ufffd yet\)"):
        opened(lambda x: [Unready() for _ in x]).evaluate(SOME)
