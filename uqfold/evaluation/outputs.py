"""Reading the response from what a program has written."""

from __future__ import annotations

import math
import re
from collections import deque
from dataclasses import dataclass
from pathlib import Path

from uqfold.checks import keep, or_none, real, refused, text, whole
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.run_folder import STDOUT, file_inside, text_of

_NUMBER = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[ed]([+-]?\d+))?"
    # Fortran leaves the letter out where the exponent has three digits
    r"|([+-]?(?:\d+\.\d*|\.\d+))([+-]\d{3})"
    r"|([+-]?(?:inf|infinity|nan))",
    re.ASCII | re.IGNORECASE,
)
_BLANKS = " \t\n\v\f"
_BEFORE = re.compile(r"[0-9_.]\Z", re.ASCII)
_AFTER = re.compile(
    r"[0-9_]|\.[0-9]|[ed][+-]?[0-9]|[+-][0-9]{3}(?![0-9])", re.ASCII | re.IGNORECASE
)


@dataclass(frozen=True)
class Regex:
    r"""Reads a number by a regular expression: the group of its last match in a file.

    The group has to take the whole number: ``y = (\d+)`` is refused for ``y = 1.5``, of which it
    would take 1. How files and numbers are read is told at `number` and `run_folder.decoded`.

    Attributes
    ----------
    pattern
        Regular expression with one group around the number; lines are matched one by one.
    file
        File in the run's folder; by default what the program printed.

    Raises
    ------
    TypeError, ValueError
        If the pattern is not a regular expression with one group, or the file is not in the folder.
    """

    pattern: str
    file: str = STDOUT

    def __post_init__(self) -> None:
        keep(self, "pattern", text, what="a regular expression")
        keep(self, "file", file_inside)
        try:
            groups = re.compile(self.pattern).groups
        except (re.error, OverflowError, RecursionError) as error:
            raise refused(
                "pattern", self.pattern, f"give a regular expression ({error})"
            ) from error
        if groups != 1:
            raise refused("pattern", self.pattern, "give one group, around the number")

    def __call__(self, folder: Path) -> float:
        """Read the response from a run's folder."""
        content = text_of(folder, self.file)
        matches = deque(re.finditer(self.pattern, content, re.MULTILINE), maxlen=1)
        if not matches:
            raise ExternalRunError(f"{self.file} holds nothing that matches {self.pattern!r}")
        last = matches[0]
        found, (start, end) = last[1] or "", last.span(1)
        if found and (_BEFORE.search(content[:start][-1:]) or _AFTER.match(content, end)):
            raise ExternalRunError(
                f"the group of {self.pattern!r} takes {found!r}, a part of the number only"
            )
        return number(found)


@dataclass(frozen=True)
class Column:
    """Reads a number from a table of text.

    Attributes
    ----------
    file
        File in the run's folder.
    column
        Which column, from 0; negative ones count from the right.
    row
        Which line of those that are not empty, from 0; by default the last one.
    delimiter
        What separates columns; None: blanks and tabs.

    Raises
    ------
    TypeError, ValueError
        If a number is not whole, or the file is not in the folder.
    """

    file: str
    column: int
    row: int = -1
    delimiter: str | None = None

    def __post_init__(self) -> None:
        keep(self, "file", file_inside)
        keep(self, "column", whole)
        keep(self, "row", whole)
        keep(self, "delimiter", or_none, text, what="what separates columns")

    def __call__(self, folder: Path) -> float:
        """Read the response from a run's folder."""
        content = text_of(folder, self.file)
        lines = [one for line in content.split("\n") if (one := line.strip(_BLANKS))]
        try:
            line = lines[self.row]
            # other blanks, such as that in the number 1 500, separate nothing
            cells = re.split(f"[{_BLANKS}]+", line) if self.delimiter is None else None
            return number((cells or line.split(self.delimiter))[self.column])
        except IndexError:
            raise ExternalRunError(
                f"{self.file} has no column {self.column} in row {self.row}"
            ) from None


def response(value: object) -> float:
    """Return what an output reads as a number; text is read as `number` reads it.

    Raises
    ------
    ExternalRunError
        If it is not a number, or NaN.
    """
    try:
        y = number(value) if isinstance(value, str) else value
        if isinstance(y, float) and math.isnan(y):
            raise ExternalRunError("the output is NaN")
        return real("the output", y, finite=False)
    except (TypeError, ValueError) as error:
        raise ExternalRunError(str(error)) from error


def number(written: str) -> float:
    r"""Return the number that a program has written.

    As C and Fortran write it: ``-12``, ``1.5E+03``, ``1.5D+03``, ``1.5-103`` (for 1.5E-103),
    ``.5``, ``inf``, ``Infinity`` and ``nan`` in any case, with blanks around it. Anything else is
    refused: ``1_5``, ``1,5``, ``1.5 mm``, ``0x1p3``, digits of other scripts, and numbers too
    large for a float.

    Raises
    ------
    ExternalRunError
        If it is not such a number.

    Examples
    --------
    >>> number("1.5D+03"), number(" -Infinity\n")
    (1500.0, -inf)
    """
    match = _NUMBER.fullmatch(written.strip(_BLANKS))
    if match is None:
        raise ExternalRunError(f"{written!r} is not a number")
    digits, exponent = match[1] or match[3], match[2] or match[4]
    y = float(match[5] or f"{digits}e{exponent or 0}")
    if math.isinf(y) and match[5] is None:
        raise ExternalRunError(f"{written!r} is too large for a number of double precision")
    return y
