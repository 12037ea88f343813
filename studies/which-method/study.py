"""Which method at which budget.

The same 18 criteria are asked of every method with 100, 375, 1,125 and 10,000 model runs for all of
them together. Which method tells most, for failure probabilities from 1e-1 down to 1e-6, without
and with synchronization, and does it know how wrong it is?

Examples 1 and 2 (both branches) have exact references, that of Example 3 (the wing) is known to
0.3 % at 1e-1 and 3 % at 1e-6. Simulation and active Kriging run with 20 seeds, surrogates with 10
(3 at 1,125 runs), a method without randomness once. A method that needs fewer runs than a budget
allows is shown with what it used; one that needs more has no answer there. `fine` is FFNI with 5
nodes per shared and 7 per individual input. The efficiency says how many times the runs crude Monte
Carlo would need for the same mean squared error. All runs take about 12 minutes of one processor.
"""

import math
import sys
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import uqfold
from uqfold import criteria, methods, plots

sys.path.append(str(Path(__file__).parents[1]))
from runner import Run, finish, main, new_page, percent

TOLERANCE = (1e-3, 1e-12)

ASKED = {
    "series": (uqfold.problems.series(), [0, 3, 4.5, 5.5, 6.5, 7.5], [16, 20]),
    "four-bar": (uqfold.problems.four_bar(), [101, 102, 103, 103.75, 104.25, 105], [5, 6]),
    "four-bar-crossed": (
        uqfold.problems.four_bar(branch="crossed"), [-140, -139, -138, -137.5, -137, -136], [5, 6],
    ),
    "folding-wing": (
        uqfold.problems.folding_wing(), [0.555, 0.5625, 0.5725, 0.5775, 0.58, 0.5875], [0.04, 0.06],
    ),
}  # fmt: skip
"""Problem with its thresholds and synchronization thresholds, in the unit of its response."""
PROBLEMS = {name: problem for name, (problem, _, _) in ASKED.items()}
SIMPLE = {
    "mc": methods.MonteCarlo(),
    "conditional-mc": methods.ConditionalMonteCarlo(),
    "openturns-mc": methods.OpenTURNSMonteCarlo(),
    "openturns-form": methods.OpenTURNSFORM(starts=1),
    "ffni-spa": methods.FFNISaddlepoint(check=False),
    "ffni-pearson": methods.FFNIPearson(check=False),
    "ffni-spa-fine": methods.FFNISaddlepoint(nodes_shared=5, nodes_individual=7, check=False),
    "ffni-pearson-fine": methods.FFNIPearson(nodes_shared=5, nodes_individual=7, check=False),
}
SURROGATES = {"kriging": methods.Kriging(runs=1125), "pce": methods.PolynomialChaos(runs=1125)}
ACTIVE = {"active-kriging": methods.ActiveKriging()}
METHODS = {**SIMPLE, **SURROGATES, **ACTIVE}
QUICK = {"mc": 375, "ffni-spa": 375, "ffni-pearson": 375, "pce": 100, "active-kriging": 100}
"""What the reduced form asks with one seed: label -> budget."""
SLOW = {"pce": ["four-bar", "folding-wing"], "active-kriging": ["series", "four-bar-crossed"]}
"""The problems that it asks slow methods about."""
ROWS = [
    "problem", "label", "max_evals", "threshold", "tau", "missions", "pf", "std_error", "status",
    "n_evals", "seed", "reference_pf",
]  # fmt: skip

GROUP = ["problem", "label", "max_evals", "synchronized", "decade"]
"""What answers are pooled by; a decade d has references from 10^d to 10^(d + 1)."""
RESOLUTION = 0.5
"""A reference whose own error exceeds this share of the error found says too little of it."""


def tables(run: Run) -> None:
    """Ask every method on every problem, with every budget and seed."""
    groups = [
        (SIMPLE, [100, 375, 1125, 10_000], 20),
        (SURROGATES, [100, 375], 10),
        (SURROGATES, [1125], 3),
        (ACTIVE, [100], 20),
    ]
    if run.quick:
        groups = [({label: METHODS[label]}, [budget], 1) for label, budget in QUICK.items()]
    found = [
        run.answers({name: problem}, who, criteria(T, [None, *tau]), budgets, seeds)
        for who, budgets, seeds in groups
        for name, (problem, T, tau) in ASKED.items()
        if not run.quick or name in SLOW.get(next(iter(who)), PROBLEMS)
    ]
    answers = pd.concat(found, ignore_index=True)
    first = (answers["seed"] == 0) & (answers["max_evals"] == answers["label"].map(QUICK))
    run.keep("first-seed", answers.loc[first, ROWS])
    run.keep("summary", summary(answers))
    statuses = answers.groupby(["label", "max_evals", "status"], sort=False).size()
    run.keep("statuses", statuses.unstack(fill_value=0).reset_index())


def summary(answers: pd.DataFrame) -> pd.DataFrame:
    """Return bias and scatter of the answers, and whether they know them, by `GROUP`."""
    known = answers[answers["reference_pf"] > 0.0]
    decade = np.ceil(np.log10(known["reference_pf"])).astype(int) - 1
    groups = known.assign(synchronized=known["tau"].notna(), decade=decade).groupby(
        GROUP, sort=False
    )
    return pd.DataFrame([dict(zip(GROUP, key, strict=True)) | _summed(own) for key, own in groups])


def _summed(rows: pd.DataFrame) -> dict[str, Any]:
    own = rows[rows["pf"].notna()]
    known, known_error = own["reference_pf"], own["reference_std_error"]
    error = own["pf"] / known - 1.0
    ratio = (own["pf"] - known) / np.hypot(own["std_error"], known_error)
    stated, slack = own.dropna(subset=["ci_low", "ci_high"]), 2.0 * known_error
    inside = known.between(own["ci_low"] - slack, own["ci_high"] + slack)[stated.index]
    units = own["problem"].map(lambda name: PROBLEMS[name].n_units).astype(float)
    systems = own["n_evals"] / units
    rms, simple = _rms(error), _rms(np.sqrt((1.0 - known) / (known * systems)))
    return {
        "answers": len(own),
        "runs": len(rows),
        "n_evals": own["n_evals"].mean(),
        "bias": error.mean(),
        "bias_error": error.groupby(own["seed"]).mean().sem(),
        "rms": rms,
        "coverage": inside.mean(),
        "error_ratio": _rms(ratio[own["std_error"] > 0.0]),
        "monte_carlo_rms": simple,
        "efficiency": math.inf if rms == 0.0 else (simple / rms) ** 2,
        "judged": bool(_rms(known_error / known) <= RESOLUTION * rms),
    }


def _rms(values: pd.Series) -> float:
    return math.sqrt(values.pow(2).mean())


def page(run: Run) -> "uqfold.report.Page":
    """Show who is best where, who can be trusted, and the errors over budgets."""
    page, summary = new_page(run, __doc__), run.rows("summary")
    page.section("Tables")
    page.table(
        ranking(summary),
        "The three best methods for every decade and budget",
        "References lie between 10^decade and ten times that. By the median over the problems of "
        "the root mean square error; in brackets the worst that a reference can judge. A method is "
        "ranked where it answers everything asked.",
    )
    page.table(
        trust(summary),
        "How much each method answers, how wrong it is, and whether it knows",
        "Medians over problems, decades and synchronization. An error ratio (found over stated) "
        "above 1 says that the method is too sure of itself.",
    )
    page.table(run.rows("statuses"), "What the methods say of their own answers")
    page.section("Figures")
    page.figure(
        error_panels(summary),
        "Error against evaluations, without synchronization and with it (tau)",
        "Root mean square errors of pf; the dashed line is crude Monte Carlo.",
        name="errors",
    )
    return finish(page, run, METHODS)


def ranking(summary: pd.DataFrame) -> pd.DataFrame:
    """Rank methods by the median over problems of their root mean square error."""
    case, rows = ["synchronized", "decade", "max_evals"], []
    for (tau, decade, budget), own in summary.groupby(case):
        complete = own[own["answers"] == own["runs"]].groupby("label")
        median = complete["rms"].median()[complete.size() == own["problem"].nunique()]
        worst = own[own["judged"]].groupby("label")["rms"].max()
        best = median.sort_values().head(3)
        said = [
            f"{label} {percent(rms)} ({percent(max(rms, worst.get(label, 0.0)))})"
            for label, rms in best.items()
        ]
        rows.append((tau, decade, budget, ", ".join(said)))
    table = pd.DataFrame(rows, columns=[*case, "best"])
    table = table.sort_values("decade", ascending=False, kind="stable")
    return table.sort_values("synchronized", kind="stable")


def trust(summary: pd.DataFrame) -> pd.DataFrame:
    """Say of every method and budget how much it answers, how wrong it is, whether it knows."""
    groups = summary.assign(bias=summary["bias"].abs()).groupby(["label", "max_evals"], sort=False)
    table = groups[["bias", "rms", "efficiency", "error_ratio"]].median()
    table["coverage"] = groups["coverage"].mean()
    table.insert(0, "answered", groups["answers"].sum() / groups["runs"].sum())
    shares = ["answered", "bias", "rms", "coverage"]
    table[shares] = table[shares].map(percent)
    table.insert(0, "evaluations used", groups["n_evals"].mean().round())
    return table.reset_index().rename(columns={"label": "method", "max_evals": "budget"})


def error_panels(summary: pd.DataFrame) -> Figure:
    """Draw errors over evaluations: decades of pf below each other, problems side by side."""
    rows = [(False, -2), (False, -4), (False, -6), (True, -2), (True, -4)]
    figure = Figure(figsize=(7.1, 8.4), layout="constrained")
    grid = figure.subplots(len(rows), len(PROBLEMS), sharex=True, sharey=True)
    for axes, ((tau, decade), problem) in zip(grid.flat, product(rows, PROBLEMS), strict=True):
        own = summary.query("problem == @problem and decade == @decade and synchronized == @tau")
        found = own.assign(series=own["label"], x=own["n_evals"], y=own["rms"].clip(1e-5, 10.0))
        both = pd.concat([found, found.assign(series="reference", y=own["monte_carlo_rms"])])
        words = f"pf > 1e{decade}{', tau' if tau else ''}"
        plots.points(both[["series", "x", "y"]], "evaluations", words, log="xy", ax=axes)
        axes.set(title=problem, xlim=(20, 20_000), ylim=(8e-6, 10.0))
        axes.label_outer()
    for axes in grid[1:].flat:
        axes.set_title("")
    plots.one_legend(figure)
    return figure


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
