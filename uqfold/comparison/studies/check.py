"""Whether two runs of a study say the same: committed results against a fresh reduced run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

_SAMPLE = ("seed", "n_evals")
"""Columns that say which sample an estimate comes from; a budget changes it only if used up."""

_DERIVED = ("beta", "error")
"""Columns that follow from others, and magnify their rounding where they are close to zero."""


@dataclass
class Agreement:
    """What a comparison of two tables found.

    Attributes
    ----------
    numbers
        How many numbers were compared.
    without_partner
        Fresh rows of another sample that state no error by which they could be compared.
    differences
        What differs, in words.
    """

    numbers: int = 0
    without_partner: int = 0
    differences: list[str] = field(default_factory=list)


def compare_tables(
    committed: pd.DataFrame,
    fresh: pd.DataFrame,
    columns: Mapping[str, type],
    index: Sequence[str],
    tolerances: Mapping[str, float],
) -> Agreement:
    """Hold fresh rows against committed ones.

    A fresh row is compared with the committed row of the same `index`, or else of the same index
    but for budget and seed. If both come from the same sample (seed and model runs), all numbers
    have to agree to the relative and absolute tolerance; if not, the two ``pf`` in their joint
    standard errors.

    Parameters
    ----------
    committed, fresh
        Tables with `columns`.
    columns
        Column -> type.
    index
        Columns that identify a row.
    tolerances
        ``relative``, ``absolute`` and ``standard_errors``.
    """
    found = Agreement()
    values = [
        name
        for name, kind in columns.items()
        if kind is float and name not in index and name not in _DERIVED
    ]
    loose = [name for name in index if name not in {"max_evals", *_SAMPLE}]
    known = {_key(row, index): row for row in committed.to_dict("records")}
    alike = {_key(row, loose): row for row in known.values()}
    for row in fresh.to_dict("records"):
        shown = ", ".join(f"{name} = {row[name]}" for name in index if not _missing(row[name]))
        partner = known.get(_key(row, index))
        if partner is None:
            partner = alike.get(_key(row, loose))
            if partner is None:
                found.differences.append(f"{shown}: not among the committed rows")
                continue
        if all(partner.get(name) == row.get(name) for name in _SAMPLE):
            for name in values:
                found.numbers += 1
                if not _same(partner[name], row[name], tolerances):
                    found.differences.append(
                        f"{shown}: {name} = {row[name]!r}, committed {partner[name]!r}"
                    )
            continue
        error = math.hypot(row.get("std_error", math.nan), partner.get("std_error", math.nan))
        if math.isnan(error):
            found.without_partner += 1
            continue
        found.numbers += 1
        if not abs(row["pf"] - partner["pf"]) <= tolerances["standard_errors"] * error:
            found.differences.append(
                f"{shown}: pf = {row['pf']!r}, committed {partner['pf']!r} from another sample, "
                f"joint standard error {error:.2g}"
            )
    return found


def _key(row: Mapping[Any, Any], names: Sequence[str]) -> tuple[Any, ...]:
    return tuple(None if _missing(row[name]) else row[name] for name in names)


def _missing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _same(one: float, other: float, tolerances: Mapping[str, float]) -> bool:
    if math.isnan(one) or math.isnan(other):
        return math.isnan(one) and math.isnan(other)
    return math.isclose(one, other, rel_tol=tolerances["relative"], abs_tol=tolerances["absolute"])
