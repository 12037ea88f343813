"""Reports from records, from frames, and from folders that hold records."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from uqfold.checks import instance, refused, several
from uqfold.checks import path as checked_path
from uqfold.comparison.benchmark_rows import ROWS_NAME, read_benchmark
from uqfold.comparison.form import OF_BENCHMARK
from uqfold.comparison.frames import checked_frame
from uqfold.comparison.records import JSON_NAME, read_records
from uqfold.report.page.builder import Page, page_path
from uqfold.validation.kept import kept_records
from uqfold.validation.record import CaseRecord, read_case_record, read_case_records

if TYPE_CHECKING:
    import pandas as pd

Source: TypeAlias = "pd.DataFrame | Iterable[CaseRecord] | str | os.PathLike[str]"
MOST_ROWS = 10_000
"""Rows that a report on a comparison shows at most: a page of some 20 MB."""
_VALIDATION = re.compile(r'"schema":\s*"uqfold-validation/')
CASE_FILE = "case.toml"
KEPT_REPORT = "report.md"
"""The report on the records that are kept beside the cases, in their folder."""


def report_page(source: Source) -> Page:
    """Make the report on a comparison, a benchmark or validation cases.

    Parameters
    ----------
    source
        A frame that `uqfold.compare` or `uqfold.benchmark` returned, records of cases, or a folder
        that holds either (a file also, but for a benchmark): what the commands of these names or
        `uqfold validate` have written, or the folder of the cases with the records that are kept
        beside them.

    Raises
    ------
    uqfold.comparison.RecordsError, uqfold.validation.RecordError
        If the records on disk cannot be read.
    ValueError
        If a frame is none of a comparison, or there are no records.
    OSError
        If a file cannot be opened.
    """
    if isinstance(source, str | os.PathLike):
        return _page_of(checked_path("source", source))
    if hasattr(source, "columns"):
        from uqfold.report.benchmark_page import benchmark_page
        from uqfold.report.comparison_page import comparison_page

        frame: pd.DataFrame = source
        if set(OF_BENCHMARK) <= set(frame.columns):
            return benchmark_page(frame)
        rows = len(frame.index)
        if rows > MOST_ROWS:
            raise ValueError(
                f"the comparison has {rows:,} rows, a report shows {MOST_ROWS:,} at "
                "most: select thresholds or methods, as in frame[frame['label'] == 'mc']"
            )
        return comparison_page(checked_frame(frame))
    from uqfold.report.validation_page import validation_page

    try:
        listed = several("source", source, instance, CaseRecord, "give a CaseRecord")
    except TypeError as error:
        raise TypeError(f"{error}: records, a frame of uqfold.compare or a path") from None
    if not listed:
        raise refused("source", source, "there are no records in it, run `uqfold validate` first")
    return validation_page(list(listed))


def write_report(source: Source, path: str | os.PathLike[str]) -> list[Path]:
    """Write a report to one HTML file, or to Markdown with its pictures.

    No model is run, and nothing that the records name is imported.

    Parameters
    ----------
    source
        As for `report_page`.
    path
        Where to, a file that ends in ``.html`` or ``.md``; its folder is made if it is missing.

    Returns
    -------
    list[pathlib.Path]
        The files written, the report first.

    Examples
    --------
    >>> import tempfile, uqfold
    >>> frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in uqfold.report.write_report(frame, f"{folder}/report.html")]
    ['report.html']
    """
    page_path("path", path)
    return report_page(source).write(path)


def write_kept_report(cases: Path) -> list[Path]:
    """Write the report on the records kept beside the cases, as Markdown for the repository."""
    return write_report(kept_records(cases), cases / KEPT_REPORT)


def _page_of(path: Path) -> Page:
    """Make the report on a folder or file, after what it holds."""
    if path.is_dir():
        if (path / JSON_NAME).is_file():
            return report_page(read_records(path))
        if (path / ROWS_NAME).is_file():
            return report_page(read_benchmark(path))
        if next(path.glob(f"*/{CASE_FILE}"), None) is not None:
            return report_page(kept_records(path))
        if next(path.glob("*.json"), None) is None:
            raise ValueError(
                f"{path.name} holds no records: run `uqfold compare` or `uqfold validate` first"
            )
        return report_page(read_case_records(path))
    # quotes within a text are escaped, so this is the field itself
    if _VALIDATION.search(path.read_text(encoding="utf-8", errors="replace")):
        return report_page([read_case_record(path)])
    return report_page(read_records(path))
