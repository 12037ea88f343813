"""Texts in cells of a CSV file, which a spreadsheet shows and does not execute.

Text that a spreadsheet takes for a formula gets an apostrophe in front, which `text_of_cell` takes
away again.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from uqfold.comparison.columns import COLUMNS

if TYPE_CHECKING:
    import pandas as pd

TEXTS = [name for name, kind in COLUMNS.items() if kind is str]
# with the wide signs of East Asian scripts, which some spreadsheets take for the others
_FORMULA = re.compile(r"'*(?:\s*[=+\-@\uff1d\uff0b\uff0d\uff20]|[\t\r\n])")


def csv_text(frame: pd.DataFrame) -> str:
    """Return the rows of a comparison as comma-separated values.

    Numbers are written in the shortest form that reads back to the same bits; NaN as nothing.
    """
    safe = frame.assign(**{name: frame[name].map(cell_of_text) for name in TEXTS})
    # with this end of a line a carriage return in a text is quoted too
    text: str = safe.to_csv(index=False, lineterminator="\r\n")
    return text.replace("\r\n", "\n")


def cell_of_text(text: str) -> str:
    """Return the text as it stands in a cell.

    >>> cell_of_text("=1+1"), cell_of_text("mc"), text_of_cell(cell_of_text("'=1+1"))
    ("'=1+1", 'mc', "'=1+1")
    """
    return f"'{text}" if _FORMULA.match(text) else text


def text_of_cell(cell: str) -> str:
    """Return the text that `cell_of_text` was given."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell
