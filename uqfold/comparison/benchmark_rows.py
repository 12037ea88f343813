"""The rows of a benchmark on disk: one JSON object a line, appended as the answers end.

The fields are those of `form.ANSWER`, told in ``docs/records.md``. Where a question was answered
several times, the last answer counts; a line that was cut off counts as if it were not there.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.checks import path as checked_path
from uqfold.comparison.columns import rows_to_frame
from uqfold.comparison.form import ANSWER, OF_BENCHMARK, encoded
from uqfold.comparison.records import RecordsError

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
    """
    file = checked_path("path", path)
    file = file / ROWS_NAME if file.is_dir() else file
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    rows = []
    for line in lines:
        with suppress(ValueError):
            rows.append(ANSWER.validate_json(line))
    if lines and not rows:
        raise RecordsError(f"{file.name} holds no rows of a benchmark: give another path")
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
