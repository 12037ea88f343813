"""The results of a study on disk: tables as CSV, and the record of how they were made."""

from __future__ import annotations

import csv
import datetime
import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from uqfold.comparison.csv_cells import csv_text, text_of_cell
from uqfold.comparison.encoding import parsed_json
from uqfold.comparison.studies.runner import StudyTable
from uqfold.comparison.studies.study import Study
from uqfold.provenance import versions
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = "uqfold-study-results/1"
FOLDER = "results"
RECORD_NAME = "record.json"

State = Literal["missing", "incomplete", "of another study.toml", "changed by hand", "present"]


class ResultsError(ValueError):
    """Results are missing, damaged, or not those of the study."""


@dataclass(frozen=True)
class TableEntry:
    """What the record says of one table: rows, model runs, seconds, and digest of its file."""

    name: str
    rows: int
    n_evals: int
    seconds: float
    sha256: str


@dataclass(frozen=True)
class ResultsRecord:
    """How results were made.

    Attributes
    ----------
    study
        Digest of what the study asks for.
    quick
        Whether they are of the reduced form.
    date
        When, UTC, ISO 8601.
    command
        The command, without absolute paths.
    versions
        Versions of what the numbers depend on.
    tables
        The tables, in order.
    """

    study: str
    quick: bool
    date: str
    command: str
    versions: Mapping[str, str]
    tables: tuple[TableEntry, ...]


def write_table(folder: Path, table: StudyTable) -> TableEntry:
    """Write one table as ``results/<name>.csv`` below a folder."""
    text = csv_text(table.columns, table.rows)
    path = _csv_path(folder, table.name)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return TableEntry(table.name, len(table.rows), table.n_evals, round(table.seconds, 3), digest)


def write_record(
    folder: Path, study: Study, command: str, tables: Sequence[TableEntry]
) -> ResultsRecord:
    """Write the record of finished results, and give it."""
    record = ResultsRecord(
        study=study.digest,
        quick=study.quick,
        date=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        command=command,
        versions=versions(),
        tables=tuple(tables),
    )
    document = {
        "schema": SCHEMA,
        **{name: value for name, value in vars(record).items() if name != "tables"},
        "tables": [vars(entry) for entry in record.tables],
    }
    text = json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    write_text(folder / FOLDER / RECORD_NAME, text)
    return record


def read_record(folder: Path) -> ResultsRecord:
    """Read the record of a study's results.

    Raises
    ------
    ResultsError
        If there is none, or it is damaged.
    """
    path = folder / FOLDER / RECORD_NAME
    try:
        document = parsed_json(path.read_text(encoding="utf-8"))
        if document.pop("schema") != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        tables = tuple(TableEntry(**entry) for entry in document.pop("tables"))
        return ResultsRecord(**document, tables=tables)
    except FileNotFoundError as error:
        raise ResultsError("there are no results: uqfold study run makes them") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ResultsError(f"{RECORD_NAME} is no record of results: {error}") from error


def read_tables(folder: Path, columns: Mapping[str, Mapping[str, type]]) -> dict[str, pd.DataFrame]:
    """Read the tables of a study as pandas frames, numbers to the last bit.

    Parameters
    ----------
    folder
        The folder that holds ``results/``.
    columns
        Name -> columns and types of the tables to read.

    Raises
    ------
    ResultsError
        If one is missing or has not these columns.
    """
    return {name: _read_table(folder, name, kinds) for name, kinds in columns.items()}


def results_state(study: Study) -> State:
    """Say whether a study's results are there, complete, and those of its present file."""
    try:
        record = read_record(study.folder)
    except ResultsError:
        return "incomplete" if (study.folder / FOLDER).is_dir() else "missing"
    if record.study != study.digest:
        return "of another study.toml"
    for entry in record.tables:
        try:
            content = _csv_path(study.folder, entry.name).read_bytes()
        except OSError:
            return "incomplete"
        if hashlib.sha256(content).hexdigest() != entry.sha256:
            return "changed by hand"
    return "present"


def _csv_path(folder: Path, name: str) -> Path:
    return folder / FOLDER / f"{name}.csv"


def _read_table(folder: Path, name: str, columns: Mapping[str, type]) -> pd.DataFrame:
    import pandas as pd

    path = _csv_path(folder, name)
    try:
        with path.open(encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file)
    except (OSError, ValueError, csv.Error) as error:
        raise ResultsError(f"{FOLDER}/{path.name} cannot be read: {error}") from error
    if list(map(text_of_cell, head)) != list(columns):
        raise ResultsError(f"{FOLDER}/{path.name} has other columns than this study's {name}")
    try:
        values = {
            column: [_decoded(row[i], kind) for row in rows]
            for i, (column, kind) in enumerate(columns.items())
        }
    except (ValueError, IndexError) as error:
        raise ResultsError(f"{FOLDER}/{path.name} is damaged: {error}") from error
    dtypes = {float: "float64", int: None, str: str}
    return pd.DataFrame(
        {column: pd.Series(values[column], dtype=dtypes[kind]) for column, kind in columns.items()}
    )


def _decoded(cell: str, kind: type) -> Any:
    if kind is float:
        return float(cell) if cell else math.nan
    return text_of_cell(cell) if kind is str else kind(cell)
