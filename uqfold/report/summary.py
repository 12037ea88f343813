"""The summary of a comparison: who was right, at what cost, what failed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from statistics import median
from typing import TYPE_CHECKING, Any

from uqfold.plots.telling import gid
from uqfold.plots.wording import Row, count_text, percent, seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Cell, Tone, typeset
from uqfold.report.page.markup import literal
from uqfold.report.scores import (
    NOT_CONVERGED,
    RIGHT_WITHIN,
    MethodScore,
    method_scores,
    spreads,
)
from uqfold.report.wording import UNCHECKED

if TYPE_CHECKING:
    import pandas as pd

_RIGHT = f"{100 * RIGHT_WITHIN:g} %"
_FAULTS = ("budget_exhausted", "doubtful", "failed")
_SHARE_TO_NAME = 3
"""Methods named one by one in a card; the table below has them all."""
_MOST_LINES = 3
"""Statements below the answer of a card, so that the summary stays on one screen."""


def add_summary(page: Page, rows: Sequence[Row]) -> None:
    """Add the first screen of the report on a comparison: cards, and one line per method."""
    scored = method_scores(rows)
    _add_right(page, rows, scored)
    _add_cost(page, scored)
    _add_failures(page, scored)
    page.table(
        _methods(scored),
        "Methods",
        name="methods-in-short",
        belongs=[gid(method=one.label) for one in scored],
    )
    said = "One evaluation is one run of the model."
    if any(one.referenced for one in scored):
        said += (
            f" Error: |pf - reference| / reference, Eq. (49). An answer is within {_RIGHT} also "
            "where two standard errors of the reference are more."
        )
    if any(one.statuses["unchecked"] for one in scored):
        said += f" Unchecked: {UNCHECKED}."
    page.text(said, small=True)


def _add_right(page: Page, rows: Sequence[Row], scored: Sequence[MethodScore]) -> None:
    referenced = [one for one in scored if one.referenced]
    if not referenced:
        _add_agreement(page, rows)
        return
    ranked = sorted(referenced, key=lambda one: (-one.right, one.n_evals))
    best = ranked[0]
    title = "Who was right?"
    if best.right == 0:
        said = f"No answer is within {_RIGHT} of its reference."
        page.card(title, "Nobody", said, tone="bad")
        return
    equal = [one for one in ranked if one.right == best.right]
    rest = [one for one in ranked if one.right < best.right]
    more = [f"Within {_RIGHT} on {best.right} of {best.referenced} criteria."]
    if rest:
        more.append("; ".join(f"{literal(one.label)} on {one.right}" for one in rest) + ".")
    tone: Tone = "good" if best.right == best.referenced else "warn"
    page.card(title, _listed([one.label for one in equal]), *more, tone=tone)


def _add_agreement(page: Page, rows: Sequence[Row]) -> None:
    title, apart = "Do the methods agree?", spreads(rows)
    note = "There is no reference: nobody knows here who is right."
    if not apart:
        page.card(title, "Nothing to compare", note, tone="warn")
        return
    tone: Tone = "good" if max(apart) <= RIGHT_WITHIN else "warn"
    answer = f"To within {typeset(percent(max(apart)))}"
    half = f"Half of the criteria to within {typeset(percent(median(apart)))}."
    page.card(title, answer, half, note, tone=tone)


def _add_cost(page: Page, scored: Sequence[MethodScore]) -> None:
    title = "At what cost?"
    answering = [one for one in scored if one.answered]
    if not answering:
        page.card(title, "No answer at any cost", tone="bad")
        return
    # of those that were right most often the cheapest; without references all were right equally
    best = min(answering, key=lambda one: (-one.right, one.n_evals, one.seconds))
    which = "right most often" if best.right else "the cheapest with an answer"
    more = [f"{literal(best.label)}, {which}, took {seconds_text(best.seconds)}."]
    equal = [one for one in answering if one.right == best.right and one is not best]
    if best.right and equal:
        counts = dict.fromkeys(count_text(one.n_evals) for one in _by_cost(equal))
        more.append(f"As often right, with more: {_listed(list(counts))}.")
    right = [one for one in answering if one.always_right and one.right < best.right]
    if right:
        other = _by_cost(right)[0]
        share = "on the one criterion that it answers"
        if other.right > 1:
            share = f"on the {other.right} criteria that it answers"
        more.append(f"{literal(other.label)} was right {share}, with {count_text(other.n_evals)}.")
    dearest = max(answering, key=lambda one: one.n_evals)
    if dearest.n_evals > best.n_evals and len(more) < _MOST_LINES:
        more.append(f"The most: {literal(dearest.label)} with {count_text(dearest.n_evals)}.")
    page.card(title, f"{count_text(best.n_evals)} evaluations", *more)


def _by_cost(scored: Sequence[MethodScore]) -> list[MethodScore]:
    return sorted(scored, key=lambda one: one.n_evals)


def _add_failures(page: Page, scored: Sequence[MethodScore]) -> None:
    title = "What failed?"
    total: Counter[str] = sum((one.statuses for one in scored), Counter())
    rows = total.total()
    lost, refused = total["failed"], total["unsupported"]
    doubted, short = total["doubtful"], total["budget_exhausted"]
    unchecked = total["unchecked"]
    if rows == total["converged"]:
        page.card(title, "Nothing", f"All {rows} answers are converged.", tone="good")
        return
    if rows == total["converged"] + unchecked:
        page.card(title, "Nothing", _said_of(unchecked, rows))
        return
    named = [
        (lost, "failed"),
        (doubted, "doubtful"),
        (short, "out of budget, with an answer"),
        (refused, "not supported"),
    ]
    (first, word), *others = [(count, word) for count, word in named if count]
    tone: Tone = "bad" if lost else "warn" if doubted or short else ""
    if not lost and not doubted and not short:
        first, word, others = 0, "", [(refused, "not supported")]
    answer = f"{first} of {rows} {word}" if first else "Nothing"
    more = [f"Also {', '.join(f'{count} {name}' for count, name in others)}."] if others else []
    if not first:
        more = [f"{refused} of {rows} answers are outside what a method can do."]
    guilty = [one.label for one in scored if any(one.statuses[s] for s in _FAULTS)]
    if guilty:
        more.append(f"Concerns {_listed(guilty)}.")
    if unchecked:
        more.append(_said_of(unchecked, rows))
    page.card(title, answer, *more, tone=tone)


def _said_of(unchecked: int, rows: int) -> str:
    return f"{unchecked} of {rows} answers are unchecked."


def _listed(labels: Sequence[str]) -> str:
    if len(labels) > _SHARE_TO_NAME:
        others = len(labels) - _SHARE_TO_NAME + 1
        labels = [*labels[: _SHARE_TO_NAME - 1], f"{others} others"]
    *front, last = map(literal, labels)
    return f"{', '.join(front)} and {last}" if front else last


def _methods(scored: Sequence[MethodScore]) -> pd.DataFrame:
    import pandas as pd

    columns: dict[str, list[Any]] = {"method": [one.label for one in scored]}
    columns["status"] = [_status(one) for one in scored]
    columns["answered"] = [Cell(f"{one.answered} of {one.asked}", one.answered) for one in scored]
    if any(one.referenced for one in scored):
        columns["median error"] = [_error(one.median_error) for one in scored]
        columns["largest"] = [_error(max(one.errors, default=math.nan)) for one in scored]
        columns[f"within {_RIGHT}"] = [
            Cell(f"{one.right} of {one.referenced}", one.right) for one in scored
        ]
        columns["interval covers"] = [_cover(one) for one in scored]
    columns["evaluations"] = [one.n_evals for one in scored]
    columns["time"] = [Cell(seconds_text(one.seconds), one.seconds) for one in scored]
    return pd.DataFrame(columns)


def _error(error: float) -> Cell:
    return Cell("no answer" if math.isnan(error) else typeset(percent(error)), error)


def _cover(one: MethodScore) -> Cell:
    if not one.intervals:
        return Cell("none stated", math.nan)
    return Cell(f"{one.covering} of {one.intervals}", one.covering / one.intervals)


def _status(one: MethodScore) -> Cell:
    text = ", ".join(
        f"{count} {status.replace('_', ' ')}"
        for status in NOT_CONVERGED
        if (count := one.statuses[status])
    )
    tone: Tone = "good"
    if one.statuses["failed"]:
        tone = "bad"
    elif one.statuses["doubtful"] or one.statuses["budget_exhausted"]:
        tone = "warn"
    elif one.statuses["unsupported"]:
        tone = "quiet"
    elif one.statuses["unchecked"]:
        tone = ""
    return Cell(text or "converged", tone=tone)
