"""The report on a comparison, as a page, and its figures as files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import uqfold
from uqfold.checks import path as checked_path
from uqfold.comparison.columns import ATTRIBUTE
from uqfold.plots.comparison_figure import comparison
from uqfold.plots.error_figure import error_against_evaluations
from uqfold.plots.rows import Comparable, answers_frame
from uqfold.plots.saving import save
from uqfold.plots.telling import gid
from uqfold.plots.wording import (
    drawable,
    panel_text,
    reference_resolution,
    response_text,
)
from uqfold.report.answers import NOT_JUDGED, answers_table, remarks, remarks_table
from uqfold.report.methods_section import add_methods, add_reproduction
from uqfold.report.page.builder import Page
from uqfold.report.page.markup import literal
from uqfold.report.summary import add_summary

if TYPE_CHECKING:
    import pandas as pd


class _Figure(NamedTuple):
    """A figure of every comparison that has a number in the column `needs`."""

    name: str
    needs: str
    draw: Callable[[Any], Any]
    section: str
    anchor: str
    title: str
    caption: str


_FIGURES = (
    _Figure(
        "comparison", "pf", comparison, "Answers", "curves",
        "Failure probability, and every method against it",
        "pf of every method over that of the reference, or else over the median of the methods, "
        "under the threshold that it belongs to. Bars are the intervals that methods state.",
    ),
    _Figure(
        "error-against-evaluations", "error", error_against_evaluations, "Error against cost",
        "cost", "Errors of all answers",
        "Error of Eq. (49), |pf - reference| / reference, against the evaluations of the model. "
        "Methods of equal cost stand side by side.",
    ),
)  # fmt: skip
_FORMATS = ("png", "svg")
_LEFT_OUT = "Standard errors of references below a millionth of pf are left out."


def figure_paths(folder: str | os.PathLike[str]) -> list[Path]:
    """Return the files that `write_figures` may write."""
    return [Path(folder) / f"{one.name}.{suffix}" for one in _FIGURES for suffix in _FORMATS]


def write_figures(frame: Comparable, folder: str | os.PathLike[str]) -> list[Path]:
    """Write the figures of a comparison as PNG and SVG.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or a part of it; or results of methods.
    folder
        Where to; made if it is missing.

    Returns
    -------
    list[pathlib.Path]
        The files written. Without any reference there is no figure of errors, and without any
        answer at a finite threshold no figure at all.
    """
    answers = answers_frame(frame, ("threshold", *(one.needs for one in _FIGURES)))
    directory = checked_path("folder", folder)
    directory.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for one in _FIGURES:
        if drawable(answers, one.needs):
            written += save(one.draw(answers), directory / one.name, _FORMATS)
    return written


def comparison_page(frame: pd.DataFrame) -> Page:
    """Make the report on a comparison; nothing that it names is imported or run.

    Parameters
    ----------
    frame
        The comparison, with its header in ``attrs``.
    """
    header, n = frame.attrs[ATTRIBUTE], frame["label"].nunique()
    page = Page(
        f"{header['problem']}: " + (f"{n} methods compared" if n > 1 else "one method"),
        _lead(frame),
        kind="Comparison of reliability methods",
        imprint=f"Made by uqfold {uqfold.__version__} from records of "
        f"{header['date'] or 'unknown date'}. Numbers are the recorded ones; no model was run.",
    )
    add_summary(page, frame)
    for one in _FIGURES:
        if drawable(frame, one.needs):
            page.section(one.section, name=one.anchor)
            page.figure(one.draw(frame), one.title, one.caption, name=one.name)
    _add_answers(page, frame)
    add_methods(page, frame)
    add_reproduction(page, header)
    return page


def _lead(frame: pd.DataFrame) -> str:
    header, said = frame.attrs[ATTRIBUTE], "Every method was asked for one failure probability"
    if (n := len(header["criteria"])) > 1:
        said = f"Every method was asked for the failure probability under the same {n} criteria"
    if response := response_text(frame):
        said += f"; response: {literal(response)}"
    if header["max_evals"] is not None:
        said += f"; at most {header['max_evals']:,} evaluations each"
    said += f"; seed {header['seed']}."
    finished = set(frame["label"])
    missing = [one["label"] for one in header["methods"] if one["label"] not in finished]
    if missing:
        said += f" Interrupted: no rows of {literal(', '.join(missing))}."
    return said


def _add_answers(page: Page, frame: pd.DataFrame) -> None:
    rows, unit = frame.to_dict("records"), frame.attrs[ATTRIBUTE]["response_unit"]
    page.section("All answers", name="all-answers")
    page.table(
        answers_table(frame),
        "Every answer, with the interval that the method states",
        belongs=[gid(method=row["label"], criterion=panel_text(row, unit)) for row in rows],
    )
    if any(row["error"] <= reference_resolution(row) for row in rows):
        page.text(literal(f"~: the error is {NOT_JUDGED}. {_LEFT_OUT}"), small=True)
    if numbers := remarks(rows):
        page.section("Remarks", name="remarks")
        page.table(
            remarks_table(rows),
            "What methods say about answers that did not converge",
            belongs=[gid(method=label) for label, _ in numbers],
        )
