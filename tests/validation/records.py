"""A record with everything in it, for tests."""

import math
from dataclasses import replace
from typing import Any

from uqfold.validation import CaseRecord, Claim, Finding, Measurement, Points, Table
from uqfold.validation.case import Declaration, Fault
from uqfold.validation.record import PlantedFault

DECLARED = Declaration(
    "a_case", "mechanism", "A case", "It is so.", "cross-code", "another code", "1e-9 s",
    "that code, version 2", (1, 2**70), "2e-6 s, since neither is better", "every limit is kept",
)  # fmt: skip
FINDINGS = (
    Finding("largest difference", 1 / 3e6, 2e-6, "s"),
    Finding("order", 4.1, 3.8, at_least=True, uncertainty=0.1, remark="fitted line"),
    Finding("wings", 60),
    Finding("peaks", 3, remark="quoted only"),
)
TIMES = Table.of(
    "Times by both codes",
    [
        {"wing": "table 6", "uqfold (s)": 0.53558, "other (s)": math.inf},
        {"wing": "table 10, <b>material</b>", "uqfold (s)": math.nan, "other (s)": None},
    ],
)
TAIL = Points(
    "Failure probability against the threshold",
    "threshold (s)",
    "failure probability",
    Table.of(
        "tail",
        [
            {"series": "reference", "x": 0.54, "y": 0.1, "low": 0.09, "high": 0.11},
            {"series": "reference", "x": 0.55, "y": 1e-3, "low": 9e-4, "high": 1.1e-3},
            {"series": "mc", "x": 0.54, "y": 0.1, "low": None, "high": None},
            {"series": "mc", "x": 0.55, "y": None, "low": None, "high": None},
        ],
    ),
    log="y",
    limits={"limit": 1e-4},
)
MADE: dict[str, Any] = {
    "seed": None,
    "settings": {},
    "command": "uqfold validate a_case",
    "date": "2026-01-02T03:04:05+00:00",
    "machine": "x86_64, 2 cores",
    "versions": {"uqfold": "0.1.0", "numpy": "2.1.0"},
    "source": {"uqfold/mechanism": "0123456789abcdef"},
}
CLAIMS = (
    Claim("first", "It falls.", "Section 1", "never rises", identity=True),
    Claim("second", "It settles.", "Fig. 2", "within 1 % of the end"),
)


def full_record(**changes: Any) -> CaseRecord:
    """Return the record of a made-up case that holds; fields of its declaration may be changed."""
    declared = {key: changes.pop(key) for key in list(changes) if hasattr(DECLARED, key)}
    fields: dict[str, Any] = {
        "case": replace(DECLARED, **declared),
        "tier": "quick",
        "measurement": Measurement(FINDINGS, (TIMES,), (TAIL,)),
        "made": MADE,
        "seconds": 1.25,
        "faults": (
            PlantedFault(Fault("wrong sign", "the sign of friction"), "does not hold"),
            PlantedFault(Fault("stale reference", "an older table")),
        ),
    }
    return CaseRecord(**{**fields, **changes})


def claims_record(rise: float = 0.0) -> CaseRecord:
    """Return the record of a case with two claims."""
    findings = (
        Finding("largest rise", rise, 1e-9, claim="first"),
        Finding("distance from the end", 0.02, 0.01, claim="second"),
    )
    return full_record(measurement=Measurement(findings, claims=CLAIMS))
