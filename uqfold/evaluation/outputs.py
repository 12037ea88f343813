"""Reading the response from what a program has written."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

STDOUT, STDERR = "stdout.txt", "stderr.txt"
"""Files in a run's folder that take what the program prints."""


class ExternalRunError(RuntimeError):
    """A run of the program failed; says why and where its folder is."""


@dataclass(frozen=True)
class Regex:
    """Reads a number by a regular expression: the group of its last match in a file.

    Attributes
    ----------
    pattern
        Regular expression with one group around the number; lines are matched one by one.
    file
        File in the run's folder; by default what the program printed.
    """

    pattern: str
    file: str = STDOUT

    def __post_init__(self) -> None:
        if re.compile(self.pattern).groups != 1:
            raise ValueError(f"pattern {self.pattern!r}: give one group, around the number")

    def __call__(self, folder: Path) -> float:
        """Read the response from a run's folder."""
        found = re.findall(self.pattern, (folder / self.file).read_text(), re.MULTILINE)
        if not found:
            raise ExternalRunError(f"{self.file} holds nothing that matches {self.pattern!r}")
        return _number(found[-1])


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
        What separates columns; None: white space.
    """

    file: str
    column: int
    row: int = -1
    delimiter: str | None = None

    def __call__(self, folder: Path) -> float:
        """Read the response from a run's folder."""
        lines = [line for line in (folder / self.file).read_text().splitlines() if line.strip()]
        try:
            return _number(lines[self.row].split(self.delimiter)[self.column])
        except IndexError:
            raise ExternalRunError(
                f"{self.file} has no column {self.column} in row {self.row}"
            ) from None


def _number(text: str) -> float:
    try:
        # Fortran writes 1.0D+00
        return float(text.strip().replace("D", "E").replace("d", "e"))
    except ValueError:
        raise ExternalRunError(f"{text!r} is no number") from None
