"""The frame of a comparison, or a benchmark, which prints as the columns that people read."""

from __future__ import annotations

from typing import ClassVar

import pandas as pd

from uqfold.methods.tabular import cell_text


class ComparisonFrame(pd.DataFrame):  # type: ignore[misc]
    """A pandas frame with all columns of a comparison; printed are those of `READ`.

    Those that hold nothing are left out, and missions where there is one each. What is left when
    columns of `READ` were dropped prints as pandas prints it.
    """

    READ: ClassVar[tuple[str, ...]] = (
        "label", "threshold", "tau", "missions", "pf", "ci_low", "ci_high", "reference_pf", "error",
        "n_evals_row", "status",
    )  # fmt: skip

    @property
    def _constructor(self) -> type[ComparisonFrame]:
        return type(self)

    def __repr__(self) -> str:
        return str(super().__repr__() if self._is_part else self._read().to_string(max_rows=60))

    def _repr_html_(self) -> str | None:
        """Return what a notebook shows."""
        html: str | None = super()._repr_html_()
        return html if self._is_part else str(self._read().to_html(max_rows=60, border=0))

    @property
    def _is_part(self) -> bool:
        return self.empty or not set(self.READ) <= set(self.columns)

    def _read(self) -> pd.DataFrame:
        told = {name: [cell_text(name, one) for one in self[name].tolist()] for name in self.READ}
        if set(told["missions"]) == {"1"}:
            told.pop("missions")
        shown = {name: texts for name, texts in told.items() if any(texts)}
        return pd.DataFrame(shown, index=self.index)


class BenchmarkFrame(ComparisonFrame):
    """The same with the rows of a benchmark."""

    READ: ClassVar[tuple[str, ...]] = (
        "problem", "threshold", "tau", "missions", "label", "seed", "pf", "std_error",
        "reference_pf", "error", "covered", "n_evals", "status",
    )  # fmt: skip
