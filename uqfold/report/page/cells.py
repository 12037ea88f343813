"""Tables of a page from pandas frames: what a cell shows, and what it is sorted by."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

if TYPE_CHECKING:
    import pandas as pd

Tone: TypeAlias = Literal["", "good", "warn", "bad", "quiet"]
"""How a word is coloured; never the only bearer of its meaning."""
Formatter: TypeAlias = "Callable[[Any], str]"

DIGITS = 4
_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e(-?\d+)(?!\w)")
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


@dataclass(frozen=True)
class Cell:
    """Text of a cell; the number to sort by, where it is one (NaN sorts last); its tone.

    A frame may hold these where a value alone does not say it.
    """

    text: str
    value: float | None = None
    tone: Tone = ""


@dataclass(frozen=True)
class TypesetTable:
    """Head (k,), whether columns are numeric (k,), and rows of cells (n, k)."""

    head: tuple[str, ...]
    numeric: tuple[bool, ...]
    rows: tuple[tuple[Cell, ...], ...]


def grid(
    frame: pd.DataFrame,
    formats: Mapping[str, Formatter],
    tones: Mapping[str, Tone],
) -> TypesetTable:
    """Return the cells of a frame; a named index comes first.

    Parameters
    ----------
    frame
        The frame, its headings with units.
    formats
        Column -> function that writes its values; `value_text` writes the others.
    tones
        Text of a cell -> its tone.
    """
    if any(name is not None for name in frame.index.names):
        frame = frame.reset_index()
    heads = tuple(" ".join(map(str, one)) if isinstance(one, tuple) else str(one)
                  for one in frame.columns)  # fmt: skip
    writers = [formats.get(head, value_text) for head in heads]
    columns = [frame.iloc[:, i].tolist() for i in range(len(heads))]
    cells = [
        [_cell(value, write, tones) for value in column]
        for column, write in zip(columns, writers, strict=True)
    ]
    numeric = tuple(
        any(one.value is not None for one in column)
        and all(one.value is not None or not one.text for one in column)
        for column in cells
    )
    return TypesetTable(heads, numeric, tuple(zip(*cells, strict=True)))


def _cell(value: Any, write: Formatter, tones: Mapping[str, Tone]) -> Cell:
    if isinstance(value, Cell):
        return value
    text = write(value)
    counts = not isinstance(value, bool) and isinstance(value, Real)
    number = float(value) if counts else None
    return Cell(text, number, tones.get(text, ""))


def value_text(value: Any) -> str:
    """Write a value as tables show it: numbers with four digits, nothing for NaN and None.

    Examples
    --------
    >>> [value_text(one) for one in (0.0123456, 1.23456e-7, 40_000, True, float("nan"), None)]
    ['0.01235', '1.235 × 10⁻⁷', '40,000', 'yes', '', '']
    """
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, Real):
        return str(value)
    number: Any = value
    if isinstance(value, Integral) or (abs(number) < 1e6 and number == int(number)):
        return f"{int(number):,}".replace("-", "−")
    return number_text(float(value))


def number_text(value: float, digits: int = DIGITS) -> str:
    """Write a number with some significant digits; very small and large ones by powers of ten.

    What is just short of 1 is written by its distance, which rounding would hide.

    Examples
    --------
    >>> [number_text(value, 3) for value in (123.4, 0.5, 6.0e-5, 1.0 - 2.5e-9)]
    ['123', '0.5', '6 × 10⁻⁵', '1 − 2.5 × 10⁻⁹']
    """
    if math.isnan(value):
        return ""
    if value == 0.0 or math.isinf(value):
        return f"{value:g}".replace("-", "−")
    if 0.0 < 1.0 - value < 0.5 * 10.0**-digits:
        return f"1 − {number_text(1.0 - value, min(digits, 3))}"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    power = int(exponent)
    if -4 < power < 6:
        shown = f"{float(f'{mantissa}e{power}'):.{max(digits - 1 - power, 0)}f}"
        return _trimmed(shown).replace("-", "−")
    return f"{_trimmed(mantissa)} × 10{str(power).translate(_RAISED)}".replace("-", "−")


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def typeset(text: str) -> str:
    """Write numbers like ``1.5e-4`` in a text by powers of ten.

    Examples
    --------
    >>> typeset("1.5e-4 .. 2"), typeset("3.3e-07 s")
    ('1.5 × 10⁻⁴ .. 2', '3.3 × 10⁻⁷ s')
    """
    return _POWER.sub(lambda match: f"{match[1]} × 10{str(int(match[2])).translate(_RAISED)}", text)
