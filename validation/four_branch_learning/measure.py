"""Active Kriging on a system with four failure regions, repeated with many seeds."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import pandas as pd

from uqfold.methods.active_kriging import ActiveKriging
from uqfold.problems import four_branch
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import answers, references, rms

MAX_EVALS = 100
LARGEST_BIAS = 0.02
LARGEST_RMSE = 0.05
LARGEST_Z = 3.0


def measure(work: Work) -> Measurement:
    """Repeat with 4, 20 or 50 seeds."""
    first, count = work.seeds[0], work.pick(4, 50)
    problem = four_branch()
    known = references(problem, problem.default_criteria)
    if work.fault == "one region":
        known = [replace(one, pf=4.0 * one.pf) for one in known]
    ask = partial(answers, ActiveKriging(), problem, known, max_evals=MAX_EVALS)
    runs = [partial(ask, seed=seed) for seed in range(first, first + count)]
    rows = pd.concat(work.parts({str(run.keywords["seed"]): run for run in runs}).values())
    if work.fault == "overconfident":
        rows["z"] *= 10.0
    errors, runs_taken = rows["error"], rows["n_evals"]
    sure = rows[rows["status"] == "converged"]
    scatter = errors.std() / math.sqrt(count)
    findings = [
        Finding("seeds", count),
        Finding("converged runs", len(sure), 1, at_least=True),
        Finding("model runs, mean", runs_taken.mean()),
        Finding("model runs, largest", runs_taken.max(), MAX_EVALS),
        Finding("bias, absolute", abs(errors.mean()), LARGEST_BIAS, uncertainty=2.0 * scatter),
        Finding("root mean square error", rms(errors), LARGEST_RMSE),
        Finding("largest error of a converged run in its stated errors", sure["z"].abs().max(),
                LARGEST_Z),
    ]  # fmt: skip
    columns = {
        "seed": "seed", "pf": "pf", "std_error": "stated error", "n_evals": "model runs",
        "status": "status", "error": "relative error", "z": "stated errors away",
    }  # fmt: skip
    return Measurement(findings, [Table.of("All runs", rows[[*columns]].rename(columns=columns))])
