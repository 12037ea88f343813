"""The league table of a benchmark, for the terminal and as a page; no model is run."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import uqfold
from uqfold.comparison.league import (
    INSTANCE,
    REFUTED_BELOW,
    RIGHT_WITHIN,
    USABLE_COV,
    WRONG_ERRORS,
    league_table,
    problem_scores,
)
from uqfold.plots.profiles import data_profile, performance_profile
from uqfold.plots.telling import gid
from uqfold.plots.wording import NO_VALUE, criterion_text, percent, probability, seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Cell

if TYPE_CHECKING:
    import pandas as pd

_WORDS = {
    "solved": "questions with clean and right answers with half of the seeds at least",
    "clean": "answers that say `converged`",
    "right": f"answers within {RIGHT_WITHIN:.0%} of the reference, whatever they say",
    "wrong": f"clean answers that are not right, and {WRONG_ERRORS:g} of their stated errors off",
    "no answer": "answers without a number, or that the method does not support",
    "bias, rms error": "mean and root mean square of the relative error of clean answers",
    "covered": "95 % intervals that hold the reference, of those with a stated error below "
    f"{USABLE_COV:.0%} of pf",
    "p": "smallest probability, over the questions, of so few of them; below "
    f"{REFUTED_BELOW:g} the interval does not hold (one-sided binomial test)",
    "evaluations, time": "medians of the answers with a number",
}
_NOT_SHOWN = """\
- What other settings or another budget would give: a method that is far from its target here may
  be the best with ten times as much. Each ends at a target of its own: fewer evaluations may be a
  lower aim.
- Models that take long or fail, and systems of several units: limit states of the literature are
  formulas. Times are those of the methods themselves, on one machine that did other work as well.
- An order that holds among other rivals: factors in the first profile are relative to the
  cheapest method in this table.
"""
_FEW = """\
- Whether intervals hold to the last per cent: few seeds find only those that are much too narrow.
"""
MANY_SEEDS = 30
"""From how many seeds coverage is told question by question."""


def league_cells(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the league table of `uqfold.benchmark` as cells, one row per method."""
    import pandas as pd

    return pd.DataFrame(
        {
            "method": row["label"],
            "solved": _of(row["questions_solved"], row["questions"]),
            "clean": _of(row["clean"], row["answers"]),
            "right": _of(row["right"], row["answers"]),
            "wrong": Cell(f"{row['wrong']}", row["wrong"], "bad" if row["wrong"] else ""),
            "no answer": row["failed"] + row["unsupported"],
            "bias": _cell(row["bias"], "{:+.1%}".format),
            "rms error": _cell(row["rmse"], percent),
            "covered": _of(row["covered"], row["usable"]),
            "p": _cell(row["coverage_p"], "{:.2g}".format),
            "evaluations": _cell(row["n_evals"], "{:,.0f}".format),
            "time": _cell(row["seconds"], seconds_text),
        }
        for row in league_table(frame).to_dict("records")
    )


def benchmark_page(frame: pd.DataFrame, command: str = "") -> Page:
    """Make the page on a benchmark.

    Parameters
    ----------
    frame
        Rows of `uqfold.benchmark`, all with one budget.
    command
        What makes the page; if empty, the commands that made the rows are told.

    Raises
    ------
    ValueError
        If no row has a reference.
    """
    cells, scores = league_cells(frame), problem_scores(frame)
    budget, seeds = frame["max_evals"].iloc[0], frame["seed"].nunique()
    page = Page(
        "Which method solves what, and at what cost",
        f"{len(cells)} methods, {scores['problem'].nunique()} problems with known answers, "
        f"{seeds} seed{'s' if seeds > 1 else ''} (one for methods that no seed changes), "
        + ("no budget." if math.isinf(budget) else f"at most {budget:,.0f} evaluations an answer."),
        kind="League table of reliability methods",
        imprint=f"Made by uqfold {uqfold.__version__} from answers of "
        f"{frame['date'].min()} to {frame['date'].max()}; no model was run.",
    )
    belongs = [gid(method=label) for label in cells["method"]]
    page.table(cells, "League table", name="league", belongs=belongs)
    page.facts(_WORDS)
    page.section("Share of questions solved", name="profiles")
    said = "Share of questions that a method solves with at most so many"
    page.figure(
        performance_profile(frame), "Performance profile",
        f"{said} times the evaluations of the cheapest that solves them (Dolan and More 2002).",
    )  # fmt: skip
    page.figure(
        data_profile(frame), "Data profile",
        f"{said} evaluations for each input and one more (More and Wild 2009).",
    )  # fmt: skip
    page.section("What it takes", name="costs")
    page.table(
        _by_question(scores, _cost), "Evaluations of the methods that solve a question",
        "Medians; nothing where a method does not solve, `wrong` where an answer is wrong.",
    )  # fmt: skip
    if seeds >= MANY_SEEDS:
        page.section("Whether intervals hold", name="coverage")
        page.table(
            _by_question(scores, _coverage), "95 % intervals that hold the reference",
            f"Of those with a stated error below {USABLE_COV:.0%} of pf; with p, the probability "
            f"of so few, where it is below {REFUTED_BELOW:g}: they do not hold.",
        )  # fmt: skip
    page.section("What it does not show", name="not-shown")
    page.text(_NOT_SHOWN if seeds >= MANY_SEEDS else _FEW + _NOT_SHOWN)
    page.section("Making it again", name="reproduction")
    page.code(command or "\n".join(dict.fromkeys(filter(None, frame["command"]))))
    page.table(frame[["label", "settings"]].drop_duplicates(), "Methods and settings")
    return page


def _by_question(scores: pd.DataFrame, cell: Callable[[Mapping[str, Any]], Cell]) -> pd.DataFrame:
    """Return one row per question, one column per method, with a cell of each of its scores."""
    import pandas as pd

    rows: dict[str, dict[str, Any]] = {}
    asked = scores.drop_duplicates(INSTANCE)["problem"].value_counts()
    for one in scores.to_dict("records"):
        name = one["problem"]
        if asked[name] > 1:
            name = f"{name}: {criterion_text(one, '')}"
        pf = Cell(probability(one["reference_pf"], 3), one["reference_pf"])
        row = rows.setdefault(name, {"question": name, "inputs": one["inputs"], "pf": pf})
        row[one["label"]] = cell(one)
    return pd.DataFrame(list(rows.values()))


def _cost(score: Mapping[str, Any]) -> Cell:
    if math.isfinite(score["cost"]):
        return Cell(f"{score['cost']:,.0f}", score["cost"])
    return Cell("wrong" if score["wrong"] else "", math.inf, "bad")


def _coverage(score: Mapping[str, Any]) -> Cell:
    if not score["usable"]:
        return Cell("", math.nan)
    refuted = score["coverage_p"] < REFUTED_BELOW
    said = f"{score['covered']} of {score['usable']}"
    said += f" (p = {score['coverage_p']:.1g})" if refuted else ""
    return Cell(said, score["covered"] / score["usable"], "bad" if refuted else "")


def _of(count: float, total: float) -> Cell:
    return Cell(f"{count} of {total}", count)


def _cell(value: float, write: Callable[[float], str]) -> Cell:
    return Cell(NO_VALUE if math.isnan(value) else write(value), value)
