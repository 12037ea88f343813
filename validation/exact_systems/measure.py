"""Every registered method on systems whose failure probability is known exactly."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from uqfold.methods import available
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.result import NO_ANSWER
from uqfold.problems.criterion import Binomial, Criteria, Criterion, criteria
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.validation import Finding, Measurement, Table, Work

SYSTEMS = {
    "one unit": LinearNormalSystem(units=1),
    "three units": LinearNormalSystem(units=3, shared_std=0.3),
    "four units, common causes": LinearNormalSystem(units=4, shared_std=0.8),
}

SETTINGS: dict[str, ReliabilityMethod] = {
    "ffni-spa": FFNISaddlepoint(nodes_shared=9),
    "ffni-pearson": FFNIPearson(nodes_shared=9),
}
"""Methods whose default settings are the paper's; how far three nodes go is what the cases of the
examples measure."""

TOLERANCE = 0.01
"""Largest relative error of a method that states none."""

UNSTATED = 1e-3
"""Largest relative error of a surrogate beyond what it states: the surface is integrated by rules
whose own error it takes to be 1e-4, and which several missions of several units magnify."""

STANDARD_ERRORS = 4.5
"""Largest error in stated standard errors: of 100 normal numbers one in 1,500 grids exceeds it."""


def grid(system: LinearNormalSystem) -> Criteria:
    """Thresholds from the body far into the tail; with and without tau; three mission profiles."""
    spread = math.hypot(system.shared_std, system.individual_std)
    thresholds = [10.0 + k * spread for k in (0.5, 1.5, 2.5, 3.5)]
    return criteria(threshold=thresholds, tau=[None, 3.5], missions=[1, 5, Binomial(4, 0.7)])


@cache
def exact_pf(system: LinearNormalSystem, criterion: Criterion) -> float:
    """Give the exact failure probability; all methods share it."""
    return system.pf(criterion)


def answers(name: str, budget: int, seed: int, fault: str | None) -> list[dict[str, Any]]:
    """Rows of one method on all systems."""
    method = SETTINGS.get(name) or available()[name]()
    rows = []
    for label, system in SYSTEMS.items():
        asked = grid(system)
        known = system
        if fault == "uncorrelated":
            # the same spread of a unit, but nothing in common
            spread = math.hypot(system.shared_std, system.individual_std)
            known = replace(system, shared_std=0.0, individual_std=spread)
        if fault == "one unit fewer":
            known = replace(system, units=system.units + 1)
        result = method.estimate(system.problem(), asked, max_evals=budget, rng=seed)
        for criterion, row in zip(asked, result, strict=True):
            exact = exact_pf(known, criterion)
            answered = row.status not in NO_ANSWER
            stated = row.std_error
            if fault == "overconfident":
                stated *= 0.25
            z = (row.pf - exact) / stated if answered and stated > 0.0 else None
            rows.append(
                {
                    "method": name,
                    "system": label,
                    "T": criterion.threshold,
                    "tau": criterion.tau,
                    "missions": str(criterion.missions),
                    "exact": exact,
                    "pf": row.pf if answered else None,
                    "relative error": row.pf / exact - 1.0 if answered else None,
                    "stated": stated / exact if answered else None,
                    "error kind": row.error_kind,
                    "standard errors": z,
                    "status": row.status,
                    "model runs": row.n_evals,
                }
            )
    return rows


def judge(name: str, rows: list[dict[str, Any]]) -> list[Finding]:
    """Judge one method by what it says of its own error."""
    answered = [row for row in rows if row["pf"] is not None]
    firm = [row for row in answered if row["status"] != "doubtful"]
    findings = [
        Finding(f"{name}: criteria answered", len(answered), remark=f"of {len(rows)}"),
        Finding(f"{name}: answers without doubt", len(firm), 1, at_least=True),
    ]
    silent = [abs(row["relative error"]) for row in firm if row["error kind"] == "none"]
    stated = [abs(row["standard errors"]) for row in firm if row["standard errors"] is not None]
    if silent:
        findings.append(Finding(f"{name}: largest relative error", max(silent), TOLERANCE))
    surrogate = [row for row in firm if row["error kind"] == "surrogate"]
    if surrogate:
        beyond = max(
            abs(row["relative error"]) - STANDARD_ERRORS * row["stated"] for row in surrogate
        )
        findings += [
            Finding(
                f"{name}: largest relative error beyond the stated", max(beyond, 0.0), UNSTATED
            ),
            Finding(f"{name}: largest error in stated errors", max(stated)),
        ]
    elif stated:
        findings.append(
            Finding(f"{name}: largest error in standard errors", max(stated), STANDARD_ERRORS)
        )
    return findings


def measure(work: Work) -> Measurement:
    """Ask every method with a budget of 20,000, 100,000 or 1,000,000 runs."""
    budget = work.pick(20_000, 100_000, 1_000_000)
    by_method = work.parts(
        {name: partial(answers, name, budget, work.seeds[0], work.fault) for name in available()}
    )
    findings = [one for name, rows in by_method.items() for one in judge(name, rows)]
    summary = [
        _summary(name, label, [row for row in rows if row["system"] == label])
        for name, rows in by_method.items()
        for label in SYSTEMS
    ]
    table = Table.of(f"Answers of all methods, {budget:,} runs at most", summary)
    return Measurement(findings, [table])


def _summary(name: str, system: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    firm = [row for row in rows if row["pf"] is not None and row["status"] != "doubtful"]
    errors = [abs(row["relative error"]) for row in firm]
    stated = [abs(row["standard errors"]) for row in firm if row["standard errors"] is not None]
    return {
        "method": name,
        "system": system,
        "criteria": len(rows),
        "answered without doubt": len(firm),
        "smallest exact pf answered": min((row["exact"] for row in firm), default=None),
        "median relative error (%)": 100.0 * float(np.median(errors)) if errors else None,
        "largest relative error (%)": 100.0 * max(errors) if errors else None,
        "largest error (stated standard errors)": max(stated, default=None),
        "model runs": rows[0]["model runs"],
    }
