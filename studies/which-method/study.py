"""Which method at which budget.

The same 18 criteria are asked of every method with 100, 375, 1,125 and 10,000 model runs for all of
them together. Which method tells most, for failure probabilities from 1e-1 down to 1e-6, without
and with synchronization, and does it know how wrong it is?

Examples 1 and 2 (both branches) have exact references, that of Example 3 (the wing) is known to
0.3 % at 1e-1 and 3 % at 1e-6. Simulation and active Kriging run with 20 seeds, surrogates with 10
(3 at 1,125 runs), a method without randomness once. A method that needs fewer runs than a budget
allows is shown with what it used; one that needs more has no answer there. FFNI has the nodes of
the paper, 3 per shared and 5 per individual input (75, 375 and 1,125 runs), or 5 and 7 of them
(`fine`: 245, 1,715 and 8,575). Surrogates use all of a budget up to 1,125 runs, active Kriging what
it thinks it needs of 100. The efficiency is the variance of crude Monte Carlo with the same budget
over the mean squared error found: 100 says that Monte Carlo would need 100 times the runs.

The surfaces are fitted anew in every run of this study, which takes about 12 minutes of one
processor; `--redraw` draws from the tables in seconds.
"""

import math
import sys
from itertools import product
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

import uqfold
from uqfold import criteria, methods, plots
from uqfold.comparison import benchmark_summary

sys.path.append(str(Path(__file__).parents[1]))
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-12)

PROBLEMS = {
    "series": uqfold.problems.series(),
    "four-bar": uqfold.problems.four_bar(),
    "four-bar-crossed": uqfold.problems.four_bar(branch="crossed"),
    "folding-wing": uqfold.problems.folding_wing(),
}
GRIDS = {
    "series": ([0, 3, 4.5, 5.5, 6.5, 7.5], [16, 20]),
    "four-bar": ([101, 102, 103, 103.75, 104.25, 105], [5, 6]),
    "four-bar-crossed": ([-140, -139, -138, -137.5, -137, -136], [5, 6]),
    "folding-wing": ([0.555, 0.5625, 0.5725, 0.5775, 0.58, 0.5875], [0.04, 0.06]),
}
"""Problem -> thresholds and synchronization thresholds, in the unit of its response."""
FINE = {"nodes_shared": 5, "nodes_individual": 7}
SIMPLE = {
    "mc": methods.MonteCarlo(),
    "conditional-mc": methods.ConditionalMonteCarlo(),
    "openturns-mc": methods.OpenTURNSMonteCarlo(),
    "openturns-form": methods.OpenTURNSFORM(starts=1),
    "ffni-spa": methods.FFNISaddlepoint(check=False),
    "ffni-pearson": methods.FFNIPearson(check=False),
    "ffni-spa-fine": methods.FFNISaddlepoint(**FINE, check=False),
    "ffni-pearson-fine": methods.FFNIPearson(**FINE, check=False),
}
SURROGATES = {
    "kriging": methods.Kriging(runs=1125),
    "pce": methods.PolynomialChaos(runs=1125),
}
ACTIVE = {"active-kriging": methods.ActiveKriging()}
METHODS = {**SIMPLE, **SURROGATES, **ACTIVE}
QUICK = {
    "mc": (375, [*GRIDS]),
    "ffni-spa": (375, [*GRIDS]),
    "ffni-pearson": (375, [*GRIDS]),
    "pce": (100, ["four-bar", "folding-wing"]),
    "active-kriging": (100, ["series", "four-bar-crossed"]),
}
"""What the reduced form asks with one seed: label -> budget and problems."""
ROWS = [
    "problem", "label", "max_evals", "threshold", "tau", "missions", "pf", "std_error", "status",
    "n_evals", "seed", "reference_pf",
]  # fmt: skip


def tables(run: Run) -> None:
    """Ask every method on every problem, with every budget and seed."""
    groups = [
        (SIMPLE, [100, 375, 1125, 10_000], 20, [*GRIDS]),
        (SURROGATES, [100, 375], 10, [*GRIDS]),
        (SURROGATES, [1125], 3, [*GRIDS]),
        (ACTIVE, [100], 20, [*GRIDS]),
    ]
    if run.quick:
        groups = [({one: METHODS[one]}, [most], 1, names) for one, (most, names) in QUICK.items()]
    answers = pd.concat([
        run.answers(
            {name: PROBLEMS[name]}, labelled, criteria(GRIDS[name][0], [None, *GRIDS[name][1]]),
            budgets, seeds,
        )
        for labelled, budgets, seeds, names in groups
        for name in names
    ], ignore_index=True)  # fmt: skip
    budgets = {label: budget for label, (budget, _) in QUICK.items()}
    first = (answers["seed"] == 0) & (answers["max_evals"] == answers["label"].map(budgets))
    run.keep("first-seed", answers.loc[first, ROWS])
    units = {name: problem.n_units for name, problem in PROBLEMS.items()}
    run.keep("summary", benchmark_summary(answers, units))
    statuses = answers.groupby(["label", "max_evals", "status"], sort=False).size()
    run.keep("statuses", statuses.unstack(fill_value=0).reset_index())


def page(run: Run) -> "uqfold.report.Page":
    """Show who is best where, who can be trusted, and the errors over budgets."""
    page, summary = new_page(run, __doc__), run.rows("summary")
    page.section("Tables")
    page.table(
        ranking(summary),
        "The three best methods for every decade and budget",
        "Ranked by the median over the problems of the root mean square error over criteria and "
        "seeds; the worst problem stands in brackets. A method is ranked where it answers "
        "everything asked.",
    )
    page.table(
        trust(summary),
        "How much each method answers, how wrong it is, and whether it knows",
        "Medians over problems, decades and synchronization. The efficiency is how many times the "
        "runs crude Monte Carlo would need for the same error. The last column is right at 1; "
        "above, the method is too sure of itself.",
    )
    page.table(run.rows("statuses"), "What the methods say of their own answers")
    page.section("Figures")
    for synchronized, decades in ((False, [-2, -4, -6]), (True, [-2, -3, -4])):
        words = "with synchronization" if synchronized else "without synchronization"
        page.figure(
            error_panels(summary[summary["synchronized"] == synchronized], decades),
            f"Error against evaluations, {words}",
            "Root mean square errors of pf, Eq. (49), by decade of the reference. The dashed line "
            "is what crude Monte Carlo would have.",
            name=f"errors-{words.replace(' ', '-')}",
        )
    return finish(page, run, METHODS)


def error_panels(summary: pd.DataFrame, decades: list[int]) -> Figure:
    """Draw errors over evaluations: decades of pf below each other, problems side by side."""
    figure = Figure(figsize=(7.1, 5.6), layout="constrained")
    grid = figure.subplots(len(decades), len(GRIDS), sharex=True, sharey=True)
    for axes, (decade, problem) in zip(grid.flat, product(decades, GRIDS), strict=True):
        own = summary[(summary["decade"] == decade) & (summary["problem"] == problem)]
        found = own.assign(series=own["label"], x=own["n_evals"], y=own["rms"].clip(1e-5, 10.0))
        simple = found.assign(series="reference", y=own["monte_carlo_rms"])
        rows = pd.concat([found, simple])[["series", "x", "y"]]
        plots.points(rows, "evaluations", f"pf 1e{decade} to 1e{decade + 1}", log="xy", ax=axes)
        axes.set(title=problem, xlim=(20, 20_000), ylim=(8e-6, 10.0))
        axes.label_outer()
    for axes in grid[1:].flat:
        axes.set_title("")
    plots.one_legend(figure)
    return figure


def ranking(summary: pd.DataFrame) -> pd.DataFrame:
    """Rank methods by the median over problems of their root mean square error."""
    case = ["synchronized", "decade", "max_evals"]
    problems = summary.groupby(case)["problem"].nunique().rename("problems")
    complete = summary[summary["answers"] == summary["runs"]]
    complete = complete.assign(judged=complete["rms"].where(complete["judged"]))
    found = complete.groupby([*case, "label"]).agg(
        median=("rms", "median"), worst=("judged", "max"), answered=("rms", "size")
    )
    found = found.reset_index("label").join(problems)
    found = found[found["answered"] == found["problems"]].sort_values("median", kind="stable")
    worst = (" (worst " + found["worst"].map(percent) + ")").where(found["worst"] > found["median"])
    found["text"] = found["label"] + " " + found["median"].map(percent) + worst.fillna("")
    found["place"] = found.groupby(case).cumcount() + 1
    best = found[found["place"] <= 3].set_index(["problems", "place"], append=True)["text"]
    best = best.unstack(fill_value="").add_suffix(".")
    best = best.sort_index(level=case, ascending=[True, False, True]).reset_index()
    best["synchronized"] = best["synchronized"].map({True: "yes", False: "no"})
    best["decade"] = best["decade"].map("1e{0}".format) + " to 1e" + (best["decade"] + 1).map(str)
    names = {"synchronized": "tau", "decade": "reference pf", "max_evals": "budget"}
    return best.rename(columns=names)


def trust(summary: pd.DataFrame) -> pd.DataFrame:
    """Say of every method and budget how much it answers, how wrong it is, whether it knows."""
    groups = summary.assign(bias=summary["bias"].abs()).groupby(["label", "max_evals"], sort=False)
    table = pd.DataFrame({
        "evaluations used": groups["n_evals"].mean().round(),
        "answered": (groups["answers"].sum() / groups["runs"].sum()).map(percent),
        "median |bias|": groups["bias"].median().map(percent),
        "median rms": groups["rms"].median().map(percent),
        "median efficiency": groups["efficiency"].median(),
        "intervals that hold the reference": groups["coverage"].mean().map(percent),
        "error found / error stated": groups["error_ratio"].median(),
    })  # fmt: skip
    return table.reset_index().rename(columns={"label": "method", "max_evals": "budget"})


def percent(value: float) -> str:
    """Write a share or a relative error in per cent."""
    if math.isnan(value):
        return ""
    return f"{100.0 * value:,.0f} %" if value >= 0.995 else f"{100.0 * value:.2g} %"


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
