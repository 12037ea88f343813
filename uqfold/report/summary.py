"""The summary of a comparison: who was right, at what cost, what failed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from uqfold.plots.telling import gid
from uqfold.plots.wording import percent, seconds_text
from uqfold.report.answers import ERROR, STATUSES, UNCHECKED, WITHIN, methods_table
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import TONES, typeset
from uqfold.report.page.markup import literal
from uqfold.report.scores import RIGHT_WITHIN, method_scores, spreads

if TYPE_CHECKING:
    import pandas as pd

_MOST_NAMED = 3
"""Methods named one by one in a card; the table below has them all."""
_FAULTS = ["failed", "doubtful", "budget_exhausted"]


def add_summary(page: Page, frame: pd.DataFrame) -> None:
    """Add the first screen of the report on a comparison: cards, and one line per method."""
    scores = method_scores(frame)
    if scores["referenced"].any():
        _add_right(page, scores)
    else:
        _add_agreement(page, spreads(frame))
    _add_cost(page, scores)
    _add_failures(page, scores)
    page.table(
        methods_table(frame),
        "Methods",
        name="methods-in-short",
        belongs=[gid(method=label) for label in scores.index],
    )
    said = "One evaluation is one run of the model."
    if scores["referenced"].any():
        said += (
            f" Error: {ERROR}. An answer is {WITHIN} also where two standard errors of the "
            "reference are more."
        )
    if scores["unchecked"].any():
        said += f" Unchecked: {UNCHECKED}."
    page.text(said, small=True)


def _add_right(page: Page, scores: pd.DataFrame) -> None:
    title = "Who was right?"
    ranked = scores.sort_values(["right", "n_evals"], ascending=[False, True], kind="stable")
    most, asked = ranked[["right", "referenced"]].iloc[0]
    if most == 0:
        page.card(title, "Nobody", f"No answer is {WITHIN} of its reference.", tone="bad")
        return
    more = [f"{WITHIN.capitalize()} on {most} of {asked} criteria."]
    rest = ranked[ranked["right"] < most]
    if len(rest):
        listed = (f"{literal(label)} on {right}" for label, right in rest["right"].items())
        more.append("; ".join(listed) + ".")
    best = ranked.index[ranked["right"] == most]
    page.card(title, _listed(best), *more, tone="good" if most == asked else "warn")


def _add_agreement(page: Page, apart: pd.Series) -> None:
    title = "Do the methods agree?"
    note = "There is no reference: nobody knows here who is right."
    if apart.empty:
        page.card(title, "Nothing to compare", note, tone="warn")
        return
    answer = f"To within {typeset(percent(apart.max()))}"
    half = f"Half of the criteria to within {typeset(percent(apart.median()))}."
    page.card(title, answer, half, note, tone="good" if apart.max() <= RIGHT_WITHIN else "warn")


def _add_cost(page: Page, scores: pd.DataFrame) -> None:
    title = "At what cost?"
    answering = scores[scores["answered"] > 0]
    if answering.empty:
        page.card(title, "No answer at any cost", tone="bad")
        return
    # of those that were right most often the cheapest; without references all were right equally
    by_cost = answering.sort_values(["n_evals", "seconds"], kind="stable")
    best = by_cost["right"].idxmax()
    evals, seconds, right = by_cost.loc[best, ["n_evals", "seconds", "right"]]
    which = "right most often" if right else "the cheapest with an answer"
    more = [f"{literal(best)}, {which}, took {seconds_text(seconds)}."]
    dearest = answering["n_evals"].idxmax()
    if answering["n_evals"][dearest] > evals:
        more.append(f"The most: {literal(dearest)} with {answering['n_evals'][dearest]:,}.")
    page.card(title, f"{int(evals):,} evaluations", *more)


def _add_failures(page: Page, scores: pd.DataFrame) -> None:
    asked = scores["asked"].sum()
    said = {
        status: f"{n} of {asked} answers {words.format(are='is' if n == 1 else 'are')}"
        for status, words in STATUSES.items()
        if (n := scores[status].sum()) > 0
    }
    tone = TONES.get(next(iter(said)).replace("_", " "), "")
    if len(said) > 1:
        said.pop("converged", "")
    answer = "Nothing"
    if faults := [status for status in said if status in _FAULTS]:
        answer = said.pop(faults[0]).replace(" answers", "")
    more = [f"{'; '.join(said.values())}."] if said else []
    guilty = scores.index[scores[_FAULTS].any(axis=1)]
    if len(guilty):
        more.append(f"Concerns {_listed(guilty)}.")
    page.card("What failed?", answer, *more, tone="" if tone == "quiet" else tone)


def _listed(labels: Iterable[str]) -> str:
    named = list(labels)
    if len(named) > _MOST_NAMED:
        others = len(named) - _MOST_NAMED + 1
        named = [*named[: _MOST_NAMED - 1], f"{others} others"]
    *front, last = map(literal, named)
    return f"{', '.join(front)} and {last}" if front else last
