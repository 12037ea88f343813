"""Validation cases: what is claimed, what was measured for it, and records of both.

A case is a folder (docs/validation.md). Reading a record runs no model, and imports nothing that
the record names.
"""

from typing import TYPE_CHECKING

from uqfold.lazy import lazy_exports

if TYPE_CHECKING:
    from uqfold.comparison.findings import Finding, Verdict, verdict_of
    from uqfold.evidence.measurement import Axis, Column, Figure, Measurement, Series, Table
    from uqfold.evidence.record import CaseRecord, PlantedFault, StoredResult
    from uqfold.evidence.record_file import (
        RecordError,
        read_case_record,
        read_case_records,
        write_case_record,
    )

__all__ = [
    "Axis",
    "CaseRecord",
    "Column",
    "Figure",
    "Finding",
    "Measurement",
    "PlantedFault",
    "RecordError",
    "Series",
    "StoredResult",
    "Table",
    "Verdict",
    "read_case_record",
    "read_case_records",
    "verdict_of",
    "write_case_record",
]

__getattr__, __dir__ = lazy_exports(
    __name__,
    globals(),
    {
        "Axis": "uqfold.evidence.measurement",
        "CaseRecord": "uqfold.evidence.record",
        "Column": "uqfold.evidence.measurement",
        "Measurement": "uqfold.evidence.measurement",
        "Figure": "uqfold.evidence.measurement",
        "Finding": "uqfold.comparison.findings",
        "PlantedFault": "uqfold.evidence.record",
        "RecordError": "uqfold.evidence.record_file",
        "Series": "uqfold.evidence.measurement",
        "StoredResult": "uqfold.evidence.record",
        "Table": "uqfold.evidence.measurement",
        "Verdict": "uqfold.comparison.findings",
        "read_case_record": "uqfold.evidence.record_file",
        "read_case_records": "uqfold.evidence.record_file",
        "verdict_of": "uqfold.comparison.findings",
        "write_case_record": "uqfold.evidence.record_file",
    },
)
