"""Records of a comparison on disk: what was asked, how it was run, and every row.

The format is described in ``docs/records.md``. Two files hold the same rows: ``comparison.json``
with everything, from which `read_records` gets the very same numbers back, and ``comparison.csv``
for other programs.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance, keep, several
from uqfold.checks import path as checked_path
from uqfold.comparison.columns import COLUMNS, Row, rows_to_frame
from uqfold.comparison.csv_cells import csv_text
from uqfold.comparison.encoding import decoded, encoded, parsed_json
from uqfold.comparison.header import RunHeader
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = "uqfold-comparison/2"
JSON_NAME = "comparison.json"
CSV_NAME = "comparison.csv"
HEADER_ATTRIBUTE = "uqfold-comparison"
"""Where a frame of a comparison carries its header, in ``frame.attrs``."""


class RecordsError(ValueError):
    """A file is no record of a comparison, or a damaged one."""


@dataclass(frozen=True)
class Records:
    """A comparison as it is kept: how it was made, and its rows.

    Attributes
    ----------
    header
        What was asked and how it was run.
    rows
        One mapping per method and criterion, with the columns of `columns.COLUMNS`.
    """

    header: RunHeader
    rows: tuple[Row, ...]

    def __post_init__(self) -> None:
        keep(self, "header", instance, RunHeader, "give a RunHeader")
        keep(self, "rows", several, instance, (Mapping,), "give a dict of column -> value")

    @property
    def finished(self) -> tuple[str, ...]:
        """Labels of the methods that have rows, in the order in which they ran."""
        return tuple(dict.fromkeys(row["label"] for row in self.rows))

    @property
    def complete(self) -> bool:
        """Whether every method that was asked for has its rows."""
        return self.finished == tuple(entry.label for entry in self.header.methods)

    def to_frame(self) -> pd.DataFrame:
        """Give the rows as `uqfold.compare` does; `records_from_frame` gives the records back."""
        frame = rows_to_frame(self.rows)
        frame.attrs[HEADER_ATTRIBUTE] = self.header.to_document()
        return frame


def write_records(records: Records, folder: str | os.PathLike[str]) -> tuple[Path, Path]:
    """Write ``comparison.csv`` and ``comparison.json`` into a folder, made if it is missing.

    Each file appears whole or not at all: an interrupted write leaves the earlier one.

    Returns
    -------
    tuple[pathlib.Path, pathlib.Path]
        The two files, CSV first.
    """
    instance("records", records, Records, "give Records")
    directory = checked_path("folder", folder)
    directory.mkdir(parents=True, exist_ok=True)
    paths = directory / CSV_NAME, directory / JSON_NAME
    texts = csv_text(COLUMNS, records.rows), _json_text(records)
    for path, text in zip(paths, texts, strict=True):
        write_text(path, text)
    return paths


def read_records(path: str | os.PathLike[str]) -> Records:
    """Read the records of a comparison; their numbers are those written, to the last bit.

    Parameters
    ----------
    path
        A ``comparison.json``, or the folder that holds it.

    Raises
    ------
    RecordsError
        If the file is not of the schema ``uqfold-comparison/2``, or is damaged.
    OSError
        If it cannot be opened.
    """
    file = checked_path("path", path)
    if file.is_dir():
        file = file / JSON_NAME
    try:
        return _parsed(parsed_json(file.read_text(encoding="utf-8")))
    except (ValueError, KeyError, TypeError) as error:
        what = f"the field {error} is missing" if isinstance(error, KeyError) else str(error)
        raise RecordsError(
            f"{file.name} is no readable record of a comparison: {what}. Records are written by "
            "`uqfold compare`; see docs/records.md"
        ) from error


def _json_text(records: Records) -> str:
    document = {
        "schema": SCHEMA,
        **records.header.to_document(),
        "columns": list(COLUMNS),
        "rows": [
            {name: encoded(kind(row[name])) for name, kind in COLUMNS.items()}
            for row in records.rows
        ],
    }
    document["sha256"] = _digest(document)
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _digest(document: Mapping[str, Any]) -> str:
    """Digest of all that a record says, however it is laid out."""
    said = {name: value for name, value in document.items() if name != "sha256"}
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _parsed(document: Any) -> Records:
    if not isinstance(document, Mapping):
        raise TypeError("it holds no JSON object")
    if document.get("schema") != SCHEMA:
        raise ValueError(f"its schema is {document.get('schema')!r}, not {SCHEMA!r}")
    if document["columns"] != list(COLUMNS):
        raise ValueError(f"its columns are not those of {SCHEMA}")
    header = RunHeader.from_document(document)
    rows = tuple(_parsed_row(row, i) for i, row in enumerate(document["rows"]))
    known = {entry.label for entry in header.methods}
    for label, n_rows in Counter(row["label"] for row in rows).items():
        if label not in known or n_rows != len(header.criteria):
            raise ValueError(
                f"it has {n_rows} rows of {label!r} for {len(header.criteria)} criteria"
            )
    # records of earlier versions carry none
    if document.get("sha256", digest := _digest(document)) != digest:
        raise ValueError("it is damaged: it does not have the digest that it states")
    return Records(header, rows)


def _parsed_row(row: Mapping[str, Any], index: int) -> Row:
    if list(row) != list(COLUMNS):
        raise ValueError(f"row {index} has not the columns of the record")
    return {
        name: decoded(row[name], kind, f"row {index}, {name}") for name, kind in COLUMNS.items()
    }
