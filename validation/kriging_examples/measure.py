"""Kriging with its default settings on all criteria of the reference tables, with many seeds."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import Any

import numpy as np

from uqfold.methods.kriging import Kriging
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.reference import Reference
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work

PROBLEMS: dict[str, Callable[[], Problem]] = {
    "Example 1": series,
    "Example 2": four_bar,
    "Example 3": folding_wing,
}
MAX_EVALS, FEW_EVALS = 100, 20
LARGEST_PF = 0.5
LIMITS = ((1e-3, 0.01), (1e-4, 0.02), (1e-6, 0.05))
"""Smallest pf of a band, and the largest error there."""
REFERENCE_SHARE = 0.25
"""A reference judges if its standard error is at most this share of the error allowed."""
LARGEST_Z = 1.5
"""Root mean square of the error in stated errors; over 20 seeds three standard errors above one."""


@cache
def _problem(name: str) -> Problem:
    return PROBLEMS[name]()


@cache
def _references(name: str) -> tuple[Reference, ...]:
    """All references with a pf in one of the bands."""
    lowest = LIMITS[-1][0]
    return tuple(r for r in _problem(name).references or () if lowest <= r.pf <= LARGEST_PF)


def answers(name: str, seed: int, max_evals: int) -> dict[str, Any]:
    """Failure probabilities and stated errors of all criteria with one seed, and the time taken."""
    asked = [known.criterion for known in _references(name)]
    started = time.perf_counter()
    result = Kriging().estimate(_problem(name), asked, max_evals=max_evals, rng=seed)
    return {
        "pf": [row.pf for row in result],
        "stated": [row.std_error for row in result],
        "converged": sum(row.status == "converged" for row in result),
        "seconds": time.perf_counter() - started,
    }


def measure(work: Work) -> Measurement:
    """Answer every criterion with 1, 3 or 20 seeds."""
    first, count = work.seeds[0], work.pick(1, 3, 20)
    max_evals = FEW_EVALS if work.fault == "few runs" else MAX_EVALS
    # the model is compiled on its first run, which is nobody's time
    _problem("Example 3").model(_problem("Example 3").inputs.from_standard_normal(np.zeros((1, 5))))
    found = work.parts(
        {
            f"{name}, seed {seed}": partial(answers, name, seed, max_evals)
            for name in PROBLEMS
            for seed in range(first, first + count)
        }
    )
    findings, table = [Finding("model runs", max_evals), Finding("seeds", count)], []
    for name in PROBLEMS:
        own = [found[f"{name}, seed {seed}"] for seed in range(first, first + count)]
        rows = _rows(name, own, 1.03 if work.fault == "stale reference" else 1.0)
        groups = [
            _group(name, synchronized, band, rows)
            for synchronized in (False, True)
            for band in range(len(LIMITS))
        ]
        table += [group for group in groups if group["criteria"]]
        z = math.sqrt(float(np.mean([row["z"] ** 2 for row in rows])))
        findings += [_finding(group) for group in groups if group["judged"]]
        findings.append(Finding(f"{name}: errors in stated errors", z, LARGEST_Z))
    return Measurement(
        findings, [Table.of("Worst criterion of every band, root mean square", table)]
    )


def _rows(name: str, own: Sequence[dict[str, Any]], factor: float) -> list[dict[str, Any]]:
    """One row per criterion, over all seeds."""
    pf, stated = (np.array([one[key] for one in own]) for key in ("pf", "stated"))
    rows = []
    for i, known in enumerate(_references(name)):
        exact = factor * known.pf
        band = sum(known.pf < floor for floor, _ in LIMITS)
        error: FloatArray = pf[:, i] / exact - 1.0
        both = np.hypot(stated[:, i], known.std_error)
        rows.append(
            {
                "criterion": known.criterion,
                "band": band,
                "judges": known.std_error <= REFERENCE_SHARE * LIMITS[band][1] * known.pf,
                "rms": math.sqrt(float(np.mean(error**2))),
                "bias": float(error.mean()),
                "z": math.sqrt(float(np.mean(((pf[:, i] - exact) / both) ** 2))),
            }
        )
    return rows


def _group(
    name: str, synchronized: bool, band: int, rows: Sequence[dict[str, Any]]
) -> dict[str, Any]:
    """The worst criterion of one band."""
    own = [
        row
        for row in rows
        if row["band"] == band and (row["criterion"].tau is not None) == synchronized
    ]
    judged = [row for row in own if row["judges"]]
    worst = max(judged, key=lambda row: row["rms"], default=None)
    return {
        "example": name,
        "synchronization": synchronized,
        "pf down to": LIMITS[band][0],
        "criteria": len(own),
        "judged": len(judged),
        "largest rms error (%)": None if worst is None else 100.0 * worst["rms"],
        "limit (%)": 100.0 * LIMITS[band][1],
        "bias there (%)": None if worst is None else 100.0 * worst["bias"],
        "at": "" if worst is None else str(worst["criterion"]),
    }


def _finding(group: dict[str, Any]) -> Finding:
    kind = "with" if group["synchronization"] else "without"
    return Finding(
        f"{group['example']}, pf down to {group['pf down to']:g} {kind} synchronization: "
        "largest root mean square error",
        group["largest rms error (%)"],
        group["limit (%)"],
        "%",
        remark=f"{group['judged']} of {group['criteria']} criteria judged, at {group['at']}",
    )
