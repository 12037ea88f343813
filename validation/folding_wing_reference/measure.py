"""The shipped reference of the folding wing against counts of plain Monte Carlo.

The counts of the paper's own size are stored as a summary (`crude.csv`); the full tier makes them
anew.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd

from uqfold.methods import MonteCarlo
from uqfold.problems import Problem, folding_wing
from uqfold.problems.criterion import Criterion
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import against, answers, references, rms

STORED = Path(__file__).with_name("crude.csv")
MOST = 4.0
"""Joint standard errors allowed."""
SYSTEMS, FEW = 2_000_000, 5_000
SLOWER = 1e-3
"""Delay of the planted slower wing (s)."""


def slower_wing() -> Problem:
    """Return the folding wing, every deployment `SLOWER` later."""
    wing = folding_wing()
    return Problem(
        lambda x: wing.model(x) + SLOWER,
        inputs=wing.inputs.distribution,
        names=wing.inputs.names,
        shared=wing.inputs.shared_names,
        units=wing.n_units,
    )


def measure(work: Work) -> Measurement:
    """Compare with the stored counts; in the full tier with counts made now."""
    stored = pd.read_csv(STORED)
    asked = [
        Criterion(T, None if pd.isna(tau) else tau, missions)
        for T, tau, missions in zip(
            stored["threshold (s)"], stored["tau (s)"], stored["missions"], strict=True
        )
    ]
    wing = folding_wing()
    larger = 1.01 if work.fault == "one per cent" else 1.0
    known = [replace(one, pf=larger * one.pf) for one in references(wing, asked)]
    [seed] = work.seeds
    systems = FEW if work.fault == "slower wing" else SYSTEMS
    if work.fault == "slower wing":
        rows = answers(MonteCarlo(systems=FEW), slower_wing(), known, seed=seed)
    elif work.tier == "full":
        rows = answers(MonteCarlo(systems=SYSTEMS), wing, known, seed=seed)
    else:
        rows = against(stored, known)
    table = pd.DataFrame(
        {
            "threshold (s)": [one.threshold for one in asked],
            "tau (s)": [one.tau for one in asked],
            "reference": rows["known"],
            "counted": rows["pf"],
            "difference (standard errors)": rows["z"],
        }
    )
    findings = [
        Finding("systems", systems),
        Finding("rows", len(rows)),
        Finding("largest difference", rows["z"].abs().max(), MOST, "standard errors"),
        Finding("root mean square difference", rms(rows["z"]), unit="standard errors"),
    ]
    return Measurement(findings, [Table.of("Failure probabilities", table)])
