"""Records of a comparison on disk: how it was made, and every row.

The format is described in ``docs/records.md``. Two files hold the same rows: ``comparison.json``
with everything, from which `read_records` gets the very same frame back, and ``comparison.csv``
for other programs.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.checks import path as checked_path
from uqfold.comparison.columns import COLUMNS, rows_of, rows_to_frame
from uqfold.comparison.csv_cells import csv_text
from uqfold.comparison.encoding import decoded, encoded, parsed_json
from uqfold.comparison.frames import checked_frame
from uqfold.comparison.header import ATTRIBUTE, checked_header
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = "uqfold-comparison/3"
EARLIER = "uqfold-comparison/2"
"""As `SCHEMA`, without ``source`` and ``finished``."""
JSON_NAME = "comparison.json"
CSV_NAME = "comparison.csv"


class RecordsError(ValueError):
    """A file is not a record of a comparison, or a damaged one."""


def write_records(frame: pd.DataFrame, folder: str | os.PathLike[str]) -> tuple[Path, Path]:
    """Write ``comparison.csv`` and ``comparison.json`` into a folder, made if it is missing.

    Each file appears whole or not at all: an interrupted write leaves the earlier one.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or a part of it; see `checked_frame`.
    folder
        Where to.

    Returns
    -------
    tuple[pathlib.Path, pathlib.Path]
        The two files, CSV first.

    Raises
    ------
    ValueError
        If the frame is not one of a comparison.
    OSError
        If a file cannot be written.
    """
    checked = checked_frame(frame)
    directory = checked_path("folder", folder)
    directory.mkdir(parents=True, exist_ok=True)
    paths = directory / CSV_NAME, directory / JSON_NAME
    rows = list(rows_of(checked))
    for path, text in zip(
        paths, (csv_text(COLUMNS, rows), _json_text(checked.attrs[ATTRIBUTE], rows)), strict=True
    ):
        write_text(path, text)
    return paths


def read_records(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read the records of a comparison; their numbers are those written, to the last bit.

    Parameters
    ----------
    path
        A ``comparison.json``, or the folder that holds it.

    Returns
    -------
    pandas.DataFrame
        The frame that was written, with its header in ``attrs``.

    Raises
    ------
    RecordsError
        If the file is not of the schema `SCHEMA` or `EARLIER`, or is damaged.
    OSError
        If it cannot be opened.
    """
    file = checked_path("path", path)
    if file.is_dir():
        file = file / JSON_NAME
    try:
        return _frame(parsed_json(file.read_text(encoding="utf-8")))
    except (ValueError, KeyError, TypeError) as error:
        what = f"the field {error} is missing" if isinstance(error, KeyError) else str(error)
        raise RecordsError(
            f"{file.name} is no readable record of a comparison: {what}. Records are written by "
            "`uqfold compare`; see docs/records.md"
        ) from error


def _json_text(header: Mapping[str, Any], rows: list[dict[str, Any]]) -> str:
    written = [{name: encoded(value) for name, value in row.items()} for row in rows]
    document = {"schema": SCHEMA, **header, "columns": list(COLUMNS)}
    document["sha256"] = _digest({**document, "rows": written})
    above = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row, ensure_ascii=False, allow_nan=False) for row in written)
    return f'{above},\n "rows": [\n{lines}\n ]\n}}\n'


def _digest(document: Mapping[str, Any]) -> str:
    """Digest of all that a record says, however it is laid out."""
    said = {name: value for name, value in document.items() if name != "sha256"}
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()


def _frame(document: Any) -> pd.DataFrame:
    if not isinstance(document, Mapping):
        raise TypeError("it holds no JSON object")
    if document.get("schema") not in (SCHEMA, EARLIER):
        raise ValueError(f"its schema is {document.get('schema')!r}, not {SCHEMA!r}")
    if document["columns"] != list(COLUMNS):
        raise ValueError(f"its columns are not those of {SCHEMA}")
    rows = [_row(row, i) for i, row in enumerate(document["rows"])]
    finished = list(dict.fromkeys(row["label"] for row in rows))
    unknown = {"source": {}, "finished": finished} if document["schema"] == EARLIER else {}
    header = checked_header({**document, **unknown})
    if unasked := set(finished) - {one["label"] for one in header["methods"]}:
        raise ValueError(f"it has rows of {min(unasked)!r}, which is none of its methods")
    # version 0.1.0 wrote no digest at first
    if document.get("sha256", digest := _digest(document)) != digest:
        raise ValueError("it is damaged: it does not have the digest that it states")
    frame = rows_to_frame(rows)
    frame.attrs[ATTRIBUTE] = header
    return frame


def _row(row: Mapping[str, Any], index: int) -> dict[str, Any]:
    if list(row) != list(COLUMNS):
        raise ValueError(f"row {index} has not the columns of the record")
    return {
        name: decoded(row[name], kind, f"row {index}, {name}") for name, kind in COLUMNS.items()
    }
