"""The report of a study: one page in Markdown, made from its results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from uqfold.comparison.studies.results import FOLDER, ResultsRecord
from uqfold.comparison.studies.study import Spec, Study
from uqfold.report.studies.exhibits import FIGURES_FOLDER
from uqfold.report.wording import UNCHECKED, count_text, seconds_text
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

NAME = "report.md"
MOST_NOTES = 12
"""Messages of methods that the page shows; the tables hold all of them."""


def write_page(
    study: Study,
    record: ResultsRecord,
    results: Mapping[str, pd.DataFrame],
    shown: Mapping[str, pd.DataFrame],
    folder: Path,
) -> Path:
    """Write ``report.md``.

    Parameters
    ----------
    study
        What was asked.
    record
        How it was answered.
    results
        The tables behind it, by name.
    shown
        The tables to print, by name.
    folder
        Where to.

    Returns
    -------
    pathlib.Path
        The file.
    """
    blocks = [
        f"# {study.title}",
        "_Reduced form: fewer points than the study asks for._" if study.quick else "",
        study.question.strip(),
        study.notes.strip(),
        *_tables(study.tables, shown),
        *_figures(study.figures),
        *_references(results["problems"]),
        *_notes(study, results),
        *_making(study, record),
    ]
    path = folder / NAME
    folder.mkdir(parents=True, exist_ok=True)
    write_text(path, "\n\n".join(filter(None, blocks)) + "\n")
    return path


def markdown_table(frame: pd.DataFrame) -> str:
    """Write a frame as a Markdown table."""
    head = [str(column) for column in frame.columns]
    lines = [head, ["---"] * len(head)]
    lines += [[str(value) for value in row] for row in frame.itertuples(index=False, name=None)]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in line) + " |"
        for line in lines
    )


def _tables(specs: tuple[Spec, ...], shown: Mapping[str, pd.DataFrame]) -> Iterator[str]:
    if specs:
        yield "## Tables"
    for spec in specs:
        yield f"### {spec.title or spec.name}"
        yield markdown_table(shown[spec.name])
        yield spec.caption.strip()


def _figures(specs: tuple[Spec, ...]) -> Iterator[str]:
    if specs:
        yield "## Figures"
    for spec in specs:
        title = spec.title or spec.name
        yield f"### {title}"
        yield f"![{title}]({FIGURES_FOLDER}/{spec.name}.{spec.kind.picture})"
        yield spec.caption.strip()


def _references(problems: pd.DataFrame) -> Iterator[str]:
    """Say where the references come from."""
    known = problems[problems["reference_kind"] != ""]
    if known.empty:
        return
    yield "## References"
    for how, rows in known.groupby("reference_how", sort=False):
        names = ", ".join(f"`{name}`" for name in rows["problem"])
        yield f"{names}: {how} Made by `{rows['reference_command'].iloc[0]}`."


def _notes(study: Study, results: Mapping[str, pd.DataFrame]) -> Iterator[str]:
    """Give what methods said about rows that did not converge."""
    said: dict[str, int] = {}
    for run in study.runs:
        frame = results[run.name]
        for row in frame[frame["status"] != "converged"].to_dict("records"):
            why = row["message"] or UNCHECKED
            note = f"{row['label']}, {row['status']}: {why}"
            said[note] = said.get(note, 0) + 1
    if not said:
        return
    yield "## What the methods say of their own answers"
    ordered = sorted(said.items(), key=lambda item: -item[1])
    lines = [f"- {note} ({count} rows)" for note, count in ordered[:MOST_NOTES]]
    if len(ordered) > MOST_NOTES:
        lines.append(f"- and {len(ordered) - MOST_NOTES} further messages, in the tables")
    yield "\n".join(lines)


def _making(study: Study, record: ResultsRecord) -> Iterator[str]:
    """Say how the results were made, from what, and how long it took."""
    yield "## How it was made"
    yield f"`{record.command}`, {record.date}; " + ", ".join(
        f"{name} {version}" for name, version in record.versions.items()
    )
    lines = [["table", "rows", "model runs", "time"], ["---", "--:", "--:", "--:"]]
    lines += [
        [
            f"[{entry.name}]({FOLDER}/{entry.name}.csv)",
            count_text(entry.rows),
            count_text(entry.n_evals),
            seconds_text(entry.seconds),
        ]
        for entry in record.tables
    ]
    yield "\n".join("| " + " | ".join(line) + " |" for line in lines)
    yield "Times are of the run that made them; model runs kept from earlier ones take none."
    methods = dict.fromkeys(label for run in study.runs for label in run.methods)
    if methods:
        yield "\n".join(f"- `{label}`: `{study.methods[label]!r}`" for label in methods)
