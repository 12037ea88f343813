"""Kriging with its default settings on all criteria of the reference tables, with many seeds."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

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


def criteria(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one row per criterion, over all seeds: band, errors, and whether it judges."""
    found = []
    for (threshold, tau, missions), own in rows.groupby(
        ["threshold", "tau", "missions"], dropna=False, sort=False
    ):
        first = own.iloc[0]
        floor = max(low for low in LIMITS if low <= first["known"])
        allowed = LIMITS[floor] * first["known"]
        found.append(
            {
                "synchronization": pd.notna(tau),
                "floor": floor,
                "criterion": f"T = {threshold:g}, tau = {tau:g}, missions = {missions}",
                "judges": first["known_error"] <= REFERENCE_SHARE * allowed,
                "rms": rms(own["error"]),
                "bias": own["error"].mean(),
            }
        )
    return pd.DataFrame(found)


def band(example: str, floor: float, own: pd.DataFrame, *, synchronized: bool) -> dict[str, Any]:
    """Return the worst criterion of one band."""
    judged = own[own["judges"]].sort_values("rms")
    worst = judged.iloc[-1].to_dict() if len(judged) else {}
    return {
        "example": example,
        "synchronization": synchronized,
        "pf down to": floor,
        "criteria": len(own),
        "judged": len(judged),
        "largest rms error (%)": 100.0 * worst["rms"] if worst else None,
        "limit (%)": 100.0 * LIMITS[floor],
        "bias there (%)": 100.0 * worst["bias"] if worst else None,
        "at": worst.get("criterion", ""),
    }


def finding(worst: dict[str, Any]) -> Finding:
    """Judge the worst criterion of a band."""
    kind = "with" if worst["synchronization"] else "without"
    return Finding(
        f"{worst['example']}, pf down to {worst['pf down to']:g} {kind} synchronization: "
        "largest root mean square error",
        worst["largest rms error (%)"],
        worst["limit (%)"],
        "%",
        remark=f"{worst['judged']} of {worst['criteria']} criteria judged, at {worst['at']}",
    )


def measure(work: Work) -> Measurement:
    """Answer every criterion with 1, 3 or 20 seeds."""
    count = work.pick(1, 3, 20)
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
        groups = criteria(rows).groupby(["synchronization", "floor"], sort=False)
        worst = [
            band(example, floor, own, synchronized=synchronized)
            for (synchronized, floor), own in groups
        ]
        worst.sort(key=lambda one: (one["synchronization"], -one["pf down to"]))
        table += worst
        findings += [finding(one) for one in worst if one["judged"]]
        what = f"{example}: errors in stated errors"
        findings.append(Finding(what, rms(rows["z"]), LARGEST_Z))
    title = "Worst criterion of every band, root mean square"
    return Measurement(findings, [Table.of(title, table)])
