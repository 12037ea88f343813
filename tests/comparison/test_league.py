"""The league table: numbers by hand, the test of intervals, and what it takes to solve."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uqfold import plots
from uqfold.comparison import league_table, problem_scores, solving_costs
from uqfold.comparison.columns import COLUMNS
from uqfold.report import report_page
from uqfold.report.benchmark_page import benchmark_page

ROW: dict[str, Any] = dict.fromkeys(COLUMNS, "") | {
    "problem": "a", "label": "mine", "threshold": 0.0, "tau": math.nan, "missions": "1", "seed": 0,
    "pf": 0.1, "std_error": 0.001, "ci_low": 0.098, "ci_high": 0.102, "status": "converged",
    "n_evals": 100, "seconds": 0.5, "reference_pf": 0.1, "reference_std_error": 0.0, "error": 0.0,
    "max_evals": 1000.0, "inputs": 4, "covered": 1.0, "settings": "Mine()", "code": "c",
    "date": "2026-01-01T00:00:00+00:00", "command": "uqfold benchmark", "schema": "s",
}  # fmt: skip


def rows(*changes: dict[str, Any]) -> pd.DataFrame:
    frame = pd.DataFrame([ROW | {"seed": i} | one for i, one in enumerate(changes)])
    return frame.assign(error=(frame["pf"] / frame["reference_pf"] - 1.0).abs())


LOST: dict[str, Any] = {"pf": math.nan, "std_error": math.nan, "covered": math.nan,
                        "status": "failed"}  # fmt: skip
FRAME = pd.concat(
    [
        rows({}, {"pf": 0.104, "covered": 0.0}, {"pf": 0.2, "covered": 0.0, "n_evals": 300}),
        rows({"problem": "b"}, {"problem": "b", "status": "doubtful"}, {"problem": "b"} | LOST),
        rows({"label": "dear", "n_evals": 400}),
        rows({"label": "dear", "problem": "b", "pf": 0.15, "std_error": 0.1, "n_evals": 50}),
    ]
)


def test_scores_by_hand() -> None:
    scores = problem_scores(FRAME).set_index(["problem", "label"])
    a, b = scores.loc[("a", "mine")], scores.loc[("b", "mine")]
    assert a["bias"] == pytest.approx((0.0 + 0.04 + 1.0) / 3)
    assert a["rmse"] == pytest.approx(math.sqrt((0.04**2 + 1.0) / 3))
    assert b["bias"] == 0.0  # of the one clean answer
    counted = ["answers", "clean", "right", "solved", "wrong", "failed", "usable", "covered"]
    assert a[counted].tolist() == [3, 3, 2, 2, 1, 0, 3, 1]
    assert b[counted].tolist() == [3, 1, 2, 1, 0, 1, 2, 2]
    # solved with two of three seeds, and with one of three
    assert (a["cost"], b["cost"]) == (100.0, math.inf)
    # 50 % off, but within half a stated error; too wide an error to judge its interval
    assert scores.loc[("b", "dear"), counted].tolist() == [1, 1, 0, 0, 0, 0, 0, 0]
    assert math.isnan(scores.loc[("b", "dear"), "coverage_p"])


def test_intervals_are_tested_by_the_binomial_law_at_a_thousandth() -> None:
    """Issue: one-sided test at the 0.1 % level wherever the stated cov is under 0.2."""
    held = [{"covered": float(i >= k)} for k in (4, 5) for i in range(30)]
    frame = pd.concat([rows(*held[:30]), rows(*({"problem": "b"} | one for one in held[30:]))])
    scores = problem_scores(frame)
    by_hand = [
        sum(math.comb(30, j) * 0.05**j * 0.95 ** (30 - j) for j in range(k, 31)) for k in (4, 5)
    ]
    assert scores["coverage_p"].tolist() == pytest.approx(by_hand)
    wide = rows(*({"covered": 0.0, "std_error": 0.03} for _ in range(9)))
    assert problem_scores(wide)["usable"].tolist() == [0]
    none = rows(*({"covered": 0.0} for _ in range(3)))
    table = league_table(none).iloc[0]
    assert table["coverage_p"] == pytest.approx(0.05**3)
    assert (table["refuted"], table["usable"], table["covered"]) == (1, 3, 0)


def test_the_table_puts_those_first_that_solve_most() -> None:
    table = league_table(FRAME).set_index("label")
    assert list(table.index) == ["dear", "mine"]  # as many problems, none wrong
    mine, counted = table.loc["mine"], ["answers", "clean", "wrong", "failed"]
    assert mine[["questions", "questions_solved", *counted]].tolist() == [2, 1, 6, 4, 1, 1]
    assert mine["bias"] == pytest.approx((0.0 + 0.04 + 1.0 + 0.0) / 4)
    assert (mine["covered"], mine["usable"]) == (3, 5)
    assert mine["n_evals"] == 100.0


def test_costs_and_profiles() -> None:
    costs = solving_costs(FRAME)
    assert costs.to_numpy().tolist() == [[100.0, 400.0], [math.inf, math.inf]]
    for draw, ends in (
        (plots.performance_profile, {"mine": 1.0, "dear": 4.0}),
        (plots.data_profile, {"mine": 20.0, "dear": 80.0}),
    ):
        for line in draw(FRAME).get_lines():
            x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
            assert y.tolist() == [0.0, 0.5, 0.5]  # one of two questions
            assert x[1] == ends[str(line.get_label())]
        assert "50% within" in plots.values(draw(FRAME))["method=mine"][1]
    lost = rows(LOST, LOST)
    assert plots.performance_profile(lost).get_lines()[0].get_ydata().tolist() == [0.0, 0.0]


def test_frames_that_are_none_of_a_benchmark_are_refused() -> None:
    with pytest.raises(ValueError, match="no column 'max_evals'"):
        league_table(FRAME.drop(columns="max_evals"))
    with pytest.raises(ValueError, match="2 budgets: give one"):
        problem_scores(pd.concat([FRAME, FRAME.assign(max_evals=50.0)]))
    with pytest.raises(ValueError, match="no row with a reference"):
        solving_costs(FRAME.assign(reference_pf=math.nan))


def test_the_page_says_what_made_it_and_what_it_does_not_show() -> None:
    said = benchmark_page(FRAME).markdown()
    assert "2 methods, 2 problems with known answers, 3 seeds" in said
    assert "at most 1,000 evaluations" in said
    assert "| mine | 1 of 2 | 4 of 6 | 4 of 6 | 1 | 1 | +26.0% |" in said
    assert "| a | 4 | 0.100 | 100 | 400 |" in said
    assert "```\nuqfold benchmark\n```" in said
    assert "## What it does not show" in said
    assert report_page(FRAME).markdown() == said


def test_many_seeds_tell_question_by_question_whether_intervals_hold() -> None:
    broken = [{"label": "narrow", "covered": float(i < 30)} for i in range(40)]
    said = benchmark_page(pd.concat([rows(*[{}] * 40), rows(*broken)])).markdown()
    assert "| a | 4 | 0.100 | 40 of 40 | 30 of 40 (p = 2 × 10⁻⁵) |" in said
    assert "few seeds" not in said
    assert "few seeds" in benchmark_page(FRAME).markdown()
