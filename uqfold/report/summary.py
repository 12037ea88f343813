"""The summary of a comparison: who was right, at what cost, what failed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from statistics import median

from uqfold.comparison.records import Records
from uqfold.report.chart_data import method_keys
from uqfold.report.judgement import (
    NOT_CONVERGED,
    RIGHT_WITHIN,
    Judgement,
    judgements,
    spreads,
)
from uqfold.report.page.blocks import (
    Block,
    Card,
    Cards,
    Cell,
    Column,
    Number,
    Paragraph,
    Row,
    Table,
    Tone,
    Words,
)
from uqfold.report.page.chart import Strip
from uqfold.report.wording import UNCHECKED, count_text, percent, seconds_text

_RIGHT = f"{100 * RIGHT_WITHIN:g} %"
_FAULTS = ("budget_exhausted", "doubtful", "failed")
_SHARE_TO_NAME = 3
"""Methods named one by one in a card; the table below has them all."""
STRIP_ENDS = (1e-4, 10.0)
_MOST_LINES = 3
"""Statements below the answer of a card, so that the summary stays on one screen."""


def summary_blocks(records: Records) -> tuple[Block, ...]:
    """Give the first screen of the report on a comparison."""
    judged = judgements(records)
    cards = Cards((_right_card(records, judged), _cost_card(judged), _failure_card(judged)))
    return (cards, _methods_table(records, judged), _legend(judged))


def _right_card(records: Records, judged: Sequence[Judgement]) -> Card:
    referenced = [one for one in judged if one.referenced]
    if not referenced:
        return _agreement_card(records)
    ranked = sorted(referenced, key=lambda one: (-one.right, one.n_evals))
    best = ranked[0]
    title = "Who was right?"
    if best.right == 0:
        return Card(
            title,
            "Nobody",
            (f"No answer is within {_RIGHT} of its reference.",),
            "bad",
        )
    equal = [one for one in ranked if one.right == best.right]
    rest = [one for one in ranked if one.right < best.right]
    more = [f"Within {_RIGHT} on {best.right} of {best.referenced} criteria."]
    if rest:
        more.append("; ".join(f"{one.label} on {one.right}" for one in rest) + ".")
    tone: Tone = "good" if best.right == best.referenced else "warn"
    return Card(title, _listed([one.label for one in equal]), tuple(more), tone)


def _agreement_card(records: Records) -> Card:
    title, apart = "Do the methods agree?", spreads(records)
    note = "There is no reference: nobody knows here who is right."
    if not apart:
        return Card(title, "Nothing to compare", (note,), "warn")
    tone: Tone = "good" if max(apart) <= RIGHT_WITHIN else "warn"
    answer = f"To within {percent(max(apart))}"
    more = (f"Half of the criteria to within {percent(median(apart))}.", note)
    return Card(title, answer, more, tone)


def _cost_card(judged: Sequence[Judgement]) -> Card:
    title = "At what cost?"
    answering = [one for one in judged if one.answered]
    if not answering:
        return Card(title, "No answer at any cost", (), "bad")
    # of those that were right most often the cheapest; without references all were right equally
    best = min(answering, key=lambda one: (-one.right, one.n_evals, one.seconds))
    which = "right most often" if best.right else "the cheapest with an answer"
    more = [f"{best.label}, {which}, took {seconds_text(best.seconds)}."]
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
        more.append(f"{other.label} was right {share}, with {count_text(other.n_evals)}.")
    dearest = max(answering, key=lambda one: one.n_evals)
    if dearest.n_evals > best.n_evals and len(more) < _MOST_LINES:
        more.append(f"The most: {dearest.label} with {count_text(dearest.n_evals)}.")
    return Card(title, f"{count_text(best.n_evals)} evaluations", tuple(more))


def _by_cost(judged: Sequence[Judgement]) -> list[Judgement]:
    return sorted(judged, key=lambda one: one.n_evals)


def _failure_card(judged: Sequence[Judgement]) -> Card:
    title = "What failed?"
    total: Counter[str] = sum((one.statuses for one in judged), Counter())
    rows = total.total()
    lost, refused = total["failed"], total["unsupported"]
    doubted, short = total["doubtful"], total["budget_exhausted"]
    unchecked = total["unchecked"]
    if rows == total["converged"]:
        return Card(title, "Nothing", (f"All {rows} answers are converged.",), "good")
    if rows == total["converged"] + unchecked:
        return Card(title, "Nothing", (_said_of(unchecked, rows),))
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
    guilty = [one.label for one in judged if any(one.statuses[s] for s in _FAULTS)]
    if guilty:
        more.append(f"Concerns {_listed(guilty)}.")
    if unchecked:
        more.append(_said_of(unchecked, rows))
    return Card(title, answer, tuple(more), tone)


def _said_of(unchecked: int, rows: int) -> str:
    return f"{unchecked} of {rows} answers are unchecked."


def _listed(labels: Sequence[str]) -> str:
    if len(labels) > _SHARE_TO_NAME:
        others = len(labels) - _SHARE_TO_NAME + 1
        labels = [*labels[: _SHARE_TO_NAME - 1], f"{others} others"]
    *front, last = labels
    return f"{', '.join(front)} and {last}" if front else last


def _methods_table(records: Records, judged: Sequence[Judgement]) -> Table:
    keys = method_keys(records)
    referenced = any(one.referenced for one in judged)
    columns = [Column("method")]
    if referenced:
        columns += [
            Column("errors"),
            Column("median", numeric=True),
            Column("largest", numeric=True),
            Column(f"within {_RIGHT}", numeric=True),
            Column("interval covers", numeric=True),
        ]
    columns += [
        Column("answered", numeric=True),
        Column("evaluations", numeric=True),
        Column("time", numeric=True),
        Column("status"),
    ]
    rows = []
    for one in judged:
        cells = [Cell(one.label, key=keys[one.label])]
        if referenced:
            cells += _error_cells(records, one)
        cells += [
            Cell(f"{one.answered} of {one.asked}", float(one.answered)),
            Cell(count_text(one.n_evals), float(one.n_evals)),
            Cell(seconds_text(one.seconds), one.seconds),
            _status_cell(one),
        ]
        rows.append(Row(tuple(cells)))
    return Table("Methods", tuple(columns), tuple(rows), show_caption=False)


def _error_cells(records: Records, one: Judgement) -> list[Cell]:
    key = method_keys(records)[one.label]
    largest = max(one.errors, default=math.nan)
    strip = Strip(key, one.errors, one.median_error, STRIP_ENDS, (RIGHT_WITHIN,))
    said = f"{len(one.errors)} errors, median {percent(one.median_error)}"
    return [
        Cell(said, one.median_error, strip=strip) if one.errors else Cell("no answer", math.nan),
        Cell(_typeset(percent(one.median_error)), one.median_error),
        Cell(_typeset(percent(largest)), largest),
        Cell(f"{one.right} of {one.referenced}", float(one.right)),
        Cell(f"{one.covering} of {one.intervals}", one.covering / one.intervals)
        if one.intervals
        else Cell("none stated", math.nan, "quiet"),
    ]


def _typeset(text: str) -> Words:
    return [Number(text)]


def _status_cell(one: Judgement) -> Cell:
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


def _legend(judged: Sequence[Judgement]) -> Paragraph:
    said = "One evaluation is one run of the model."
    if any(one.referenced for one in judged):
        low, high = (percent(end) for end in STRIP_ENDS)
        said += (
            f" Error: |pf - reference| / reference, Eq. (49), per criterion on a logarithmic line "
            f"from {low} to {high}; the dashed line is {_RIGHT}. A criterion counts as within "
            "that also where two standard errors of the reference are more."
        )
    if any(one.statuses["unchecked"] for one in judged):
        said += f" Unchecked: {UNCHECKED}."
    return Paragraph(said, small=True)
