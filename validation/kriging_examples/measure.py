"""Kriging with its default settings on all criteria of the reference tables, with many seeds."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from uqfold.methods.kriging import Kriging
from uqfold.problems.reference import Reference
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import EXAMPLES, answers, references, rms

MAX_EVALS, FEW_EVALS = 100, 20
LARGEST_PF = 0.5
LIMITS = {1e-3: 0.01, 1e-4: 0.02, 1e-6: 0.05}
"""Smallest pf of a band -> largest error there."""
REFERENCE_SHARE = 0.25
"""A reference judges if its standard error is at most this share of the error allowed."""
LARGEST_Z = 1.5
"""Root mean square of the error in stated errors; over 20 seeds three standard errors above one."""


def known(example: str, fault: str | None) -> list[Reference]:
    """Return all references with a pf in one of the bands."""
    factor = 1.03 if fault == "stale reference" else 1.0
    return [
        replace(one, pf=factor * one.pf)
        for one in references(EXAMPLES[example]())
        if min(LIMITS) <= one.pf <= LARGEST_PF
    ]


def ask(example: str, seed: int, fault: str | None) -> pd.DataFrame:
    """Answer all criteria with one seed."""
    budget = FEW_EVALS if fault == "few runs" else MAX_EVALS
    problem = EXAMPLES[example]()
    return answers(Kriging(), problem, known(example, fault), max_evals=budget, seed=seed)


def judge(example: str, rows: pd.DataFrame) -> tuple[list[Finding], list[dict[str, Any]]]:
    """Judge the worst criterion of every band of pf, over all seeds; return table rows as well."""
    criteria = rows.groupby("criterion", sort=False).agg(
        tau=("tau", "first"),
        known=("known", "first"),
        known_error=("known_error", "first"),
        rms=("error", rms),
        bias=("error", "mean"),
    )
    floors = np.sort([*LIMITS])
    band = floors[np.searchsorted(floors, criteria["known"], "right") - 1]
    findings, table = [], []
    for (alone, floor), own in criteria.groupby([criteria["tau"].isna(), band]):
        limit = LIMITS[floor]
        judged = own[own["known_error"] <= REFERENCE_SHARE * limit * own["known"]]
        row = {
            "example": example,
            "synchronization": not alone,
            "pf down to": floor,
            "criteria": len(own),
            "judged": len(judged),
            "largest rms error (%)": 100.0 * judged["rms"].max(),
            "limit (%)": 100.0 * limit,
            "bias there (%)": None,
            "at": "",
        }
        if len(judged):
            worst = judged.loc[judged["rms"].idxmax()]
            row |= {"bias there (%)": 100.0 * worst["bias"], "at": worst.name}
            what = (
                f"{example}, pf down to {floor:g} {'without' if alone else 'with'} "
                "synchronization: largest root mean square error"
            )
            remark = f"{len(judged)} of {len(own)} criteria judged, at {worst.name}"
            findings.append(
                Finding(what, row["largest rms error (%)"], row["limit (%)"], "%", remark=remark)
            )
        table.append(row)
    findings.append(Finding(f"{example}: errors in stated errors", rms(rows["z"]), LARGEST_Z))
    return findings, table


def measure(work: Work) -> Measurement:
    """Answer every criterion with 1, 3 or 20 seeds."""
    count = work.pick(1, 20)
    seeds = range(work.seeds[0], work.seeds[0] + count)
    found = work.parts(
        {
            f"{example}, seed {seed}": partial(ask, example, seed, work.fault)
            for example in EXAMPLES
            for seed in seeds
        }
    )
    budget = FEW_EVALS if work.fault == "few runs" else MAX_EVALS
    findings, table = [Finding("model runs", budget), Finding("seeds", count)], []
    for example in EXAMPLES:
        rows = pd.concat([found[f"{example}, seed {seed}"] for seed in seeds])
        judged, worst = judge(example, rows)
        findings += judged
        table += worst
    title = "Worst criterion of every band, root mean square"
    return Measurement(findings, [Table.of(title, table)])
