"""Records of cases on disk: one JSON file per case, schema ``uqfold-validation/1``.

The schema ships as ``uqfold/evidence/schemas/uqfold-validation-1.schema.json``. Reading checks
the whole file and takes everything in it as data: nothing that a record names is imported or run.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from uqfold.checks import instance, refused
from uqfold.checks import path as checked_path
from uqfold.checks import text as checked_text
from uqfold.comparison.encoding import encoded, parsed_json
from uqfold.comparison.findings import Finding
from uqfold.evidence.measurement import Axis, Cell, Column, Figure, Measurement, Series, Table
from uqfold.evidence.record import CaseRecord, PlantedFault, StoredResult
from uqfold.evidence.schema import check_document
from uqfold.writing import write_text

SCHEMA = "uqfold-validation/1"
DIGITS = 9
"""Significant digits of numbers in tables and figures; findings keep every bit."""

_INFINITE = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}
_PLAIN = (
    "name", "topic", "title", "claim", "kind", "compared_with", "uncertainty", "source", "command",
    "tolerance", "verdict_rule", "tier", "error", "date", "seconds", "machine",
)  # fmt: skip


class RecordError(ValueError):
    """A file is no record of a validation case, or a damaged one."""


def write_case_record(record: CaseRecord, folder: str | os.PathLike[str], stem: str = "") -> Path:
    """Write a record into a folder, made if it is missing; the file appears whole or not at all.

    Parameters
    ----------
    record
        What to write.
    folder
        Where.
    stem
        Name of the file without ``.json``; by default that of the case.
    """
    instance("record", record, CaseRecord, "give a CaseRecord")
    directory = checked_path("folder", folder)
    checked_text("stem", stem, empty=True)
    if Path(stem).name != stem:
        raise refused("stem", stem, "give the name of a file, without a folder")
    directory.mkdir(parents=True, exist_ok=True)
    path = directory / f"{stem or record.name}.json"
    document = to_document(record)
    check_document(document, "uqfold-validation-1")
    text = json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1)
    write_text(path, _dense(text) + "\n")
    return path


def read_case_record(path: str | os.PathLike[str]) -> CaseRecord:
    """Read the record of one case.

    Raises
    ------
    RecordError
        If the file does not follow the schema, or its verdicts are not those of its findings.
    OSError
        If it cannot be opened.
    """
    file = checked_path("path", path)
    try:
        document = parsed_json(file.read_text(encoding="utf-8"))
        if not isinstance(document, Mapping):
            raise TypeError("it holds no JSON object")
        if document.get("schema") != SCHEMA:
            raise ValueError(f"its schema is {document.get('schema')!r}, not {SCHEMA!r}")
        check_document(document, "uqfold-validation-1")
        return from_document(document)
    except (ValueError, TypeError) as error:
        raise RecordError(
            f"{file.name} is no readable record of a validation case: {error}. Records are written "
            "by `uqfold validate`; see docs/validation.md"
        ) from error


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
    return sorted(map(read_case_record, paths), key=lambda record: (record.topic, record.name))


def to_document(record: CaseRecord) -> dict[str, Any]:
    """Give a record as JSON values."""
    measured, stored = record.measurement, record.stored
    return {
        "schema": SCHEMA,
        **{name: getattr(record, name) for name in _PLAIN},
        "verdict": record.verdict,
        "seeds": list(record.seeds),
        "findings": [_finding_document(finding) for finding in measured.findings],
        "tables": [_table_document(table) for table in measured.tables],
        "figures": [_figure_document(figure) for figure in measured.figures],
        "faults": [
            {
                "name": fault.name,
                "what": fault.what,
                "verdict": fault.verdict,
                "turns_to": fault.turns_to,
            }
            for fault in record.faults
        ],
        "stored": None
        if stored is None
        else {
            "date": stored.date,
            "current": stored.current,
            "changed": list(stored.changed),
            "seconds": stored.seconds,
            "machine": stored.machine,
            "verdict": stored.verdict,
            "findings": [_finding_document(finding) for finding in stored.findings],
        },
        "versions": dict(record.versions),
        "code": dict(record.code),
    }


def from_document(document: Mapping[str, Any]) -> CaseRecord:
    """Read what `to_document` gave.

    Raises
    ------
    ValueError
        If a verdict is not that of the findings beside it, or a table or series is ragged.
    """
    stored = document["stored"]
    record = CaseRecord(
        **{name: document[name] for name in _PLAIN},
        seeds=tuple(document["seeds"]),
        measurement=Measurement(
            tuple(_finding(one) for one in document["findings"]),
            tuple(_table(one) for one in document["tables"]),
            tuple(_figure(one) for one in document["figures"]),
        ),
        faults=tuple(PlantedFault(**fault) for fault in document["faults"]),
        stored=None
        if stored is None
        else StoredResult(
            stored["date"],
            stored["current"],
            tuple(stored["changed"]),
            tuple(_finding(one) for one in stored["findings"]),
            stored["seconds"],
            stored["machine"],
        ),
        versions=dict(document["versions"]),
        code=dict(document["code"]),
    )
    _same_verdict(document["verdict"], record.verdict, "the case")
    if record.stored is not None:
        _same_verdict(stored["verdict"], record.stored.verdict, "the stored result")
    return record


def _same_verdict(written: str | None, given: str | None, what: str) -> None:
    if written != given:
        raise ValueError(f"the verdict of {what} is {written!r}, but its findings give {given!r}")


def _finding_document(finding: Finding) -> dict[str, Any]:
    return {
        "what": finding.what,
        "value": _number_or_nan(finding.value),
        "limit": _number_or_nan(finding.limit),
        "unit": finding.unit,
        "at_least": finding.at_least,
        "uncertainty": _number_or_nan(finding.uncertainty),
        "remark": finding.remark,
        "verdict": finding.verdict,
    }


def _finding(document: Mapping[str, Any]) -> Finding:
    finding = Finding(
        document["what"],
        _decoded(document["value"]),
        _decoded(document["limit"]),
        document["unit"],
        at_least=document["at_least"],
        uncertainty=_decoded(document["uncertainty"]),
        remark=document["remark"],
    )
    _same_verdict(document["verdict"], finding.verdict, f"the finding {finding.what!r}")
    return finding


def _table_document(table: Table) -> dict[str, Any]:
    kinds = [
        "text" if any(isinstance(row[i], str) for row in table.rows) else "number"
        for i in range(len(table.columns))
    ]
    return {
        "name": table.name,
        "title": table.title,
        "columns": [
            {"name": column.name, "unit": column.unit, "type": kind}
            for column, kind in zip(table.columns, kinds, strict=True)
        ],
        "rows": [[_short(cell) for cell in row] for row in table.rows],
    }


def _table(document: Mapping[str, Any]) -> Table:
    kinds = [column["type"] for column in document["columns"]]
    columns = tuple(Column(column["name"], column["unit"]) for column in document["columns"])
    for i, row in enumerate(document["rows"]):
        if len(row) != len(kinds):
            raise ValueError(f"table {document['name']!r}: row {i} has {len(row)} cells")
    rows = tuple(
        tuple(
            _table_cell(cell, kind, f"table {document['name']!r}, row {i}")
            for cell, kind in zip(row, kinds, strict=True)
        )
        for i, row in enumerate(document["rows"])
    )
    return Table(document["name"], document["title"], columns, rows)


def _table_cell(cell: Any, kind: str, where: str) -> Cell:
    value: Cell = _decoded(cell) if kind == "number" and cell in ("inf", "-inf") else cell
    if kind == "number" and isinstance(value, str):
        raise ValueError(f"{where}: {cell!r} in a column of numbers")
    return value


def _figure_document(figure: Figure) -> dict[str, Any]:
    return {
        "name": figure.name,
        "title": figure.title,
        "x": vars(figure.x).copy(),
        "y": vars(figure.y).copy(),
        "series": [
            {
                "label": series.label,
                "x": [_short(value) for value in series.x],
                "y": [_short(value) for value in series.y],
                "low": [_short(value) for value in series.low],
                "high": [_short(value) for value in series.high],
                "style": series.style,
                "method": series.method,
                "reference": series.reference,
            }
            for series in figure.series
        ],
        "x_marks": [{"label": label, "at": at} for label, at in figure.x_marks],
        "y_marks": [{"label": label, "at": at} for label, at in figure.y_marks],
    }


def _figure(document: Mapping[str, Any]) -> Figure:
    return Figure(
        document["name"],
        document["title"],
        Axis(**document["x"]),
        Axis(**document["y"]),
        tuple(
            Series(
                label=series["label"],
                x=tuple(series["x"]),
                y=tuple(map(_decoded, series["y"])),
                low=tuple(map(_decoded, series["low"])),
                high=tuple(map(_decoded, series["high"])),
                style=series["style"],
                method=series["method"],
                reference=series["reference"],
            )
            for series in document["series"]
        ),
        tuple((mark["label"], mark["at"]) for mark in document["x_marks"]),
        tuple((mark["label"], mark["at"]) for mark in document["y_marks"]),
    )


def _number_or_nan(value: float | None) -> float | str | None:
    if value is not None and math.isnan(value):
        return "nan"
    return None if value is None else encoded(float(value))


def _decoded(value: float | str | None) -> float | None:
    return _INFINITE[value] if isinstance(value, str) else value


def _short(cell: Cell) -> float | str | None:
    if cell is None or isinstance(cell, str):
        return cell
    value = encoded(float(cell))
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _dense(text: str) -> str:
    """Put lists of plain values on one line each, so that a file stays readable and short."""
    lines: list[str] = []
    joined: list[str] | None = None
    for line in text.split("\n"):
        if joined is not None and line.strip().rstrip(",") == "]":
            first, *rest = joined
            lines.append(first + " ".join(part.strip() for part in rest) + line.strip())
            joined = None
        elif line.endswith("["):
            lines.extend(joined or ())
            joined = [line]
        elif joined is not None and line.endswith("{"):
            lines.extend([*joined, line])
            joined = None
        else:
            (lines if joined is None else joined).append(line)
    return "\n".join(lines)
