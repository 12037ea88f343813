"""Active Kriging on a system with four failure regions, repeated with many seeds."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from uqfold.methods.active_kriging import ActiveKriging
from uqfold.problems import four_branch
from uqfold.validation import Finding, Measurement, Table, Work

MAX_EVALS = 100
LARGEST_BIAS = 0.02
LARGEST_RMSE = 0.05
LARGEST_Z = 3.0


def answer(seed: int) -> dict[str, Any]:
    """Give the answer of one run and what it says of itself."""
    problem = four_branch()
    row = ActiveKriging().estimate(problem, max_evals=MAX_EVALS, rng=seed)[0]
    return {
        "seed": seed,
        "pf": row.pf,
        "stated error": row.std_error,
        "model runs": row.n_evals,
        "status": row.status,
    }


def exact_pf() -> float:
    """Give the reference of the problem's own criterion."""
    problem = four_branch()
    assert problem.references is not None
    assert problem.default_criteria is not None
    known = problem.references.lookup(problem.default_criteria[0])
    assert known is not None
    return known.pf


def measure(work: Work) -> Measurement:
    """Repeat with 4, 20 or 50 seeds."""
    first, count = work.seeds[0], work.pick(4, 20, 50)
    parts = {f"seed {seed}": partial(answer, seed) for seed in range(first, first + count)}
    rows = list(work.parts(parts).values())
    exact = exact_pf()
    if work.fault == "one region":
        exact *= 4.0
    scale = 0.25 if work.fault == "overconfident" else 1.0
    for row in rows:
        row["relative error"] = row["pf"] / exact - 1.0
        row["stated errors away"] = (row["pf"] - exact) / (scale * row["stated error"])
    errors = np.array([row["relative error"] for row in rows])
    sure = [abs(row["stated errors away"]) for row in rows if row["status"] == "converged"]
    bias, scatter = float(errors.mean()), float(errors.std(ddof=1) / math.sqrt(count))
    runs = [row["model runs"] for row in rows]
    findings = [
        Finding("seeds", count),
        Finding("converged runs", len(sure), 1, at_least=True),
        Finding("model runs, mean", float(np.mean(runs))),
        Finding("model runs, largest", max(runs), MAX_EVALS),
        Finding("bias, absolute", abs(bias), LARGEST_BIAS, uncertainty=2.0 * scatter),
        Finding("root mean square error", float(np.sqrt(np.mean(errors**2))), LARGEST_RMSE),
        Finding(
            "largest error of a converged run in its stated errors",
            max(sure, default=math.nan),
            LARGEST_Z,
        ),
    ]
    return Measurement(findings, [Table.of("All runs", rows)])
