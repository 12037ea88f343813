"""The record of a case: what was claimed, how it was measured, and what came out.

One JSON file per case, schema ``uqfold-validation/2`` (`record_schema`). Reading checks the whole
file and takes everything in it as data: nothing that a record names is imported or run.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import Field, TypeAdapter, computed_field

from uqfold.checks import instance
from uqfold.checks import path as checked_path
from uqfold.documents import read_record
from uqfold.validation.case import STRICT, Declaration, Fault, Tier
from uqfold.validation.findings import AS_WRITTEN, Finding, Verdict
from uqfold.validation.measurement import Measurement
from uqfold.writing import write_text

SCHEMA: Literal["uqfold-validation/2"] = "uqfold-validation/2"


class RecordError(ValueError):
    """A file is not a record of a validation case, or a damaged one."""


@dataclass(frozen=True)
class PlantedFault:
    """A fault planted on purpose, and the verdict that it gave; None: not planted in this run."""

    __pydantic_config__ = STRICT

    fault: Fault
    verdict: Verdict | None = None

    @property
    def caught(self) -> bool | None:
        """Whether it turned the verdict as it has to; None where it was not planted."""
        return None if self.verdict is None else self.verdict == self.fault.turns_to


@dataclass(frozen=True)
class CaseRecord:
    """One case as it is kept.

    Attributes
    ----------
    case
        What it states.
    tier
        In which tier it was measured.
    measurement
        Findings, and the claims, tables and points that go with them.
    made
        What made it, see `uqfold.provenance.made_by`.
    seconds
        How long it took (s).
    faults
        Planted faults.
    error
        Why there is no measurement: the error that ended it; empty otherwise.
    """

    __pydantic_config__ = AS_WRITTEN

    case: Declaration
    tier: Tier
    measurement: Measurement
    made: Mapping[str, Any]
    seconds: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
    faults: tuple[PlantedFault, ...] = ()
    error: str = ""
    schema: Literal["uqfold-validation/2"] = SCHEMA

    @property
    def name(self) -> str:
        """Name of the case."""
        return self.case.name

    @property
    def date(self) -> str:
        """When it was measured, UTC, ISO 8601."""
        return str(self.made["date"])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was found."""
        return self.measurement.findings

    @computed_field  # type: ignore[prop-decorator]
    @property
    def verdict(self) -> Verdict:
        """The verdict on the claim; a measurement that ended in an error judges nothing."""
        return "cannot be judged" if self.error else self.measurement.verdict

    @computed_field  # type: ignore[prop-decorator]
    @property
    def claims(self) -> dict[str, Verdict]:
        """Key -> verdict of its claims, if it judges several."""
        return self.measurement.claim_verdicts

    @property
    def broken(self) -> tuple[str, ...]:
        """Why it shows nothing: an error, or planted faults that did not turn the verdict."""
        if self.error:
            return (f"could not be measured: {self.error}",)
        missed = [one.fault.name for one in self.faults if one.caught is False]
        return tuple(f"the planted fault {name!r} went unnoticed" for name in missed)


_RECORD = TypeAdapter(CaseRecord)


def record_schema() -> dict[str, Any]:
    """Return the JSON Schema of records, made from the classes that hold them."""
    return _RECORD.json_schema(mode="serialization")


def write_case_record(record: CaseRecord, path: str | os.PathLike[str]) -> Path:
    """Write a record; the file appears whole or not at all, its folder is made if it is missing."""
    instance("record", record, CaseRecord, "give a CaseRecord")
    file = checked_path("path", path)
    file.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(to_document(record), ensure_ascii=False, allow_nan=False, indent=1)
    # lists of plain values on one line each, so that a file stays readable and short
    write_text(file, re.sub(r"\[[^\[\]{}]*\]", _on_one_line, text) + "\n")
    return file


def read_case_record(path: str | os.PathLike[str]) -> CaseRecord:
    """Read the record of one case.

    Raises
    ------
    RecordError
        If the file does not follow the schema, or its verdicts are not those of its findings.
    OSError
        If it cannot be opened.
    """
    file, fields = checked_path("path", path), Declaration.__dataclass_fields__
    return read_record(file, _taken, (SCHEMA,), RecordError, "uqfold validate", fields)


def _taken(document: Mapping[str, Any]) -> CaseRecord:
    record = _RECORD.validate_python(document)
    if to_document(record) != document:
        raise ValueError("it holds unknown fields, or verdicts that its findings do not give")
    return record


def existing_record(path: Path) -> CaseRecord | None:
    """Read a record where there is a readable one."""
    try:
        return read_case_record(path)
    except (OSError, RecordError):
        return None


def read_case_records(folder: str | os.PathLike[str]) -> list[CaseRecord]:
    """Read all records of a folder that `uqfold validate` wrote, in order of topic and name.

    Raises
    ------
    RecordError
        If there is none, or one of the JSON files is not readable as one.
    """
    directory = checked_path("folder", folder)
    paths = sorted(path for path in directory.glob("*.json") if not path.name.startswith("."))
    if not paths:
        raise RecordError(f"{directory.name} holds no records: run `uqfold validate --out` first")
    return sorted(map(read_case_record, paths), key=lambda one: (one.case.topic, one.name))


def to_document(record: CaseRecord) -> dict[str, Any]:
    """Return a record as JSON values."""
    return cast("dict[str, Any]", json.loads(_RECORD.dump_json(record)))


def _on_one_line(found: re.Match[str]) -> str:
    # a text holds no line break of its own
    return re.sub(r"\n\s*", " ", re.sub(r"(?<=\[)\n\s*|\n\s*(?=\]$)", "", found[0]))
