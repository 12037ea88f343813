"""How figures, tables and reports write numbers and criteria."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.comparison.columns import ATTRIBUTE
from uqfold.plots.rows import Comparable, answers_frame
from uqfold.problems.criterion import threshold_text

if TYPE_CHECKING:
    import pandas as pd

Row: TypeAlias = Mapping[str, Any]
"""One row of a comparison: column -> value."""

NO_VALUE = "-"
NAMELESS = "response"
"""What a response is called that nobody gave a name."""
REFERENCE_STANDARD_ERRORS = 2.0
"""Width of the band in which a reference cannot tell an estimate from the truth."""

LARGEST = 1e12
"""Numbers beyond have no place on an axis."""


def value_text(column: str, value: Any, unit: str) -> str:
    """Write one value of a column as figures and reports call it, for instance ``tau = 0.04 s``."""
    if column == "threshold":
        return threshold_text(value, unit)
    if column == "tau":
        return "no tau" if value is None else f"tau = {value:g} {unit}".rstrip()
    if column in ("missions", "units") and str(value).isdecimal():
        return f"{value} {column.removesuffix('s') if str(value) == '1' else column}"
    return f"missions ~ {value}" if column == "missions" else str(value)


def criterion_text(row: Row, unit: str) -> str:
    """Write the criterion of a row without what is NaN, for instance ``T = 0.55 s, 1 mission``."""
    asked = {name: row.get(name, math.nan) for name in ("threshold", "tau", "missions")}
    return ", ".join(
        value_text(name, one, unit) for name, one in asked.items() if str(one) != "nan"
    )


def panel_text(row: Row, unit: str) -> str:
    """Write to which curve over T a row belongs, for instance ``tau = 0.04 s, 5 missions``."""
    return criterion_text({**row, "threshold": math.nan}, unit)


def scientific(value: float, digits: int) -> str:
    """Write a number with that many significant digits and a short exponent: ``1.23e-4``."""
    if math.isnan(value):
        return NO_VALUE
    if value == 0.0 or math.isinf(value):
        return f"{value:g}"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def probability(value: float, digits: int) -> str:
    """Write a probability with that many significant digits: ``0.0123``, or ``1.23e-4``.

    Plain decimals down to 0.001 and short of 1, where rounding would not hide the difference.
    """
    if 1e-3 <= value <= 1.0 - 0.5 * 10.0 ** (-digits):
        return f"{value:.{digits - 1 - math.floor(math.log10(value))}f}"
    return scientific(value, digits)


def percent(value: float) -> str:
    """Write a relative error in percent, with two or three significant digits.

    Errors below 0.01 % are said to be so: no reader of the table needs their digits.
    """
    if math.isnan(value):
        return NO_VALUE
    scaled = 100.0 * value
    if scaled >= 9999.5:
        return f"{scientific(scaled, 2)} %"
    if scaled >= 99.95:
        return f"{scaled:.0f} %"
    if scaled >= 0.995 or scaled == 0.0:
        return f"{scaled:.1f} %"
    return f"{scaled:.2g} %" if scaled >= 0.01 else "<0.01 %"


def seconds_text(value: float) -> str:
    """Write a duration with its unit."""
    if value < 0.0095:
        return f"{1e3 * value:.1f} ms"
    if value < 0.9995:
        return f"{1e3 * value:.0f} ms"
    return f"{value:.1f} s" if value < 99.95 else f"{value:.0f} s"


def reference_resolution(row: Row) -> float:
    """Return the relative error below which the reference of a row cannot judge an estimate.

    It is two standard errors of the reference over its pf; NaN without a reference.
    """
    if math.isnan(row["reference_pf"]) or row["reference_pf"] == 0.0:
        return math.nan
    return float(REFERENCE_STANDARD_ERRORS * row["reference_std_error"] / row["reference_pf"])


def in_figure(text: str, most: int = 28) -> str:
    """Return a name as a figure shows it: cut where it is long, and no mathematics.

    Examples
    --------
    >>> in_figure("a method with a name that is longer than its curve")
    'a method with a name that i…'
    """
    line = " ".join(text.split())
    cut = line if len(line) <= most else f"{line[: most - 1]}…"
    return cut.replace("$", r"\$")


def response_of(frame: pd.DataFrame) -> tuple[str, str]:
    """Return response and unit as the header of the comparison has them; empty without a name."""
    header = frame.attrs.get(ATTRIBUTE, {})
    response = header.get("response", NAMELESS)
    return "" if response == NAMELESS else response, header.get("response_unit", "")


def response_text(frame: pd.DataFrame) -> str:
    """Write response and unit, for instance ``deployment time (s)``; empty without both."""
    response, unit = response_of(frame)
    return f"{response}{f' ({unit})' if unit else ''}".strip()


def threshold_label(frame: pd.DataFrame) -> str:
    """Return the label of an axis of thresholds."""
    response, unit = map(in_figure, response_of(frame))
    said = f"threshold T{f' on {response}' if response else ''}"
    return f"{said} ({unit})" if unit else said


def drawable(frame: pd.DataFrame, column: str) -> bool:
    """Return whether a number of that column has a place on an axis in any of the rows."""
    finite = frame["threshold"].abs() < math.inf
    return bool((finite & frame[column].between(0.0, LARGEST)).any())


def answers_of(frame: Comparable) -> pd.DataFrame:
    """Return the rows of a comparison that have a place in a figure, and their words.

    Rows at finite thresholds; numbers that have no place on an axis (infinite, negative, beyond
    `LARGEST`) become NaN. The columns ``panel`` (tau and missions), ``criterion`` and ``text``
    (the whole answer) say each row in words.
    """
    whole = answers_frame(frame, ("problem", "label", "threshold", "pf", "error", "status"))
    rows, unit = whole.to_dict("records"), response_of(whole)[1]
    answers = whole.assign(
        panel=[panel_text(row, unit) for row in rows],
        criterion=[criterion_text(row, unit) for row in rows],
        text=[answer_text(row, unit) for row in rows],
    )
    # pandas copies how the comparison was made into every column and selection: a third of the time
    answers.attrs = {}
    numbers = ["pf", "ci_low", "ci_high", "reference_pf", "reference_std_error", "error"]
    values = answers[numbers]
    answers[numbers] = values.where((values >= 0.0) & (values <= LARGEST))
    return answers[answers["threshold"].abs() < math.inf].reset_index(drop=True)


def answer_text(row: Row, unit: str) -> str:
    """Write an answer in lines: criterion, pf, interval, error, evaluations, status."""
    said = [criterion_text(row, unit), f"pf = {probability(row['pf'], 4)}"]
    if not math.isnan(row["ci_low"] + row["ci_high"]):
        ends = " .. ".join(probability(row[end], 3) for end in ("ci_low", "ci_high"))
        said.append(f"interval {ends}")
    if not math.isnan(row["error"]):
        said.append(f"error {percent(row['error'])}")
    said.append(f"{row['n_evals_row']:,} evaluations")
    return "\n".join([*said, row["status"].replace("_", " ")])
