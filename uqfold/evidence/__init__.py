"""The former name of `uqfold.validation`, understood for one release."""

import warnings
from typing import Any

_MOVED = frozenset(
    {
        "CaseRecord", "Finding", "Measurement", "RecordError", "Table", "Verdict",
        "read_case_record", "read_case_records", "verdict_of",
    }
)  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _MOVED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from uqfold import validation

    warnings.warn(f"uqfold.evidence is uqfold.validation now: {name}", DeprecationWarning, 2)
    return getattr(validation, name)
