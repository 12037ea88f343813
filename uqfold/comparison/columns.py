"""The columns of a comparison: one row per method and criterion.

They are the columns of a method's own result, preceded by the problem and the method's label, and
followed by the reference and the error against it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from uqfold.methods.result import CriterionResult
from uqfold.problems.reference import Reference

if TYPE_CHECKING:
    import pandas as pd

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
ATTRIBUTE = "uqfold-comparison"
"""Where a frame of a comparison carries what was asked and how it was made, in ``frame.attrs``."""


def comparison_row(
    problem: str, label: str, result: CriterionResult, reference: Reference | None
) -> dict[str, Any]:
    """Join one answer of a method with the reference of exactly its criterion, or with None."""
    known = (math.nan, math.nan) if reference is None else (reference.pf, reference.std_error)
    row = {"problem": problem, "label": label, **asdict(result)}
    row["reference_pf"], row["reference_std_error"] = known
    row["error"] = relative_error(result.pf, known[0])
    return row


def relative_error(pf: float, reference_pf: float) -> float:
    """Relative error of a failure probability, Eq. (49).

    The paper writes it with reliabilities, ``|R - R_ref| / (1 - R_ref)``; formed from the failure
    probabilities it is the same number without the cancellation. NaN where either is NaN, or where
    the reference is zero.
    """
    if math.isnan(pf) or math.isnan(reference_pf) or reference_pf == 0.0:
        return math.nan
    return abs(pf - reference_pf) / reference_pf


def rows_to_frame(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Return the rows as a frame with the columns and types of `COLUMNS`."""
    import pandas as pd

    from uqfold.comparison.printed import ComparisonFrame

    listed = list(rows)
    dtypes: dict[type, type | str] = {float: "float64", str: str, int: "int64"}
    if listed:
        # a seed may exceed 64 bits: integers keep the type that pandas finds for them
        del dtypes[int]
    return ComparisonFrame(
        {
            name: pd.Series([row[name] for row in listed], dtype=dtypes.get(kind))
            for name, kind in COLUMNS.items()
        }
    )
