"""The shipped reference of the folding wing against counts of plain Monte Carlo.

The counts of the paper's own size are stored as a summary (`crude.csv`); the full tier makes them
anew, with a store, so that an interrupted run goes on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import uqfold
from uqfold.evaluation import Evaluator
from uqfold.methods import MonteCarlo
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.stored_times import read_rows

STORED = Path(__file__).with_name("crude.csv")
MOST = 4.0
"""Joint standard errors allowed."""
SYSTEMS = 2_000_000
FEW = 5_000
SLOWER = 1e-3
"""Delay of the planted slower wing (s)."""

Answers = Mapping[Criterion, tuple[float, float]]
"""Criterion -> pf and its standard error."""


def stored_answers() -> Answers:
    """Give what plain Monte Carlo gave at full size."""
    return {
        Criterion(
            float(row["threshold (s)"]),
            float(row["tau (s)"]) if row["tau (s)"] else None,
            int(row["missions"]),
        ): (float(row["pf"]), float(row["std_error"]))
        for row in read_rows(STORED)
    }


def simulated_answers(
    problem: Problem, asked: Sequence[Criterion], systems: int, seed: int, store: Path | None
) -> Answers:
    """Count failed systems now."""
    if store is not None:
        store.parent.mkdir(parents=True, exist_ok=True)
    result = MonteCarlo(systems=systems).estimate(
        problem, list(asked), rng=seed, evaluator=Evaluator(store=store)
    )
    return {c: (row.pf, row.std_error) for c, row in zip(asked, result, strict=True)}


def slower_wing() -> Problem:
    """The folding wing, every deployment `SLOWER` later."""
    wing = uqfold.problems.folding_wing()
    return Problem(
        lambda x: wing.model(x) + SLOWER,
        inputs=wing.inputs.distribution,
        names=wing.inputs.names,
        shared=wing.inputs.shared_names,
        units=wing.n_units,
    )


def compare(known: Answers, counted: Answers) -> list[dict[str, Any]]:
    """One row per criterion, with the difference in joint standard errors."""
    return [
        {
            "threshold (s)": c.threshold,
            "tau (s)": c.tau,
            "reference": known[c][0],
            "counted": pf,
            "difference (standard errors)": (pf - known[c][0])
            / float(np.hypot(error, known[c][1])),
        }
        for c, (pf, error) in counted.items()
    ]


def measure(work: Work) -> Measurement:
    """Compare with the stored counts; in the full tier with counts made now."""
    wing = uqfold.problems.folding_wing()
    assert wing.references is not None
    stored = stored_answers()
    larger = 1.01 if work.fault == "one per cent" else 1.0
    known = {c: (larger * wing.references.entries[c].pf, wing.references.entries[c].std_error)
             for c in stored}  # fmt: skip
    [seed] = work.seeds
    counted, systems = stored, SYSTEMS
    if work.fault == "slower wing":
        counted, systems = simulated_answers(slower_wing(), list(stored), FEW, seed, None), FEW
    elif work.tier == "full":
        store = None if work.kept is None else work.kept / "wing.db"
        counted = simulated_answers(wing, list(stored), SYSTEMS, seed, store)
    rows = compare(known, counted)
    z = np.array([row["difference (standard errors)"] for row in rows])
    findings = [
        Finding("systems", systems),
        Finding("rows", len(rows)),
        Finding("largest difference", float(np.abs(z).max()), MOST, "standard errors"),
        Finding(
            "root mean square difference", float(np.sqrt(np.mean(z**2))), None, "standard errors"
        ),
    ]
    return Measurement(findings, [Table.of("Failure probabilities", rows)])
