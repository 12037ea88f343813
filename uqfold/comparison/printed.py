"""The frame of a comparison, which prints as the columns that people read."""

from __future__ import annotations

import pandas as pd

from uqfold.methods.tabular import cell_text

READ = (
    "label", "threshold", "tau", "missions", "pf", "ci_low", "ci_high", "reference_pf", "error",
    "n_evals_row", "status",
)  # fmt: skip


class ComparisonFrame(pd.DataFrame):  # type: ignore[misc]
    """A pandas frame with all columns of a comparison; printed are those of `READ`.

    Those that hold nothing are left out, and missions where there is one each. What is left when
    columns of `READ` were dropped prints as pandas prints it.
    """

    @property
    def _constructor(self) -> type[ComparisonFrame]:
        return ComparisonFrame

    def __repr__(self) -> str:
        return str(super().__repr__() if self._is_part else self._read().to_string(max_rows=60))

    def _repr_html_(self) -> str | None:
        """Return what a notebook shows."""
        html: str | None = super()._repr_html_()
        return html if self._is_part else str(self._read().to_html(max_rows=60, border=0))

    @property
    def _is_part(self) -> bool:
        return self.empty or not set(READ) <= set(self.columns)

    def _read(self) -> pd.DataFrame:
        told = {name: [cell_text(name, one) for one in self[name].tolist()] for name in READ}
        silent = {"", "1"} if set(told["missions"]) == {"1"} else {""}
        shown = {name: texts for name, texts in told.items() if not set(texts) <= silent}
        return pd.DataFrame(shown, index=self.index)
