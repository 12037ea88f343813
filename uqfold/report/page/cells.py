"""Cells of a page's tables: what they show, and what they are sorted by."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any, Literal, TypeAlias

Tone: TypeAlias = Literal["", "good", "warn", "bad", "quiet"]
"""How a word is coloured; never the only bearer of its meaning."""

TONES: dict[str, Tone] = {
    "holds": "good", "cannot be judged": "warn", "does not hold": "bad",
    "converged": "good", "doubtful": "warn", "budget exhausted": "warn", "failed": "bad",
    "unsupported": "quiet",
}  # fmt: skip
"""Verdicts of validation cases and statuses of answers, as cells show them, and their tones."""
DIGITS = 4
_POWER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)e([+-]?\d+)(?!\w)")
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


@dataclass(frozen=True)
class Cell:
    """Text of a cell; the number to sort by, where it is one (NaN sorts last); its tone.

    A frame may hold these where a value alone does not say it.
    """

    text: str
    value: float | None = None
    tone: Tone = ""


def cell_of(value: Any) -> Cell:
    """Return the cell of a value of a frame, with its numbers typeset."""
    if isinstance(value, Cell):
        return Cell(typeset(value.text), value.value, value.tone)
    text = value_text(value)
    counts = isinstance(value, Real) and not isinstance(value, bool)
    return Cell(text, float(value) if counts else None, TONES.get(text, ""))


def is_numeric(column: list[Cell]) -> bool:
    """Return whether a column holds numbers and gaps, and nothing else."""
    values = [cell for cell in column if cell.text or cell.value is not None]
    return bool(values) and all(cell.value is not None for cell in values)


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
    if 0.0 < 1.0 - value < 0.5 * 10.0**-digits:
        return f"1 − {number_text(1.0 - value, min(digits, 3))}"
    large = 10.0**digits <= abs(value) < 1e6
    return typeset(f"{value:.0f}" if large else f"{value:.{digits}g}").replace("-", "−")


def typeset(text: str) -> str:
    """Write numbers like ``1.5e-4`` in a text by powers of ten.

    Examples
    --------
    >>> typeset("1.5e-4 .. 2"), typeset("3.3e-07 s")
    ('1.5 × 10⁻⁴ .. 2', '3.3 × 10⁻⁷ s')
    """
    return _POWER.sub(lambda match: f"{match[1]} × 10{str(int(match[2])).translate(_RAISED)}", text)
