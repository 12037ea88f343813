"""A record with everything in it, for tests."""

import math

from uqfold.comparison.findings import Finding
from uqfold.evidence import (
    Axis,
    CaseRecord,
    Figure,
    Measurement,
    PlantedFault,
    Series,
    StoredResult,
    Table,
)


def full_record(**changes: object) -> CaseRecord:
    """A record of a made-up case that holds."""
    findings = (
        Finding("largest difference", 1 / 3e6, 2e-6, "s"),
        Finding("order", 4.1, 3.8, at_least=True, uncertainty=0.1, remark="fitted line"),
        Finding("wings", 60),
        Finding("peaks", 3, remark="quoted only"),
    )
    table = Table.of(
        "times",
        "Times by both codes",
        [
            {"wing": "table 6", "uqfold (s)": 0.53558, "other (s)": math.inf},
            {"wing": "table 10, <b>material</b>", "uqfold (s)": math.nan, "other (s)": None},
        ],
    )
    figure = Figure(
        "tail",
        "Failure probability against the threshold",
        Axis("threshold", "s"),
        Axis("failure probability", scale="log"),
        (
            Series("reference", (0.54, 0.55), (0.1, 1e-3), (0.09, 9e-4), (0.11, 1.1e-3),
                   reference=True),
            Series("Monte Carlo", (0.54, 0.55), (0.1, None), style="points", method="mc"),
        ),
        y_marks=(("limit", 1e-4),),
    )  # fmt: skip
    fields: dict[str, object] = {
        "name": "a_case",
        "topic": "mechanism",
        "title": "A case",
        "claim": "It is so.",
        "kind": "cross-code",
        "compared_with": "another code",
        "uncertainty": "1e-9 s",
        "source": "that code, version 2",
        "command": "uqfold validate a_case",
        "seeds": (1, 2**70),
        "tolerance": "2e-6 s, since neither is better",
        "verdict_rule": "every limit is kept",
        "tier": "default",
        "measurement": Measurement(findings, (table,), (figure,)),
        "date": "2026-01-02T03:04:05+00:00",
        "seconds": 1.25,
        "machine": "x86_64, 2 cores",
        "versions": {"uqfold": "0.1.0", "numpy": "2.1.0"},
        "code": {"uqfold/mechanism": "0123456789abcdef"},
        "faults": (
            PlantedFault("wrong sign", "the sign of friction", "does not hold"),
            PlantedFault("stale reference", "an older table"),
        ),
        "stored": StoredResult(
            "2025-12-31T00:00:00+00:00", True, (), (Finding("more", 1.0, 2.0),), 60.0, "x86_64"
        ),
    }
    return CaseRecord(**{**fields, **changes})  # type: ignore[arg-type]
