"""Tables as comma-separated values that a spreadsheet shows and does not execute.

Numbers are written as `encoding.encoded` has them, and an empty cell stands for "none". Text that a
spreadsheet takes for a formula gets an apostrophe in front, which `text_of_cell` takes away again.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping
from typing import Any

from uqfold.comparison.encoding import encoded

# with the wide signs of East Asian scripts, which some spreadsheets take for the others
_FORMULA = re.compile(r"'*(?:\s*[=+\-@\uff1d\uff0b\uff0d\uff20]|[\t\r\n])")


def csv_text(columns: Mapping[str, type], rows: Iterable[Mapping[str, Any]]) -> str:
    """Return a table as text.

    Parameters
    ----------
    columns
        Column -> type (`str`, `int`, `float`) of its values.
    rows
        Column -> value, for every row.
    """
    lines = _Lines()
    # this end of a line has a carriage return in a text quoted too
    writer = csv.writer(lines, lineterminator="\r\n")
    writer.writerow(map(cell_of_text, columns))
    for row in rows:
        writer.writerow(_cell(kind(row[name])) for name, kind in columns.items())
    return "".join(lines)


def cell_of_text(text: str) -> str:
    """Return the text as it stands in a cell.

    >>> cell_of_text("=1+1"), cell_of_text("mc"), text_of_cell(cell_of_text("'=1+1"))
    ("'=1+1", 'mc', "'=1+1")
    """
    return f"'{text}" if _FORMULA.match(text) else text


def text_of_cell(cell: str) -> str:
    """Return the text that `cell_of_text` was given."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


class _Lines(list[str]):
    def write(self, line: str) -> None:
        self.append(line.removesuffix("\r\n") + "\n")


def _cell(value: float | str) -> float | str:
    if isinstance(value, str):
        return cell_of_text(value)
    written = encoded(value)
    return "" if written is None else written
