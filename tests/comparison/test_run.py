"""compare and run_comparison: arguments, order, references, progress."""

import io
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import uqfold
from tests.comparison.fakes import (
    GRID,
    METHODS,
    RELATIVE_STD_ERROR,
    SYSTEM,
    CountingModel,
    Sampled,
    Told,
    toy_problem,
    truth,
)
from uqfold.comparison import comparison_header, run_comparison, write_records
from uqfold.comparison.columns import COLUMNS
from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.methods import available
from uqfold.problems.criterion import Binomial, Criterion, criteria


def rows_run(problem: uqfold.Problem) -> int:
    assert isinstance(problem.model, CountingModel)
    return problem.model.rows


def test_frame_has_one_row_per_method_and_criterion_in_order() -> None:
    frame = uqfold.compare(toy_problem(), METHODS)
    assert list(frame) == list(COLUMNS)
    assert list(frame["label"]) == [label for label in METHODS for _ in GRID]
    assert list(frame["threshold"]) == [one.threshold for _ in METHODS for one in GRID]
    assert list(frame["missions"]) == [str(one.missions) for _ in METHODS for one in GRID]
    assert set(frame["problem"]) == {"toy"}


def test_error_and_reference_stand_beside_each_answer() -> None:
    frame = uqfold.compare(toy_problem(), METHODS)
    exact, biased = (frame[frame["label"] == label] for label in ("exact", "biased"))
    known = [truth(one) for one in GRID]
    assert list(exact["reference_pf"]) == known
    assert list(exact["error"]) == [0.0] * len(GRID)
    np.testing.assert_allclose(
        exact["reference_std_error"], RELATIVE_STD_ERROR * np.array(known), rtol=1e-15
    )
    answered = biased["pf"].notna()
    np.testing.assert_allclose(biased["error"][answered], 0.2, rtol=1e-12)
    assert biased["error"][~answered].isna().all()
    assert list(answered) == [one.tau is None for one in GRID]


def test_a_number_is_a_threshold() -> None:
    frame = uqfold.compare(toy_problem(), ["mc"], 12.0, max_evals=3000)
    pd.testing.assert_frame_equal(
        frame.drop(columns="seconds"),
        uqfold.compare(toy_problem(), "mc", criteria(12.0), max_evals=3000).drop(columns="seconds"),
    )


def test_references_are_never_interpolated() -> None:
    off = math.nextafter(12.0, 13.0)
    frame = uqfold.compare(toy_problem(), Told(), criteria([12.0, off, 12.5]))
    assert list(frame["reference_pf"].notna()) == [True, False, False]
    assert list(frame["error"].notna()) == [True, False, False]


def test_a_problem_without_references_has_none() -> None:
    frame = uqfold.compare(toy_problem(referenced=False), Told())
    assert frame[["reference_pf", "reference_std_error", "error"]].isna().all(axis=None)


ONE, TWO = criteria([12.0, 13.0])


@pytest.mark.parametrize(
    ("reference", "known"),
    [
        ([0.25, 0.125], [(0.25, 0.0), (0.125, 0.0)]),
        ({12.0: 0.25}, [(0.25, 0.0), None]),
        ({ONE: (0.25, 0.01), TWO: 0.125}, [(0.25, 0.01), (0.125, 0.0)]),
        (pd.DataFrame({"threshold": [12.0], "pf": [0.25]}), [(0.25, 0.0), None]),
        (pd.Series([0.25, 0.125]), [(0.25, 0.0), (0.125, 0.0)]),
        (pd.Series([0.125], index=[13.0]), [None, (0.125, 0.0)]),
        (lambda: Sampled().estimate(toy_problem(), [ONE, TWO], rng=1), None),
        (lambda: uqfold.compare(toy_problem(), Sampled(), [ONE, TWO], rng=1), None),
    ],
)
def test_a_problem_of_ones_own_gets_errors_from_a_reference(reference: Any, known: Any) -> None:
    """A known answer: numbers, a dict or table by criterion, the result of a long run."""
    if known is None:
        reference, rows = reference(), Sampled().estimate(toy_problem(), [ONE, TWO], rng=1)
        known = [(row.pf, row.std_error) for row in rows]
    frame = uqfold.compare(toy_problem(referenced=False), Told(), [ONE, TWO], reference=reference)
    for row, one in zip(frame.to_dict("records"), known, strict=True):
        if one is None:
            assert math.isnan(row["reference_pf"])
            continue
        pf, std_error = one
        assert (row["reference_pf"], row["reference_std_error"]) == (pf, std_error)
        assert row["error"] == abs(row["pf"] - pf) / pf
    with_it = uqfold.Problem(
        toy_problem().model, inputs=toy_problem().inputs, units=SYSTEM.units, name="toy",
        default_criteria=uqfold.Criteria([ONE, TWO]), references=reference,
    )  # fmt: skip
    assert with_it.references is not None
    assert [one.pf for one in with_it.references] == frame["reference_pf"].dropna().tolist()


def test_missions_and_tau_of_a_reference_are_those_of_its_rows() -> None:
    """Also of a frame that was written as CSV, with an answer that has an interval alone."""
    frame = uqfold.compare(toy_problem(), {"long": Sampled(n=20)}, GRID, rng=1)
    read = pd.read_csv(io.StringIO(frame.to_csv()))
    again = uqfold.compare(toy_problem(), Told(), GRID, reference=read)
    assert again["reference_pf"].tolist() == frame["pf"].tolist()
    assert (again["reference_std_error"] > 0.0).all()
    assert comparison_header(again)["reference"]["how"] == f"sampled, 20 runs, seed {1}"


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        (0.25, "reference = 0.25: for 2 criteria give a failure probability"),
        ([0.25, 1.5], "reference = 1.5: give a probability"),
        ({12.5: 0.25}, "reference: it knows T = 12.5, m = 1, none of which is asked"),
        ({"12": 0.25}, "a key of reference = '12'"),
        (pd.DataFrame({"threshold": [12.0]}), "it has no column 'pf'"),
        (lambda: uqfold.compare(toy_problem(), Told(), 12.0), "it states no error"),
        (
            lambda: uqfold.compare(toy_problem(), {"a": Sampled(), "b": Sampled()}, 12.0),
            "two answers for T = 12",
        ),
        (lambda: uqfold.compare(SYSTEM.problem(), Sampled(), 12.0), "it answers problem "),
        (lambda: Sampled().estimate(SYSTEM.problem(), [ONE], rng=1), "it answers problem "),
        (lambda: Sampled().estimate(fewer_units(), [ONE], rng=1), "units or structure differ"),
        (lambda: uqfold.compare(fewer_units(), Sampled(), ONE), "units or structure differ"),
        ({12.0 + 1e-9: 0.25}, "it knows T = 12.000000001, and T = 12.0 is asked: give the same"),
        ({}, "reference = {}: it holds no answer"),
        (
            pd.DataFrame({"threshold": ["12"], "pf": [0.25]}),
            "threshold of row 0 = '12': give a num",
        ),
        (pd.DataFrame({"threshold": [12.0], "pf": ["low"]}), "pf of row 0 = 'low': give a number"),
        (pd.DataFrame([[1, 2, 0.1]], columns=["threshold", "threshold", "pf"]), "more than one"),
        ("nowhere", "reference = 'nowhere': there is no such file"),
    ],
)
def test_what_is_no_reference_is_refused_before_any_run(reference: Any, said: str) -> None:
    problem = toy_problem(referenced=False)
    reference = reference() if callable(reference) else reference
    with pytest.raises((ValueError, TypeError), match=re.escape(said)):
        uqfold.compare(problem, Told(), [ONE, TWO], reference=reference)
    assert rows_run(problem) == 0


def fewer_units() -> uqfold.Problem:
    return replace(toy_problem(), units=2)


def test_records_are_a_reference(tmp_path: Path) -> None:
    frame = uqfold.compare(toy_problem(), {"long": Sampled(n=20)}, [ONE, TWO], rng=1)
    write_records(frame, tmp_path)
    for where in (tmp_path, str(tmp_path / "comparison.json")):
        again = uqfold.compare(toy_problem(), Told(), [ONE, TWO], reference=where)
        assert again["reference_pf"].tolist() == frame["pf"].tolist()


def test_methods_may_be_given_in_every_form() -> None:
    problem, one = toy_problem(), criteria(12.0)
    assert list(uqfold.compare(problem, "ffni-spa", one)["label"]) == ["ffni-spa"]
    assert list(uqfold.compare(problem, Told(), one)["label"]) == ["told"]
    mixed = uqfold.compare(problem, ["ffni-spa", Told()], one)
    assert list(mixed["label"]) == ["ffni-spa", "told"]
    labelled = uqfold.compare(problem, {"few": Told(n=10), "many": Told(n=20)}, one)
    assert list(labelled["label"]) == ["few", "many"]
    assert list(labelled["method"]) == ["told", "told"]
    assert list(labelled["n_evals"]) == [10, 20]


def test_all_available_methods_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    two = {name: available()[name] for name in ("mc", "ffni-spa")}
    monkeypatch.setattr("uqfold.comparison.run.available", lambda: two)
    frame = uqfold.compare(toy_problem(), None, criteria(12.0), max_evals=3000)
    assert list(frame["label"]) == ["mc", "ffni-spa"]
    assert (frame["n_evals"] <= 3000).all()


@pytest.mark.parametrize("criterion", [Criterion(12.0), [Criterion(12.0)], criteria(12.0)])
def test_criteria_may_be_given_in_every_form(criterion: object) -> None:
    assert len(uqfold.compare(toy_problem(), Told(), criterion)) == 1


@pytest.mark.parametrize(
    ("arguments", "error", "said"),
    [
        ({"methods": "nope"}, ValueError, "methods = 'nope': choose from 'ffni-spa', "),
        ({"methods": [Told(), "nope"]}, ValueError, "'nope'"),
        ({"methods": []}, ValueError, "methods = .*: choose from ffni-spa, "),
        ({"methods": {}}, ValueError, "methods = .*: choose from"),
        ({"methods": [Told(), Told(n=3)]}, ValueError, "methods: two are labelled 'told'"),
        ({"methods": [Told]}, TypeError, r"it is a class, give an instance: Told\(\)"),
        ({"methods": [3]}, TypeError, r"methods\[0\] = 3: give a name"),
        ({"methods": {" ": Told()}}, ValueError, "' '.*: give labels that are not empty"),
        ({"criteria": [12.0]}, TypeError, r"criteria\[0\] = 12.0: give a Criterion"),
        ({"criteria": []}, ValueError, r"criteria = \(\): give at least one"),
        ({"max_evals": -1}, ValueError, "max_evals = -1"),
        ({"max_evals": 0}, ValueError, "max_evals = 0"),
        ({"max_evals": 1.5}, ValueError, "max_evals = 1.5"),
        ({"rng": -1}, ValueError, "rng = -1"),
        ({"rng": "x"}, TypeError, "rng = 'x'"),
    ],
)
def test_bad_arguments_are_refused_before_any_run(
    arguments: dict[str, object], error: type[Exception], said: str
) -> None:
    problem = toy_problem()
    with pytest.raises(error, match=said):
        uqfold.compare(problem, **{"methods": [Told()], **arguments})
    assert rows_run(problem) == 0


def test_something_else_than_a_problem_is_refused() -> None:
    with pytest.raises(TypeError, match="give a Problem"):
        uqfold.compare("series")


def test_criteria_are_needed_where_the_problem_has_none() -> None:
    with pytest.raises(ValueError, match=r"no default ones: pass uqfold.criteria"):
        uqfold.compare(SYSTEM.problem(), Told())


def test_methods_are_given_one_by_one_as_they_finish() -> None:
    problem = toy_problem()
    runs = run_comparison(problem, {"a": Told(n=10), "b": Told(n=20)})
    assert rows_run(problem) == 0
    first = next(runs)
    assert list(first["label"]) == ["a"] * len(GRID)
    assert rows_run(problem) == 10
    second = next(runs)
    assert list(second["label"]) == ["a"] * len(GRID) + ["b"] * len(GRID)
    assert rows_run(problem) == 30
    for frame, finished in ((first, ["a"]), (second, ["a", "b"])):
        header = comparison_header(frame)
        assert [one["label"] for one in header["methods"]] == ["a", "b"]
        assert header["finished"] == finished


def test_progress_hears_of_every_method_and_batch() -> None:
    heard: list[tuple[str, int, int | None]] = []
    own: list[tuple[int, int | None]] = []
    evaluator = Evaluator(batch_rows=60, progress=lambda n, of: own.append((n, of)))
    uqfold.compare(
        toy_problem(),
        {"a": Told(n=100), "b": Told(n=60)},
        criteria(12.0),
        evaluator=evaluator,
        progress=lambda label, n, of: heard.append((label, n, of)),
    )
    assert heard == [("a", 0, None), ("a", 60, 100), ("a", 100, 100), ("b", 0, None), ("b", 60, 60)]
    assert own == [(60, 100), (100, 100), (60, 60)]


def test_every_method_gets_the_one_seed_and_a_row_can_be_repeated_by_the_method_alone() -> None:
    frame = uqfold.compare(
        toy_problem(), {"a": Sampled(), "b": Sampled(n=500)}, rng=np.random.default_rng(1)
    )
    (seed,) = set(frame["seed"])
    alone = Sampled(n=500).estimate(toy_problem(), GRID, rng=int(seed))
    assert list(frame[frame["label"] == "b"]["pf"]) == alone.pf.tolist()


def test_same_seed_same_frame_other_seed_other_frame() -> None:
    first, again, other = (
        uqfold.compare(toy_problem(), Sampled(), rng=seed)["pf"].tolist() for seed in (0, 0, 1)
    )
    assert first == again
    assert first != other


def test_a_broken_method_is_a_row_and_not_a_crash() -> None:
    frame = uqfold.compare(toy_problem(), METHODS, criteria(12.0))
    broken = frame[frame["label"] == "broken"].iloc[0]
    assert (broken["status"], broken["message"]) == ("failed", "ArithmeticError: a pole [at zero]")


def test_policy_raise_ends_the_comparison_but_finished_methods_stay() -> None:
    def sometimes_nan(x: np.ndarray) -> np.ndarray:
        return np.where(np.arange(len(x)) == 150, np.nan, SYSTEM.response(x))

    problem = uqfold.Problem(sometimes_nan, inputs=SYSTEM.problem().inputs.distribution, units=3)
    runs = run_comparison(
        problem,
        {"small": Told(n=100), "large": Told(n=200)},
        Criterion(12.0, missions=Binomial(2, 0.5)),
        evaluator=Evaluator(failed_runs="raise"),
    )
    assert set(next(runs)["label"]) == {"small"}
    with pytest.raises(FailedRunError, match="NaN"):
        next(runs)


def test_on_the_papers_first_example() -> None:
    frame = uqfold.compare(
        uqfold.problems.series(), ["ffni-spa", "mc"], criteria([0.0, 2.0, 6.0]), max_evals=40_000
    )
    spa, mc = (frame[frame["label"] == label] for label in ("ffni-spa", "mc"))
    assert list(spa["n_evals"]) == [229] * 3
    # within 3 % in the body of the distribution, a third too high in its tail
    assert list(spa["error"] < 0.03) == [True, True, False]
    body = mc[mc["threshold"] < 6.0]
    assert (abs(body["pf"] - body["reference_pf"]) < 4.0 * body["std_error"]).all()
