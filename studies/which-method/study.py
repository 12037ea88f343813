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
from pathlib import Path

import pandas as pd

import uqfold
from uqfold import criteria, methods, plots
from uqfold.comparison.benchmark import benchmark_summary

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
    "openturns-form": methods.OpenTURNSFORM(),
    "ffni-spa": methods.FFNISaddlepoint(),
    "ffni-pearson": methods.FFNIPearson(),
    "ffni-spa-fine": methods.FFNISaddlepoint(**FINE),
    "ffni-pearson-fine": methods.FFNIPearson(**FINE),
}
SURROGATES = {
    "kriging": methods.Kriging(runs=1125),
    "pce": methods.PolynomialChaos(runs=1125),
}
ACTIVE = {"active-kriging": methods.ActiveKriging()}
METHODS = {**SIMPLE, **SURROGATES, **ACTIVE}
FEW = {label: SIMPLE[label] for label in ("mc", "ffni-spa", "ffni-pearson")}
PCE = {"pce": SURROGATES["pce"]}


def tables(run: Run) -> None:
    """Ask every method on every problem, with every budget and seed; time them on one."""
    run.problems(PROBLEMS)
    groups = {
        "simple": run.choose((SIMPLE, [100, 375, 1125, 10_000], 20), (FEW, [375], 2)),
        "surrogates": run.choose((SURROGATES, [100, 375], 10), (PCE, [100], 1)),
        "surrogates-1125": run.choose((SURROGATES, [1125], 3), (PCE, [100], 1)),
        "active": (ACTIVE, [100], run.choose(20, 1)),
    }
    for group, (labelled, budgets, seeds) in groups.items():
        for name, (T, tau) in GRIDS.items():
            grid = criteria(T, [None, *tau])
            if run.quick and group != "active":
                # rules over a surface are laid out for all thresholds that are asked
                grid = criteria([T[0], T[2]] if group == "simple" else T)
            one = {name: PROBLEMS[name]}
            run.compare(f"{group}-{name}", one, labelled, grid, budgets, seeds)
    run.keep("timing", timing(run))


def timing(run: Run) -> pd.DataFrame:
    """Return the wall time of every method on Example 1, whose model costs nothing."""
    grid = criteria(GRIDS["series"][0], [None, 16])
    rows = []
    for label in run.choose([one for one in METHODS if "fine" not in one], ["mc", "ffni-spa"]):
        for budget in (100, 375):
            result = METHODS[label].estimate(PROBLEMS["series"], grid, max_evals=budget, rng=0)
            known = any(not math.isnan(row.pf) for row in result)
            seconds = result.seconds if known else math.nan
            rows.append(("series", label, float(budget), result.n_evals, seconds))
    return pd.DataFrame(rows, columns=["problem", "label", "max_evals", "n_evals", "seconds"])


def page(run: Run) -> "uqfold.report.Page":
    """Show who is best where, who can be trusted, and the errors over budgets."""
    page = new_page(run, __doc__)
    names = [
        name for name in run.tables if name.rpartition("-")[0] and name[:2] in ("si", "su", "ac")
    ]
    frame = run.rows(*names)
    units = dict(
        zip(run.tables["problems"]["problem"], run.tables["problems"]["units"], strict=True)
    )
    registered = dict(zip(frame["label"], frame["method"], strict=True))
    summary = benchmark_summary(frame, units)
    summary["method"] = summary["label"].map(registered)
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
    seconds = run.rows("timing").pivot(index="label", columns="max_evals", values="seconds")
    seconds.columns = [f"{budget:g} evaluations" for budget in seconds.columns]
    page.table(
        seconds.map(lambda value: "" if math.isnan(value) else f"{value:.2g} s").reset_index(),
        "Wall time on Example 1, whose model costs nothing",
        "One estimate of twelve criteria, on a machine that was busy with other work: an order of "
        "magnitude.",
    )
    page.section("Figures")
    for synchronized, decades in ((False, [-2, -4, -6]), (True, [-2, -3, -4])):
        words = "with synchronization" if synchronized else "without synchronization"
        page.figure(
            plots.benchmark_panels(summary[summary["synchronized"] == synchronized], decades),
            f"Error against evaluations, {words}",
            name=f"errors-{words.replace(' ', '-')}",
        )
    return finish(page, run, METHODS)


def ranking(summary: pd.DataFrame) -> pd.DataFrame:
    """Rank methods by the median over problems of their root mean square error."""
    complete = summary[summary["answers"] == summary["runs"]]
    rows = []
    groups = ["synchronized", "decade", "max_evals"]
    for (synchronized, decade, budget), own in summary.groupby(groups):
        mine = complete.loc[complete.index.intersection(own.index)]
        problems = own["problem"].nunique()
        errors = mine.groupby("label")["rms"].agg(["median", "size"])
        errors["worst"] = mine[mine["judged"]].groupby("label")["rms"].max()
        errors = errors[errors["size"] == problems].sort_values("median", kind="stable")
        best = [
            f"{label} {percent(one['median'])}"
            + (f" (worst {percent(one['worst'])})" if one["worst"] > one["median"] else "")
            for label, one in errors.head(3).iterrows()
        ]
        places = dict(zip(("1.", "2.", "3."), [*best, "", "", ""], strict=False))
        rows.append({
            "tau": "yes" if synchronized else "no", "decade": -decade,
            "reference pf": f"1e{decade} to 1e{decade + 1}", "budget": int(budget),
            "problems": problems, **places,
        })  # fmt: skip
    return pd.DataFrame(rows).sort_values(["tau", "decade", "budget"]).drop(columns="decade")


def trust(summary: pd.DataFrame) -> pd.DataFrame:
    """Say of every method and budget how much it answers, how wrong it is, whether it knows."""
    rows = []
    for (label, budget), own in summary.groupby(["label", "max_evals"], sort=False):
        answered = own[own["answers"] > 0]
        rows.append({
            "method": label,
            "budget": int(budget),
            "evaluations used": answered["n_evals"].mean().round() if len(answered) else math.nan,
            "answered": f"{100.0 * own['answers'].sum() / own['runs'].sum():.0f} %",
            "median |bias|": percent(answered["bias"].abs().median()),
            "median rms": percent(answered["rms"].median()),
            "median efficiency": f"{answered['efficiency'].median():,.3g}",
            "intervals that hold the reference": share(answered["coverage"].mean()),
            "error found / error stated": f"{answered['error_ratio'].median():.2g}",
        })  # fmt: skip
    return pd.DataFrame(rows).replace("nan", "")


def percent(value: float) -> str:
    """Write a relative error in per cent."""
    if math.isnan(value):
        return ""
    if value >= 0.995:
        return f"{100.0 * value:,.0f} %"
    return f"{100.0 * value:.2g} %" if value >= 1e-4 else "<0.01 %"


def share(value: float) -> str:
    """Write a share in whole per cent."""
    return "" if math.isnan(value) else f"{100.0 * value:.0f} %"


if __name__ == "__main__":
    main(__file__, tables, page, TOLERANCE)
