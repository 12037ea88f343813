"""The rows of a benchmark on disk: one JSON object a line, appended as the answers end.

The fields are those of `form.ANSWER`, told in ``docs/records.md``. Where a question was answered
several times, the last answer counts; a line that was cut off counts as if it were not there.
"""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.checks import path as checked_path
from uqfold.comparison.columns import COLUMNS, rows_to_frame
from uqfold.comparison.form import ANSWER, OF_BENCHMARK, encoded
from uqfold.comparison.records import RecordsError
from uqfold.documents import parsed_json, said

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = "uqfold-benchmark/1"
ROWS_NAME = "rows.jsonl"
QUESTION = ["problem", "label", "max_evals", "threshold", "tau", "missions", "seed"]
"""Columns that tell the questions of a benchmark apart."""


def read_benchmark(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read the rows of a benchmark.

    Parameters
    ----------
    path
        The file, or the folder in which it is called ``rows.jsonl``.

    Returns
    -------
    pandas.DataFrame
        The last answer to every question, as `uqfold.benchmark` returns them.

    Raises
    ------
    RecordsError
        If the file holds something, but no row.
    OSError
        If it cannot be opened.

    Warns
    -----
    UserWarning
        If lines are left out that were not cut off, but hold no row that a method could have given.
    """
    file = checked_path("path", path)
    file = file / ROWS_NAME if file.is_dir() else file
    # a text within a row may hold other signs that Python takes for line ends
    lines = file.read_text(encoding="utf-8", errors="replace").rstrip("\n").split("\n")
    rows, wrong = [], []
    for number, line in enumerate(lines, 1):
        try:
            document = parsed_json(line)
        except ValueError:
            continue  # cut off
        try:
            rows.append(ANSWER.validate_python(document, strict=True))
        except (ValueError, TypeError) as error:
            what = (
                said(error, [*COLUMNS, *OF_BENCHMARK])
                if isinstance(error, ValueError)
                else str(error)
            )
            wrong.append(f"line {number}: {what}")
    if any(lines) and not rows:
        why = f" ({wrong[0]})" if wrong else ""
        raise RecordsError(f"{file.name} holds no rows of a benchmark{why}: give another path")
    if wrong:
        lost = f"{len(wrong)} of {len(lines)} lines hold no possible answer and are left out"
        warnings.warn(f"{file.name}: {lost}; {wrong[0]}", stacklevel=2)
    return benchmark_frame(rows).drop_duplicates(QUESTION, keep="last", ignore_index=True)


def append_rows(path: Path, rows: Iterable[Mapping[str, Any]]) -> None:
    """Append rows to a file at once, behind whatever an interruption left there."""
    text = "".join(f"{json.dumps(encoded(row), ensure_ascii=False)}\n" for row in rows)
    with path.open("a+b") as stream:
        stream.seek(max(0, stream.seek(0, os.SEEK_END) - 1))
        if stream.read() not in (b"", b"\n"):
            stream.write(b"\n")
        stream.write(text.encode(errors="backslashreplace"))


def benchmark_frame(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Return rows as a frame; ``covered`` is 1 or 0, and NaN without interval or reference."""
    import pandas as pd

    from uqfold.comparison.printed import BenchmarkFrame

    listed = list(rows)
    more = {
        name: pd.Series(
            [row[name] for row in listed],
            dtype={"max_evals": "float64", "covered": "float64", "inputs": "int64"}.get(name, str),
        )
        for name in OF_BENCHMARK
    }
    return BenchmarkFrame(rows_to_frame(listed).assign(**more))
