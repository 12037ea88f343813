"""Whether two runs of a study say the same: committed results against a fresh reduced run."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import RowIdentity

if TYPE_CHECKING:
    import pandas as pd

_LOOSE = ("max_evals", "seed")
"""Columns in which a partner may differ where none has the very same index."""
_DERIVED = ("beta", "error")
"""Columns that follow from others, and magnify their rounding where they are close to zero."""


@dataclass
class Agreement:
    """What a comparison of two tables found.

    Attributes
    ----------
    numbers
        How many numbers were compared.
    without_error
        How many estimates of other samples state no error by which they could be compared.
    differences
        What differs, in words.
    """

    numbers: int = 0
    without_error: int = 0
    differences: list[str] = field(default_factory=list)


def compare_tables(
    committed: pd.DataFrame,
    fresh: pd.DataFrame,
    columns: Mapping[str, type],
    identity: RowIdentity,
    tolerances: Mapping[str, float],
    adaptive: Collection[str] = (),
) -> Agreement:
    """Hold fresh rows against committed ones.

    A fresh row is compared with the committed row of the same index, or else of the same index but
    for budget and seed. If both come from the same sample, all their numbers have to agree to the
    relative and absolute tolerance. If not, numbers that depend on no sample still have to, and
    estimates have to agree in their joint standard errors. A method that chooses its own runs takes
    another sample wherever sums round differently: on another processor, with other libraries.

    Parameters
    ----------
    committed, fresh
        Tables with `columns`.
    columns
        Column -> type.
    identity
        How rows are matched.
    tolerances
        ``relative``, ``absolute`` and ``standard_errors``.
    adaptive
        Labels of methods that choose their own runs; their rows always count as another sample.
    """
    found = Agreement()
    index = identity.index
    loose = [name for name in index if name not in _LOOSE]
    known = {_key(row, index): row for row in committed.to_dict("records")}
    alike = {_key(row, loose): row for row in known.values()}
    for row in fresh.to_dict("records"):
        shown = ", ".join(f"{name} = {row[name]}" for name in index if not _missing(row[name]))
        partner = known.get(_key(row, index)) or alike.get(_key(row, loose))
        if partner is None:
            found.differences.append(f"{shown}: not among the committed rows")
            continue
        estimates, sampled = identity.estimates, set(identity.sampled)
        same_sample = _key(row, identity.sample) == _key(partner, identity.sample)
        if same_sample and row.get("label") not in adaptive:
            estimates, sampled = {}, set()
        sampled |= {*estimates, *estimates.values(), *identity.sample, *index, *_DERIVED}
        for name in (one for one, kind in columns.items() if kind is float and one not in sampled):
            found.numbers += 1
            if not _same(partner[name], row[name], tolerances):
                found.differences.append(
                    f"{shown}: {name} = {row[name]!r}, committed {partner[name]!r}"
                )
        for name, error_name in estimates.items():
            error = math.hypot(row[error_name], partner[error_name])
            if math.isnan(error):
                found.without_error += 1
                continue
            found.numbers += 1
            if not abs(row[name] - partner[name]) <= tolerances["standard_errors"] * error:
                found.differences.append(
                    f"{shown}: {name} = {row[name]!r}, committed {partner[name]!r} from another "
                    f"sample, joint standard error {error:.2g}"
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
