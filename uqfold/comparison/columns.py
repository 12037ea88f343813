"""The columns of a comparison: one row per method and criterion.

They are the columns of a method's own result, preceded by the problem and the method's label, and
followed by the reference and the error against it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.methods.result import CriterionResult
from uqfold.problems.reference import Reference

if TYPE_CHECKING:
    import pandas as pd

Row: TypeAlias = Mapping[str, Any]
"""One row of a comparison: column -> value, in the order and of the types of `COLUMNS`."""

_TYPES: dict[object, type] = {"float": float, "int": int}

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    **{field.name: _TYPES.get(field.type, str) for field in fields(CriterionResult)},
    "reference_pf": float,
    "reference_std_error": float,
    "error": float,
}
"""Column -> type of its values; NaN stands for "none" in the float columns."""


def comparison_row(
    problem: str, label: str, result: CriterionResult, reference: Reference | None
) -> dict[str, Any]:
    """Join one answer of a method with the reference of its criterion.

    Parameters
    ----------
    problem, label
        Name of the problem, and the method's label in this comparison.
    result
        The answer.
    reference
        The known answer of exactly the same criterion, or None.
    """
    reference_pf = math.nan if reference is None else reference.pf
    reference_std_error = math.nan if reference is None else reference.std_error
    return {
        "problem": problem,
        "label": label,
        **asdict(result),
        "reference_pf": reference_pf,
        "reference_std_error": reference_std_error,
        "error": relative_error(result.pf, reference_pf),
    }


def relative_error(pf: float, reference_pf: float) -> float:
    """Relative error of a failure probability, Eq. (49).

    The paper writes it with reliabilities, ``|R - R_ref| / (1 - R_ref)``; formed from the failure
    probabilities it is the same number without the cancellation. NaN where either is NaN, or where
    the reference is zero.
    """
    if math.isnan(pf) or math.isnan(reference_pf) or reference_pf == 0.0:
        return math.nan
    return abs(pf - reference_pf) / reference_pf


def rows_to_frame(rows: Iterable[Row]) -> pd.DataFrame:
    """Give the rows as a pandas frame with the columns and types of `COLUMNS`."""
    import pandas as pd

    listed = list(rows)
    # a seed may exceed 64 bits: integers keep the type that pandas finds for them
    integer = None if listed else "int64"
    dtypes = {float: "float64", str: str, int: integer}
    return pd.DataFrame(
        {
            name: pd.Series([row[name] for row in listed], dtype=dtypes[kind])
            for name, kind in COLUMNS.items()
        }
    )


def rows_of(frame: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield the rows that `rows_to_frame` was given."""
    columns = [map(kind, frame[name].tolist()) for name, kind in COLUMNS.items()]
    for values in zip(*columns, strict=True):
        yield dict(zip(COLUMNS, values, strict=True))
