"""Reports from records, from frames, and from folders that hold records."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from uqfold.comparison.records import Records, read_records
from uqfold.report.page.blocks import Page
from uqfold.report.page.write import write_page

if TYPE_CHECKING:
    import pandas as pd

Source: TypeAlias = "Records | pd.DataFrame | str | os.PathLike[str]"
STEM = "report"


def report_page(source: Source) -> Page:
    """Make the report on a comparison.

    Parameters
    ----------
    source
        Records, a frame that `uqfold.compare` returned, or a folder or file with records.

    Raises
    ------
    uqfold.comparison.RecordsError
        If the records on disk cannot be read.
    ValueError
        If a frame is none of a comparison.
    OSError
        If a file cannot be opened.
    """
    from uqfold.report.comparison_page import comparison_page

    if isinstance(source, Records):
        return comparison_page(source)
    if isinstance(source, str | os.PathLike):
        return comparison_page(read_records(source))
    from uqfold.comparison.frames import records_from_frame

    return comparison_page(records_from_frame(source))


def write_report(
    source: Source, path: str | os.PathLike[str], *, format: str | None = None
) -> list[Path]:
    """Write the report on a comparison to one HTML file, or to Markdown with its pictures.

    No model is run, and nothing that the records name is imported.

    Parameters
    ----------
    source
        Records, a frame that `uqfold.compare` returned, or a folder or file with records.
    path
        Where to; its folder is made if it is missing.
    format
        ``html`` or ``md``; None: as the suffix of the path says.

    Returns
    -------
    list[pathlib.Path]
        The files written, the report first.

    Examples
    --------
    >>> frame = uqfold.compare(uqfold.problems.series(), "ffni-spa")  # doctest: +SKIP
    >>> uqfold.report.write_report(frame, "report.html")  # doctest: +SKIP
    """
    return write_page(report_page(source), path, format)
