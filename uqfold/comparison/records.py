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
from uqfold.comparison.columns import ATTRIBUTE, COLUMNS, rows_to_frame
from uqfold.comparison.form import RECORD, SCHEMA, encoded
from uqfold.comparison.frames import checked_frame
from uqfold.comparison.header import checked_header
from uqfold.documents import read_record
from uqfold.writing import write_text

if TYPE_CHECKING:
    import pandas as pd

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
    write_text(directory / CSV_NAME, checked.to_csv(index=False, lineterminator="\n"))
    write_text(directory / JSON_NAME, _json_text(checked))
    return directory / CSV_NAME, directory / JSON_NAME


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
    return read_record(file, _frame, (SCHEMA, EARLIER), RecordsError, "uqfold compare")


def _json_text(frame: pd.DataFrame) -> str:
    document = encoded({"schema": SCHEMA, **frame.attrs[ATTRIBUTE], "columns": list(COLUMNS)})
    written = encoded(frame.to_dict("records"))
    document["sha256"] = _digest({**document, "rows": written})
    above = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row, ensure_ascii=False, allow_nan=False) for row in written)
    return f'{above},\n "rows": [\n{lines}\n ]\n}}\n'


def _digest(document: Mapping[str, Any]) -> str:
    """Digest of all that a record says, however it is laid out."""
    stated = {name: value for name, value in document.items() if name != "sha256"}
    return hashlib.sha256(json.dumps(stated, sort_keys=True).encode()).hexdigest()


def _frame(document: Mapping[str, Any]) -> pd.DataFrame:
    schema = document["schema"]
    later = {"schema": SCHEMA, "source": {}, "finished": []} if schema == EARLIER else {}
    record = RECORD.validate_python({**document, **later}, strict=True)
    if record["columns"] != list(COLUMNS):
        raise ValueError(f"its columns are not those of {SCHEMA}")
    with_rows = list(dict.fromkeys(row["label"] for row in record["rows"]))
    header = checked_header(record)
    if schema == EARLIER:
        header["finished"] = with_rows
    if unasked := set(with_rows) - {one["label"] for one in header["methods"]}:
        raise ValueError(f"it has rows of {min(unasked)!r}, which is none of its methods")
    # the first records had no digest
    if document.get("sha256", digest := _digest(document)) != digest:
        raise ValueError("it is damaged: it does not have the digest that it states")
    frame = rows_to_frame(record["rows"])
    frame.attrs[ATTRIBUTE] = header
    return frame
