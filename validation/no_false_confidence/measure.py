"""Every method on hard problems: what it calls converged is right, what is easy is."""

from __future__ import annotations

import math
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from functools import partial
from typing import Any

import numpy as np

from uqfold.methods import available, build
from uqfold.methods.result import NO_ANSWER
from uqfold.validation import Finding, Measurement, Table, Work
from validation.no_false_confidence.problems import PROBLEMS, Hard

Row = dict[str, Any]

SIMULATION = {"mc", "conditional-mc", "openturns-mc"}
RUNS, SIMULATED = 300, 20_000
"""Budgets: of methods that are sparing with runs, and of simulation."""
MOST_INPUTS = 12
"""A full factorial design over more inputs has no room in any budget."""

QUICK = (
    "linear, 2 inputs, 1e-08",
    "curved in 1 of 2 inputs, T = 3",
    "|x|^2, 2 inputs, 0.0001",
    "correlated normals, T = 6",
    "|a| + b, T = 5",
    "u^2 + 0.1 u, 1 inputs, T = 9",
    "x2 - 100 x1^4",
    "round(2 (x + y)) / 2, T = 3",
    "band at 2.5, 4e-05, 1 inputs",
    "1e+12 + 0.001 u",
    "failed runs beyond 2.5",
)
SLOW = {"active-kriging"}
"""Left out of the quick tier but for one problem in four."""

FAR, VERY_FAR = (3.0, 0.01), (10.0, 0.001)
"""Stated errors, and relative error, from which a row is wrong, and beyond doubt wrong."""
COVERAGE, COVERAGE_OF_FEW, FEW = 0.93, 0.8, 60
"""Least coverage, that of a method with fewer than so many rows, and how many are few."""
ANSWERED = 2.0 / 3.0
SMALL = 10
"""Inputs up to which a smooth problem is to be answered."""
QUANTILE = 1.96


def answer(name: str, method: str, seed: int) -> Row:
    """Ask one method about one problem."""
    hard = next(one for one in PROBLEMS if one.name == name)
    budget = SIMULATED if method in SIMULATION else RUNS
    row = build(method).estimate(hard.problem(), hard.criterion, max_evals=budget, rng=seed)[0]
    return {
        "problem": name,
        "method": method,
        "seed": seed,
        "pf": row.pf,
        "std_error": row.std_error,
        "low": row.ci_low,
        "high": row.ci_high,
        "status": row.status,
    }


def answers(pool: ProcessPoolExecutor | None, hard: Hard, seeds: range, *, quick: bool) -> Any:
    """All rows of one problem; methods that know no chance answer once."""
    asked = []
    for method, kind in available().items():
        if method.startswith("ffni") and hard.d > MOST_INPUTS:
            continue
        if quick and method in SLOW and QUICK.index(hard.name) % 4:
            continue
        asked += [(hard.name, method, seed) for seed in (seeds if kind().stochastic else seeds[:1])]
    if pool is None:
        return [answer(*one) for one in asked]
    return list(pool.map(answer, *zip(*asked, strict=True)))


def judged(row: Row, hard: Hard) -> Row:
    """Add by how much a row is wrong: relatively, and in its own stated errors."""
    beyond = max(0.0, row["pf"] - hard.pf, hard.least - row["pf"])
    scale = min(hard.pf, 1.0 - hard.least)
    # of a skewed interval the part on the side of the truth
    side = row["pf"] - row["low"] if row["pf"] > hard.pf else row["high"] - row["pf"]
    stated = float(np.fmax(row["std_error"], side / QUANTILE))
    far = beyond / stated if stated > 0.0 else (math.inf if beyond > 0.0 else 0.0)
    relative = beyond / scale if scale > 0.0 else (math.inf if beyond > 0.0 else 0.0)
    return {
        **row,
        "relative": relative,
        "stated errors": far,
        "inside": row["low"] <= hard.pf and hard.least <= row["high"],
    }


def wrong(row: Row, limits: tuple[float, float]) -> bool:
    """Whether a row errs by more than both limits."""
    return bool(row["stated errors"] > limits[0] and row["relative"] > limits[1])


def measure(work: Work) -> Measurement:
    """Ask about some problems once, or three times, or about all of them ten times."""
    full = work.tier == "full"
    seeds = range(work.seeds[0], work.seeds[0] + work.pick(1, 3, 10))
    asked = [hard for hard in PROBLEMS if full or hard.name in QUICK]
    with ProcessPoolExecutor(2) if full else nullcontext() as pool:
        parts = {hard.name: partial(answers, pool, hard, seeds, quick=not full) for hard in asked}
        found = work.parts(parts)
    rows = [
        judged(_planted(row, hard, work.fault), hard)
        for hard in asked
        for row in found[hard.name]
        if row["status"] not in NO_ANSWER
    ]
    sure = [row for row in rows if row["status"] == "converged"]
    tables = [
        Table.of("Methods", [_method(name, rows) for name in available()]),
        Table.of("Problems", [_problem(hard, rows) for hard in asked]),
    ]
    mistaken = [row for row in sure if wrong(row, FAR) or wrong(row, VERY_FAR)]
    if mistaken:
        tables.append(Table.of("Converged and wrong", mistaken))
    return Measurement([*_findings(asked, rows, sure)], tables)


def _findings(asked: list[Hard], rows: list[Row], sure: list[Row]) -> list[Finding]:
    easy = {hard.name for hard in asked if hard.smooth and hard.d <= SMALL}
    kriging = [row for row in rows if row["method"] == "kriging" and row["problem"] in easy]
    answered = sum(row["status"] == "converged" for row in kriging) / len(kriging)
    far = sum(wrong(row, FAR) for row in sure)
    findings = [
        Finding("problems", len(asked)),
        Finding("answers", len(rows)),
        Finding("converged rows", len(sure), 1, at_least=True),
        Finding(
            "of these more than 3 stated errors and 1 % off", 100.0 * far / len(sure), 1.0, "%"
        ),
        Finding(
            "of these more than 10 stated errors and 0.1 % off",
            sum(wrong(row, VERY_FAR) for row in sure),
            0,
        ),
        Finding(
            "smooth problems of up to ten inputs on which Kriging is converged",
            100.0 * answered, 100.0 * ANSWERED, "%", at_least=True,
        ),
    ]  # fmt: skip
    for method in available():
        own = [row["inside"] for row in sure if row["method"] == method]
        if own:
            limit = COVERAGE if len(own) >= FEW else COVERAGE_OF_FEW
            findings.append(
                Finding(
                    f"{method}: converged rows whose interval holds the truth",
                    100.0 * sum(own) / len(own), 100.0 * limit, "%", at_least=True,
                )
            )  # fmt: skip
    return findings


def _method(method: str, rows: list[Row]) -> Row:
    """One row of the table of methods."""
    own = [row for row in rows if row["method"] == method]
    sure = [row for row in own if row["status"] == "converged"]
    rest = [row for row in own if row["status"] != "converged"]
    return {
        "method": method,
        "answers": len(own),
        "converged": len(sure),
        "interval holds the truth (%)": _share([row["inside"] for row in sure]),
        "3 stated errors and 1 % off": sum(wrong(row, FAR) for row in sure),
        "unchecked": sum(row["status"] == "unchecked" for row in own),
        "unchecked and 10 % off": sum(
            row["status"] == "unchecked" and row["relative"] > 0.1 for row in own
        ),
        "doubted though within 10 % (%)": _share([row["relative"] <= 0.1 for row in rest]),
    }


def _problem(hard: Hard, rows: list[Row]) -> Row:
    """One row of the table of problems: answers called converged, and their largest error."""
    cells: Row = {"problem": hard.name, "kind": hard.kind, "inputs": hard.d, "pf": hard.pf}
    for method in available():
        own = [row for row in rows if (row["method"], row["problem"]) == (method, hard.name)]
        sure = [row["relative"] for row in own if row["status"] == "converged"]
        cells[method] = f"{len(sure)}/{len(own)}" + (f", {100 * max(sure):.2g} %" if sure else "")
    return cells


def _share(values: list[bool]) -> float | None:
    return 100.0 * sum(values) / len(values) if values else None


def _planted(row: Row, hard: Hard, fault: str | None) -> Row:
    if fault is None or row["method"] != "kriging":
        return row
    if fault == "all doubted":
        return {**row, "status": "doubtful"}
    stated = 0.1 * abs(row["pf"] - hard.pf)
    reach = QUANTILE * stated
    ends = {"low": row["pf"] - reach, "high": row["pf"] + reach}
    return {**row, "std_error": stated, **ends}
