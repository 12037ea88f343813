"""What matters: which inputs the wing's reliability hangs on.

Which inputs does the deployment time of a wing come from, and which of their means and standard
deviations does the failure probability of the whole system answer to, over one and five missions,
without and with synchronization, in the body and in the tail?

Each answer is found twice, by ways that share nothing but the model. Sobol' indices: from a
polynomial chaos expansion of 200 runs, and by pick-freeze sampling of the model itself.
Derivatives: on the Kriging surface of 100 runs, whose inputs are moved without further runs, and by
the score function on simulated systems of the real model, which needs no surface. The relative
change of pf per standard deviation is sigma / pf times the derivative: 1 means that moving the
parameter by a hundredth of the input's standard deviation changes pf by one per cent.
"""

import math
import sys
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

import uqfold
from uqfold import analysis, criteria, plots

sys.path.append(str(Path(__file__).parents[1]))
from paper import inputs_table
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-9)

WING = uqfold.problems.folding_wing()
PROBLEMS = {"wing": WING}
KRIGING = uqfold.methods.Kriging()
CHAOS = uqfold.methods.PolynomialChaos(runs=200)


def tables(run: Run) -> None:
    """Find indices and derivatives, each in two ways."""
    how = {"rng": 0, "evaluator": run.evaluator(WING)}
    T, tau, missions = [0.55, 0.56, 0.57, 0.58], run.choose([None, 0.04], None), [1, 5]
    asked, inputs = criteria(T, tau, missions), run.choose(None, ["k_d"])
    keep(run, "sobol-chaos", "pce", analysis.chaos_sobol(WING, CHAOS, **how))
    found = analysis.pick_freeze(WING, run.choose(1024, 64), 8, **how)
    keep(run, "sobol-pick-freeze", "pick-freeze", found)
    found = analysis.surface_derivatives(WING, asked, KRIGING, inputs=inputs, **how)
    keep(run, "on-surface", "kriging", found)
    asked = criteria(*run.choose((T[:3], tau, missions), (0.55, tau, 1)))
    found = analysis.score_derivatives(WING, asked, run.choose(150_000, 2_000), **how)
    keep(run, "simulated", "mc", found)


def keep(run: Run, name: str, label: str, found: Any) -> None:
    """Keep what an analysis found, with what it cost."""
    frame = found.to_frame()
    frame["shared"] = frame["shared"].map({True: "yes", False: "no"})
    if hasattr(found, "mean"):
        frame = frame.assign(response_mean=found.mean, response_std=found.std)
    run.keep(name, frame.assign(n_evals=found.n_evals, seed=0), problem="wing", label=label)


def page(run: Run) -> "uqfold.report.Page":
    """Show indices and derivatives, way beside way."""
    page = new_page(run, __doc__)
    indices = run.rows("sobol-chaos", "sobol-pick-freeze")
    found = run.rows("on-surface", "simulated")
    at, once = found["threshold"] == 0.57, found["missions"] == "1"
    page.section("Tables")
    page.table(inputs_table(WING), "Random inputs")
    page.table(
        agreement(indices, "index", "std_error"),
        "Sobol' indices of the deployment time",
        "`main`: by the input alone; `total`: with its interactions. The index of all shared "
        "inputs is the correlation of the deployment times of two wings of one vehicle.",
    )
    near = found[once & found["threshold"].isin([0.56, 0.57])]
    page.table(
        agreement(near, "per_std", "per_std_error"),
        "Relative change of pf per standard deviation of the input, one mission",
    )
    page.table(
        agreement(found[once & at], "elasticity", "elasticity_error"),
        "Elasticities: relative change of pf per relative change of the parameter, one mission",
    )
    page.section("Figures")
    page.figure(
        plots.sobol(indices),
        "Where the variance of the deployment time comes from",
        "Bars are intervals of 95 %; indices below 1e-6 are not drawn.",
        name="sobol",
    )
    for own, words in ((once, "one mission"), (~once, "five missions")):
        page.figure(
            by_tau(found[at & own]),
            f"What pf answers to: T = 0.57 s, {words}",
            "`kriging`: on its surface; `mc`: on simulated systems. Bars are intervals of 95 %.",
            name=f"derivatives-{words.replace(' ', '-')}",
        )
    return finish(page, run, {"kriging": KRIGING, "pce": CHAOS})


def agreement(frame: pd.DataFrame, value: str, error: str) -> pd.DataFrame:
    """Set two ways to the same number beside each other: do they agree?"""
    keys = [name for name in ("input", "moment", "order", "threshold", "tau") if name in frame]
    label, other = frame["label"].unique()
    first, second = (rows[[*keys, value, error]] for _, rows in frame.groupby("label", sort=False))
    both = first.merge(second, "left", keys, suffixes=("", "_2"))
    table = both[keys].copy()
    table[label] = both[value].combine(both[error], with_error)
    table[other] = both[f"{value}_2"].combine(both[f"{error}_2"], with_error)
    joint = both[error].combine(both[f"{error}_2"], math.hypot).where(lambda one: one > 0.0)
    table["apart, in std. errors"] = (both[value] - both[f"{value}_2"]).abs() / joint
    return table


def with_error(value: float, error: float) -> str:
    """Write a value with its error, to the error's second digit."""
    if math.isnan(value):
        return "-"
    if not error > 0.0:
        return f"{value + 0.0:.3g}"
    digits = min(max(1 - math.floor(math.log10(error)), 0), 8)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def by_tau(rows: pd.DataFrame) -> Figure:
    """Draw derivatives without synchronization and with it, side by side, with one legend."""
    figure = Figure(figsize=(5.7, 3.0), layout="constrained")
    parts = (("no tau", rows["tau"].isna()), ("tau = 0.04 s", rows["tau"].notna()))
    for axes, (title, own) in zip(figure.subplots(1, 2, sharey=True), parts, strict=True):
        plots.derivatives(rows[own], ax=axes)
        axes.set_title(title)
        axes.label_outer()
    plots.one_legend(figure)
    return figure


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
