"""Methods asked about problems whose answers are known: how far off are they, and do they know it?

`case.toml` says for each case which methods are asked about which problems, with how many model
runs and seeds, and what of their answers is judged:

* ``beyond``: the largest error that goes beyond some standard errors, those of answer and reference
  joined; answers that a method doubts itself do not count;
* ``bands``: the root mean square error over the seeds, at the worst criterion of each band of pf;
* ``intervals``: how often intervals hold the truth, and how large errors are against the stated
  ones, over many seeds, both with two standard errors of so many repeats.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

from uqfold.methods import available
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.steps import SequentialMethod
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, criteria
from uqfold.problems.reference import Reference
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.validation import Finding, Measurement, Points, Table, Work

SYSTEMS = {
    "one unit": LinearNormalSystem(units=1),
    "three units": LinearNormalSystem(units=3, shared_std=0.3),
    "four units, common causes": LinearNormalSystem(units=4, shared_std=0.8),
}
"""Linear systems, whose answers are exact."""
PROBLEMS: dict[str, Callable[[], Problem]] = {
    "series": series,
    "four_bar": four_bar,
    "four_bar_crossed": partial(four_bar, branch="crossed"),
    "folding_wing": folding_wing,
    **{name: system.problem for name, system in SYSTEMS.items()},
}
"""Name -> what builds the problem: the paper's examples, with references, and the systems."""
CERTAIN = 0.025
"""A reference judges if its standard error is at most this share of pf, and a quarter of an error
that a band allows."""
FEW_RUNS = 20
MOST_POINTS = 150


@cache
def references(name: str) -> list[Reference]:
    """Return all known answers to a problem.

    Those of a linear system reach from the body far into the tail, with and without tau, with
    three mission profiles.
    """
    if name not in SYSTEMS:
        return list(PROBLEMS[name]().references or ())
    system = SYSTEMS[name]
    spread = math.hypot(system.shared_std, system.individual_std)
    thresholds = [10.0 + k * spread for k in (0.5, 1.5, 2.5, 3.5)]
    asked = criteria(threshold=thresholds, tau=[None, 3.5], missions=[1, 5, Binomial(4, 0.7)])
    return [Reference(one, system.pf(one), 0.0) for one in asked]


def methods_of(settings: Mapping[str, Any]) -> list[str]:
    """Return the methods of a case: those that it lists, all, or those that sample the system."""
    chosen = settings["methods"]
    if not isinstance(chosen, str):
        return list(chosen)
    built = {name: method() for name, method in available().items()}
    return [
        name
        for name, method in built.items()
        if chosen == "all" or (method.stochastic and not isinstance(method, SequentialMethod))
    ]


def method_of(name: str, work: Work) -> ReliabilityMethod:
    """Build a method with the settings that the case gives it."""
    if work.fault == "kriging":
        return available()["kriging"]()
    options = dict(work.settings.get("options", {}).get(name, {}))
    if work.fault == "two nodes":
        options["nodes_individual"] = 2
    return available()[name](**options)


def ask(problem_name: str, name: str, seed: int, work: Work) -> pd.DataFrame:
    """Ask a method about a problem; return one row for each criterion that it supports."""
    settings = work.settings
    low, high = settings["pf"]
    known = [
        one
        for one in references(problem_name)
        if low < one.pf <= high
        and one.std_error <= CERTAIN * one.pf
        and (one.criterion.tau is not None or name not in settings.get("only_with_tau", ()))
    ]
    if settings.get("few_taus", False) and work.tier == "quick":
        known = with_few_taus(known)
    count = work.pick(*settings["criteria"]) if "criteria" in settings else len(known)
    known = known[:: max(1, len(known) // count)]
    if work.fault == "stale reference":
        known = [replace(one, pf=min(1.2 * one.pf, 1.0)) for one in known]
    runs = work.pick(*settings["runs"]) if "runs" in settings else None
    runs = FEW_RUNS if work.fault == "few runs" else runs
    problem = with_fault(PROBLEMS[problem_name](), work.fault)
    asked = [one.criterion for one in known]
    result = method_of(name, work).estimate(problem, asked, max_evals=runs, rng=seed)
    rows = against(result.to_frame(), known)
    supported = rows[rows["status"] != "unsupported"]
    # of the method that a remedy takes the place of
    return planted(supported, work.fault).assign(method=name, problem=problem_name)


def with_few_taus(known: Sequence[Reference]) -> list[Reference]:
    """Leave out all but two synchronization thresholds: each has integrals of its own."""
    taus = sorted({one.criterion.tau for one in known if one.criterion.tau is not None})
    kept = {None, *taus[len(taus) // 3 :: max((len(taus) + 1) // 2, 1)]}
    return [one for one in known if one.criterion.tau in kept]


def against(found: pd.DataFrame, known: Sequence[Reference]) -> pd.DataFrame:
    """Return answers (``pf`` and ``std_error``) with the references in the same order.

    New columns are ``criterion`` (in words), ``known``, ``known_error`` (the standard error of the
    reference), ``error`` (relative, signed), and ``z``: the difference in joint standard errors,
    NaN where the answer states none.
    """
    pf, std_error = found["pf"], found["std_error"]
    exact = np.array([one.pf for one in known])
    exact_error = np.array([one.std_error for one in known])
    joint = np.hypot(std_error.where(std_error > 0.0), exact_error)
    return found.assign(
        criterion=[str(one.criterion) for one in known],
        known=exact,
        known_error=exact_error,
        error=pf / exact - 1.0,
        z=(pf - exact) / joint,
    )


def with_fault(problem: Problem, fault: str | None) -> Problem:
    """Return a problem whose inputs a fault has changed."""
    inputs = problem.inputs
    if fault == "uncorrelated":
        return Problem(
            problem.model, inputs=inputs.distribution, names=inputs.names, units=problem.units
        )
    if fault == "wider inputs":
        spread = dict(zip(inputs.names, inputs.standard_deviations, strict=True))
        own = {name: 1.25 * float(spread[name]) for name in inputs.individual_names}
        return problem.with_moments(standard_deviations=own)
    return problem


def planted(rows: pd.DataFrame, fault: str | None) -> pd.DataFrame:
    """Return answers whose intervals and errors a fault has narrowed, or moved."""
    if fault == "biased":
        shift = 2.0 * rows["std_error"]
        moved = {end: rows[end] + shift for end in ("ci_low", "ci_high")}
        return rows.assign(**moved, z=rows["z"] + 2.0)
    if fault == "overconfident":
        middle = 0.5 * (rows["ci_low"] + rows["ci_high"])
        narrow = {end: middle + 0.25 * (rows[end] - middle) for end in ("ci_low", "ci_high")}
        return rows.assign(**narrow, std_error=0.25 * rows["std_error"], z=4.0 * rows["z"])
    return rows


def rms(values: pd.Series) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def firm(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with an answer that the method does not doubt itself."""
    return rows[rows["pf"].notna() & (rows["status"] != "doubtful")]


def beyond(label: str, rows: pd.DataFrame, rule: Mapping[str, float]) -> Iterator[Finding]:
    """Judge the largest error, by the kind of error that the method states.

    A kind with a limit may err by so much beyond the standard errors, any other not at all.
    """
    sure, most = firm(rows), rule["standard_errors"]
    answered = f"of {len(rows)} answers"
    yield Finding(f"{label}: without doubt", len(sure), 1, at_least=True, remark=answered)
    for kind, own in sure.groupby("error_kind"):
        largest = f"{label}: largest error in standard errors"
        if kind not in rule:
            yield Finding(largest, own["z"].abs().max(), most)
            continue
        joint = np.hypot(own["std_error"].fillna(0.0), own["known_error"])
        excess = own["error"].abs() - most * joint / own["known"]
        what = f"{label}: largest relative error beyond {most:g} standard errors"
        yield Finding(what, max(float(excess.max()), 0.0), rule[str(kind)])
        yield Finding(f"{label}: median relative error", own["error"].abs().median())


def bands(label: str, rows: pd.DataFrame, rule: Mapping[str, Any]) -> Iterator[Finding]:
    """Judge the worst criterion of every band of pf, over all seeds."""
    found = rows.groupby("criterion", sort=False).agg(
        known=("known", "first"), known_error=("known_error", "first"), rms=("error", rms)
    )
    above = math.inf
    for floor, limit in rule["limits"]:
        own = found[found["known"].between(floor, above, inclusive="left")]
        judged = own[own["known_error"] <= 0.25 * limit * own["known"]]
        above = floor
        if len(judged):
            where = f"{len(judged)} of {len(own)} criteria judged, at {judged['rms'].idxmax()}"
            what = f"{label}, pf down to {floor:g}: largest root mean square error"
            largest = 100.0 * judged["rms"].max()
            yield Finding(what, largest, 100.0 * limit, "%", remark=where)
    yield Finding(f"{label}: errors in stated errors", rms(rows["z"]), rule["stated_errors"])


def intervals(label: str, rows: pd.DataFrame, rule: Mapping[str, float]) -> Iterator[Finding]:
    """Judge coverage and stated errors at every criterion, over all seeds."""
    for criterion, own in rows.groupby("criterion", sort=False):
        inside, n = own["known"].between(own["ci_low"], own["ci_high"]), len(own)
        # Agresti and Coull: a spread also where every interval holds the truth
        guess = (inside.sum() + 2.0) / (n + 4.0)
        yield Finding(
            f"{label}, {criterion}: coverage", 100.0 * inside.mean(), 100.0 * rule["coverage"], "%",
            at_least=True, uncertainty=200.0 * math.sqrt(guess * (1.0 - guess) / (n + 4.0)),
        )  # fmt: skip
        z = own["z"].dropna()
        # of the root mean square of z, by the delta method
        spread = (z**2).std() / math.sqrt(max(len(z), 1)) / max(rms(z), 1e-300)
        yield Finding(
            f"{label}, {criterion}: empirical over stated error", rms(z), rule["stated_errors"],
            uncertainty=spread,
        )  # fmt: skip


RULES: dict[str, Callable[[str, pd.DataFrame, Any], Iterator[Finding]]] = {
    "beyond": beyond,
    "bands": bands,
    "intervals": intervals,
}


def summary(rows: pd.DataFrame) -> dict[str, Any]:
    """Return what one method gave for one problem, in a row."""
    sure = firm(rows)
    errors = 100.0 * sure["error"].abs()
    return {
        "problem": rows["problem"].iloc[0],
        "method": rows["method"].iloc[0],
        "answers": len(rows),
        "without doubt": len(sure),
        "smallest known pf": sure["known"].min(),
        "median relative error (%)": errors.median(),
        "largest relative error (%)": errors.max(),
        "largest error (standard errors)": sure["z"].abs().max(),
        "model runs": rows["n_evals"].iloc[0],
    }


def errors_drawn(rows: pd.DataFrame, limit: float) -> Points:
    """Return the signed errors over pf with a limit: of many some, among them the extreme ones."""
    shown = []
    for _, own in rows.sort_values("error", kind="stable").groupby("method", sort=False):
        chosen = np.linspace(0, len(own) - 1, min(len(own), MOST_POINTS)).round().astype(int)
        shown.append(own.iloc[chosen])
    drawn = pd.concat(shown)
    title = "Relative error of pf, signed, against the reference's pf"
    errors = {"series": drawn["method"], "x": drawn["known"], "y": 100.0 * drawn["error"]}
    table = Table.of(title, pd.DataFrame(errors))
    lines = {"limit": 100.0 * limit, "-limit": -100.0 * limit}
    return Points(title, "reference pf", "relative error (%)", table, log="x", limits=lines)


def measure(work: Work) -> Measurement:
    """Ask with the runs and seeds of the tier."""
    settings = work.settings
    first, count = work.seeds[0], work.pick(*settings.get("seeds", (1, 1)))
    found = work.parts(
        {
            f"{problem}, {name}, seed {seed}": partial(ask, problem, name, seed, work)
            for problem in settings["problems"]
            for name in methods_of(settings)
            for seed in range(first, first + count)
        }
    )
    rows = pd.concat(found.values())
    findings, table = [Finding("seeds", count)], []
    for (problem, name), own in rows.groupby(["problem", "method"], sort=False):
        for rule, judge in RULES.items():
            if rule in settings:
                findings += judge(f"{problem}, {name}", own, settings[rule])
        table.append(summary(own))
    points = [errors_drawn(rows, settings["drawn"])] if "drawn" in settings else []
    return Measurement(findings, [Table.of("Answers", table)], points)
