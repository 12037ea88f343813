"""Answers of several rows: as a frame with all that is known, and printed as a short table."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from html import escape
from textwrap import fill
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from uqfold.problems.criterion import threshold_text

if TYPE_CHECKING:
    import pandas as pd

Record = TypeVar("Record")

_MOST_ROWS = 60
"""Of longer tables only the first and the last rows are printed."""
_WIDTH = 100


class Tabular(Generic[Record]):
    """A frozen dataclass whose `rows` are records of one type.

    In a terminal and in a notebook it is shown as a table: the columns of `_SHOWN`, without those
    that hold nothing, below it what the rows say in their ``message``.
    """

    rows: tuple[Record, ...]
    _SHOWN: ClassVar[tuple[str, ...]]

    def __iter__(self) -> Iterator[Record]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: int) -> Record:
        return self.rows[index]

    def to_frame(self) -> pd.DataFrame:
        """One pandas row per record, one column for each of its fields."""
        import pandas as pd

        return pd.DataFrame([asdict(row) for row in self.rows])  # type: ignore[call-overload]

    def __repr__(self) -> str:
        table = self._table().to_string(max_rows=_MOST_ROWS)
        said = (fill(one, _WIDTH, subsequent_indent="  ") for one in self._messages())
        return "\n".join([self._cost(), table, *said])

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        table = self._table().to_html(max_rows=_MOST_ROWS, border=0)
        said = "".join(f"<p>{escape(one)}</p>" for one in self._messages())
        return f"<p>{escape(self._cost())}</p>{table}{said}"

    def _table(self) -> pd.DataFrame:
        import pandas as pd

        shown = {name: [cell_text(name, getattr(row, name)) for row in self.rows]
                 for name in self._SHOWN}  # fmt: skip
        return pd.DataFrame({name: texts for name, texts in shown.items() if any(texts)})

    def _cost(self) -> str:
        known: dict[str, Any] = {name: getattr(self, name, None) for name in _COST}
        told = {name: write(known[name]) for name, write in _COST.items() if known[name]}
        return f"{type(self).__name__}: {', '.join(told.values())}"

    def _messages(self) -> list[str]:
        """Return what is said about rows, each sentence once, with the rows that it is about."""
        said: dict[str, list[int]] = {}
        for i, row in enumerate(self.rows):
            if message := getattr(row, "message", ""):
                said.setdefault(message, []).append(i)
        return [f"row{'s' * (len(rows) > 1)} {_listed(rows)}: {one}" for one, rows in said.items()]


_COST: dict[str, Any] = {
    "method": str,
    "n_evals": lambda runs: f"{runs:,} evaluations",
    "n_reused": lambda runs: f"{runs:,} of them from a store",
    "n_gradients": lambda count: f"{count:,} gradients",
    "n_failed": lambda runs: f"{runs:,} failed",
    "seconds": lambda seconds: f"{seconds:.3g} s",
    "seed": lambda seed: f"seed {seed}",
}


def cell_text(name: str, value: Any) -> str:
    """Return a value of a column as it is printed; NaN as nothing."""
    if name == "threshold":
        return threshold_text(value).removeprefix("T = ")
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.4g}"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value)


def _listed(rows: list[int]) -> str:
    """Return row numbers as text, those that follow one another as a range."""
    ends: list[list[int]] = []
    for row in rows:
        if ends and row == ends[-1][1] + 1:
            ends[-1][1] = row
        else:
            ends.append([row, row])
    return ", ".join(str(a) if a == b else f"{a} to {b}" for a, b in ends)
