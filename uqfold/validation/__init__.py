"""Validation cases: what is claimed, what was measured for it, and records of both.

A case is a folder (docs/validation.md). Reading a record runs no model, and imports nothing that
the record names.
"""

from uqfold.validation.findings import VERDICT_RULE, Finding, Verdict, verdict_of
from uqfold.validation.measurement import Claim, Measurement, Points, Table
from uqfold.validation.record import (
    CaseRecord,
    RecordError,
    read_case_record,
    read_case_records,
    record_schema,
)
from uqfold.validation.work import Work

__all__ = [
    "VERDICT_RULE",
    "CaseRecord",
    "Claim",
    "Finding",
    "Measurement",
    "Points",
    "RecordError",
    "Table",
    "Verdict",
    "Work",
    "read_case_record",
    "read_case_records",
    "record_schema",
    "verdict_of",
]
