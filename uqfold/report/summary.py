"""The summary of a comparison: who was right, at what cost, what failed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from uqfold.plots.telling import gid
from uqfold.plots.wording import count_text, percent, seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Cell, Tone, typeset
from uqfold.report.page.markup import literal
from uqfold.report.scores import RIGHT_WITHIN, method_scores, spreads
from uqfold.report.wording import UNCHECKED

if TYPE_CHECKING:
    import pandas as pd

_RIGHT = f"{100 * RIGHT_WITHIN:g} %"
_MOST_NAMED = 3
"""Methods named one by one in a card; the table below has them all."""
_STATUSES: dict[str, tuple[str, Tone]] = {
    "failed": ("failed", "bad"),
    "doubtful": ("{are} doubtful", "warn"),
    "budget_exhausted": ("{are} out of budget", "warn"),
    "unsupported": ("{are} outside what a method can do", "quiet"),
    "unchecked": ("{are} unchecked", ""),
    "converged": ("{are} converged", "good"),
}
"""Status -> what is said of answers that have it, and their tone; the worst first."""
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
        _methods(scores),
        "Methods",
        name="methods-in-short",
        formats={"median error": _error_text, "largest": _error_text, "time": seconds_text},
        belongs=[gid(method=label) for label in scores.index],
    )
    said = "One evaluation is one run of the model."
    if scores["referenced"].any():
        said += (
            f" Error: |pf - reference| / reference, Eq. (49). An answer is within {_RIGHT} also "
            "where two standard errors of the reference are more."
        )
    if scores["unchecked"].any():
        said += f" Unchecked: {UNCHECKED}."
    page.text(said, small=True)


def _add_right(page: Page, scores: pd.DataFrame) -> None:
    title = "Who was right?"
    ranked = scores.sort_values(["right", "n_evals"], ascending=[False, True], kind="stable")
    most, asked = ranked[["right", "referenced"]].iloc[0]
    if most == 0:
        page.card(title, "Nobody", f"No answer is within {_RIGHT} of its reference.", tone="bad")
        return
    more = [f"Within {_RIGHT} on {most} of {asked} criteria."]
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
        most = count_text(answering["n_evals"][dearest])
        more.append(f"The most: {literal(dearest)} with {most}.")
    page.card(title, f"{count_text(int(evals))} evaluations", *more)


def _add_failures(page: Page, scores: pd.DataFrame) -> None:
    asked = scores["asked"].sum()
    said = {
        status: f"{n} of {asked} answers {words.format(are='is' if n == 1 else 'are')}"
        for status, (words, _) in _STATUSES.items()
        if (n := scores[status].sum()) > 0
    }
    tone = _STATUSES[next(iter(said))][1]
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


def _methods(scores: pd.DataFrame) -> pd.DataFrame:
    import pandas as pd

    rows = scores.to_dict("records")
    columns: dict[str, Any] = {
        "method": scores.index,
        "status": [_status(row) for row in rows],
        "answered": [Cell(f"{row['answered']} of {row['asked']}", row["answered"]) for row in rows],
    }
    if scores["referenced"].any():
        columns |= {
            "median error": scores["median_error"].array,
            "largest": scores["largest_error"].array,
            f"within {_RIGHT}": [
                Cell(f"{row['right']} of {row['referenced']}", row["right"]) for row in rows
            ],
            "interval covers": [_cover(row) for row in rows],
        }
    columns |= {"evaluations": scores["n_evals"].array, "time": scores["seconds"].array}
    return pd.DataFrame(columns)


def _error_text(error: float) -> str:
    return "no answer" if math.isnan(error) else typeset(percent(error))


def _cover(row: dict[Any, Any]) -> Cell:
    if not row["stated"]:
        return Cell("none stated", math.nan)
    return Cell(f"{row['cover']} of {row['stated']}", row["cover"] / row["stated"])


def _status(row: dict[Any, Any]) -> Cell:
    """Return how often each status occurs, in the tone of the worst."""
    occurring = [status for status in _STATUSES if row[status]]
    listed = [f"{row[one]} {one.replace('_', ' ')}" for one in occurring if one != "converged"]
    return Cell(", ".join(listed) or "converged", tone=_STATUSES[occurring[0]][1])
