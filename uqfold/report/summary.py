"""The summary of a comparison: who was right, at what cost, what failed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from uqfold.comparison.league import RIGHT_WITHIN
from uqfold.plots.telling import gid
from uqfold.plots.wording import percent, probability, seconds_text
from uqfold.report.answers import ERROR, STATUSES, UNCHECKED, WITHIN, methods_table
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import TONES, Tone, typeset
from uqfold.report.page.markup import literal
from uqfold.report.scores import CRITERION, method_scores, spreads

if TYPE_CHECKING:
    import pandas as pd

_MOST_NAMED = 3
"""Methods named one by one in a card; the table below has them all."""
_FAULTS = ["failed", "doubtful", "budget_exhausted"]


def add_summary(page: Page, frame: pd.DataFrame) -> None:
    """Add the first screen of the report on a comparison: cards, and one line per method."""
    scores = method_scores(frame)
    said = "One evaluation is one run of the model."
    if scores["referenced"].any():
        _add_right(page, scores)
        said += (
            f" Error: {ERROR}. An answer is {WITHIN} also where two standard errors of the "
            "reference are more."
        )
    else:
        _add_pf(page, frame)
        if len(scores) > 1:
            _add_agreement(page, spreads(frame))
    _add_cost(page, scores)
    _add_failures(page, scores)
    belongs = [gid(method=label) for label in scores.index]
    page.table(methods_table(frame), "Methods", name="methods-in-short", belongs=belongs)
    if scores["unchecked"].any():
        said += f" Unchecked: {UNCHECKED}."
    page.text(said, small=True)


def _add_pf(page: Page, frame: pd.DataFrame) -> None:
    """Say pf: converged answers go first, then those with the narrowest intervals."""
    answered = frame[frame["pf"].notna()]
    if answered.empty:
        return
    width = (answered["ci_high"] - answered["ci_low"]) / answered["pf"]
    ordered = answered.assign(unsure=answered["status"] != "converged", width=width)
    best = ordered.sort_values(["unsure", "width"], kind="stable").drop_duplicates(CRITERION)
    ends = dict.fromkeys(probability(pf, 3) for pf in (best["pf"].min(), best["pf"].max()))
    asked = f"over {len(best)} criteria, " if len(best) > 1 else ""
    said = f"{asked}by {_listed(best['label'].unique())}."
    page.card(
        "How likely is failure?", f"pf = {typeset(' to '.join(ends))}", said[0].upper() + said[1:]
    )


def _add_right(page: Page, scores: pd.DataFrame) -> None:
    most, asked = scores["right"].max(), scores["referenced"].max()
    best = _listed(scores.sort_values("n_evals", kind="stable").query("right == @most").index)
    if most == 0:
        said = f"No answer is {WITHIN} of its reference."
        page.card("Who was right?", "Nobody", said, tone="bad")
        return
    asked_once = f"{WITHIN.capitalize()}."
    said = asked_once if asked == 1 else f"{WITHIN.capitalize()} on {most} of {asked} criteria."
    page.card("Who was right?", best, said, tone="good" if most == asked else "warn")


def _add_agreement(page: Page, apart: pd.Series) -> None:
    note = "There is no reference: nobody knows here who is right."
    tone: Tone = "warn"
    answer = "Nothing to compare"
    if len(apart):
        answer = f"To within {typeset(percent(apart.max()))}"
        if len(apart) > 1:
            note = f"Half of the criteria to within {typeset(percent(apart.median()))}. {note}"
        tone = "good" if apart.max() <= RIGHT_WITHIN else "warn"
    page.card("Do the methods agree?", answer, note, tone=tone)


def _add_cost(page: Page, scores: pd.DataFrame) -> None:
    answering = scores[scores["answered"] > 0]
    if answering.empty:
        page.card("At what cost?", "No answer at any cost", tone="bad")
        return
    # of those that were right most often the cheapest; without references all were right equally
    best = answering.sort_values(["n_evals", "seconds"], kind="stable")["right"].idxmax()
    evals, seconds, right = answering.loc[best, ["n_evals", "seconds", "right"]]
    which = "right most often" if right else "the cheapest with an answer"
    said = f"{literal(best)}, {which}, took {seconds_text(seconds)}."
    page.card("At what cost?", f"{int(evals):,} evaluations", said)


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
