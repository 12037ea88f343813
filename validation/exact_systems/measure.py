"""Every registered method on systems whose failure probability is known exactly."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, partial

import pandas as pd

from uqfold.methods import available
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.problems.criterion import Binomial, criteria
from uqfold.problems.reference import Reference
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import answers, firm

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


@cache
def known(system: LinearNormalSystem) -> list[Reference]:
    """Thresholds from the body far into the tail; with and without tau; three mission profiles."""
    spread = math.hypot(system.shared_std, system.individual_std)
    thresholds = [10.0 + k * spread for k in (0.5, 1.5, 2.5, 3.5)]
    asked = criteria(threshold=thresholds, tau=[None, 3.5], missions=[1, 5, Binomial(4, 0.7)])
    return [Reference(one, system.pf(one), 0.0) for one in asked]


def mistaken(system: LinearNormalSystem, fault: str | None) -> LinearNormalSystem:
    """Return the system whose references are taken: that itself, unless a fault is planted."""
    if fault == "uncorrelated":
        # the same spread of a unit, but nothing in common
        spread = math.hypot(system.shared_std, system.individual_std)
        return replace(system, shared_std=0.0, individual_std=spread)
    return replace(system, units=system.units + 1) if fault == "one unit fewer" else system


def ask(name: str, budget: int, seed: int, fault: str | None) -> pd.DataFrame:
    """Ask one method about all systems."""
    method = SETTINGS.get(name) or available()[name]()
    rows = pd.concat(
        [
            answers(method, system.problem(), known(mistaken(system, fault)), max_evals=budget,
                    seed=seed).assign(system=label)
            for label, system in SYSTEMS.items()
        ]
    )  # fmt: skip
    if fault == "overconfident":
        rows = rows.assign(std_error=rows["std_error"] / 4.0, z=4.0 * rows["z"])
    return rows


def judge(name: str, rows: pd.DataFrame) -> list[Finding]:
    """Judge one method by what it says of its own error."""
    sure = firm(rows)
    silent, surrogate = (sure[sure["error_kind"] == kind] for kind in ("none", "surrogate"))
    largest = sure["z"].abs().max()
    findings = [
        Finding(f"{name}: criteria answered", rows["pf"].count(), remark=f"of {len(rows)}"),
        Finding(f"{name}: answers without doubt", len(sure), 1, at_least=True),
    ]
    if len(silent):
        error = silent["error"].abs().max()
        findings.append(Finding(f"{name}: largest relative error", error, TOLERANCE))
    if len(surrogate):
        stated = STANDARD_ERRORS * surrogate["std_error"] / surrogate["known"]
        beyond = (surrogate["error"].abs() - stated).max()
        what = f"{name}: largest relative error beyond the stated"
        findings += [
            Finding(what, max(beyond, 0.0), UNSTATED),
            Finding(f"{name}: largest error in stated errors", largest),
        ]
    elif not math.isnan(largest):
        what = f"{name}: largest error in standard errors"
        findings.append(Finding(what, largest, STANDARD_ERRORS))
    return findings


def measure(work: Work) -> Measurement:
    """Ask every method with a budget of 20,000, 100,000 or 1,000,000 runs."""
    budget = work.pick(20_000, 1_000_000)
    found = work.parts(
        {name: partial(ask, name, budget, work.seeds[0], work.fault) for name in available()}
    )
    findings = [one for name, rows in found.items() for one in judge(name, rows)]
    summary = []
    for (name, label), rows in pd.concat(found).groupby(["method", "system"], sort=False):
        sure = firm(rows)
        errors = 100.0 * sure["error"].abs()
        summary.append(
            {
                "method": name,
                "system": label,
                "criteria": len(rows),
                "answered without doubt": len(sure),
                "smallest exact pf answered": sure["known"].min(),
                "median relative error (%)": errors.median(),
                "largest relative error (%)": errors.max(),
                "largest error (stated standard errors)": sure["z"].abs().max(),
                "model runs": rows["n_evals"].iloc[0],
            }
        )
    table = Table.of(f"Answers of all methods, {budget:,} runs at most", summary)
    return Measurement(findings, [table])
