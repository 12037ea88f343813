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
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import uqfold
from uqfold import criteria, plots
from uqfold.analysis import chaos_sobol, pick_freeze, score_derivatives, surface_derivatives

sys.path.append(str(Path(__file__).parents[1]))
from paper import inputs_table
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-9)

WING = uqfold.problems.folding_wing()
PROBLEMS = {"wing": WING}
KRIGING = uqfold.methods.Kriging()
CHAOS = uqfold.methods.PolynomialChaos(runs=200)
BOTH = ("on-surface", "simulated")


def tables(run: Run) -> None:
    """Find indices and derivatives, each in two ways."""
    how = {"rng": 0, "evaluator": run.evaluator(WING)}
    keep(run, "sobol-chaos", "pce", chaos_sobol(WING, CHAOS, **how))
    samples = run.choose(1024, 64)
    keep(run, "sobol-pick-freeze", "pick-freeze", pick_freeze(WING, samples, 8, **how))

    T, tau, missions = [0.55, 0.56, 0.57, 0.58], run.choose([None, 0.04], None), [1, 5]
    found = surface_derivatives(
        WING, criteria(T, tau, missions), KRIGING, inputs=run.choose(None, ["k_d"]), **how
    )
    keep(run, "on-surface", "kriging", found)
    T = run.choose([0.55, 0.56, 0.57], 0.55)
    systems = run.choose(150_000, 2_000)
    found = score_derivatives(WING, criteria(T, tau, run.choose(missions, 1)), systems, **how)
    keep(run, "simulated", "mc", found)


def keep(run: Run, name: str, label: str, found: Any) -> None:
    """Keep what an analysis found, with what it cost."""
    frame = found.to_frame()
    frame["shared"] = frame["shared"].map({True: "yes", False: "no"})
    if hasattr(found, "mean"):
        frame = frame.assign(response_mean=found.mean, response_std=found.std)
    frame = frame.assign(n_evals=found.n_evals, seed=0)
    run.keep(name, frame, problem="wing", label=label)


def agreement(frame: pd.DataFrame, value: str, error: str) -> pd.DataFrame:
    """Set two ways to the same number beside each other: do they agree?"""
    keys = [name for name in ("input", "moment", "order", "threshold", "tau") if name in frame]
    (label, first), (other, second) = (
        (label, rows[[*keys, value, error]]) for label, rows in frame.groupby("label", sort=False)
    )
    both = first.merge(second, "left", keys, suffixes=("", "_2"))
    table = both[keys].copy()
    for name, end in ((label, ""), (other, "_2")):
        table[name] = both[value + end].combine(both[error + end], with_error)
    joint = both[error].combine(both[f"{error}_2"], math.hypot).where(lambda one: one > 0.0)
    table["apart, in std. errors"] = (both[value] - both[f"{value}_2"]).abs() / joint
    return table


def with_error(value: float, error: float) -> str:
    """Write a value with its error, to the error's second digit."""
    if math.isnan(value):
        return "-"
    if math.isnan(error) or error == 0.0:
        return f"{value + 0.0:.3g}"
    digits = min(max(1 - math.floor(math.log10(error)), 0), 8)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def page(run: Run) -> "uqfold.report.Page":
    """Show indices and derivatives, way beside way."""
    page = new_page(run, __doc__)
    indices = run.rows("sobol-chaos", "sobol-pick-freeze")
    one = run.rows(*BOTH, missions="1", threshold=0.57)
    page.section("Tables")
    page.table(inputs_table(WING), "Random inputs")
    page.table(
        agreement(indices, "index", "std_error"),
        "Sobol' indices of the deployment time",
        "`main`: share of the variance by the input alone; `total`: with its interactions. The "
        "index of all shared inputs together is the correlation of the deployment times of two "
        "wings of one vehicle.",
    )
    page.table(
        agreement(
            run.rows(*BOTH, missions="1", threshold=[0.56, 0.57]), "per_std", "per_std_error"
        ),
        "Relative change of pf per standard deviation of the input, one mission",
    )
    page.table(
        agreement(one, "elasticity", "elasticity_error"),
        "Elasticities: relative change of pf per relative change of the parameter, one mission",
        "The mean of delta is zero: a relative change of it means nothing, and its elasticity is "
        "zero.",
    )
    page.section("Figures")
    page.figure(
        plots.sobol(indices),
        "Where the variance of the deployment time comes from",
        "Bars are intervals of 95 %; indices below 1e-6 are not drawn.",
        name="sobol",
    )
    for missions, words in (("1", "one mission"), ("5", "five missions")):
        page.figure(
            by_tau(run.rows(*BOTH, missions=missions, threshold=0.57), [plots.derivatives]),
            f"What pf answers to: T = 0.57 s, {words}",
            "`kriging`: on its surface; `mc`: score function on simulated systems. Bars are "
            "intervals of 95 %.",
            name=f"derivatives-{words.replace(' ', '-')}",
        )
    moments = [partial(over_threshold, moment=one) for one in ("mean", "standard deviation")]
    page.figure(
        by_tau(run.rows("on-surface", missions="1"), moments),
        "From the body into the tail, one mission, on the surface",
        name="derivatives-over-threshold",
    )
    return finish(page, run, {"kriging": KRIGING, "pce": CHAOS})


def by_tau(rows: pd.DataFrame, draws: Sequence[Callable[..., Any]]) -> Figure:
    """Draw figures one below another, without synchronization and with it, with one legend."""
    figure = Figure(figsize=(5.7, 4.3), layout="constrained")
    grid = figure.subplots(len(draws), 2, squeeze=False, sharex="col", sharey="row")
    for row, draw in zip(grid, draws, strict=True):
        for axes, own in zip(row, (rows["tau"].isna(), rows["tau"].notna()), strict=True):
            draw(rows[own], ax=axes)
            axes.label_outer()
    for axes, title in zip(grid[0], ("no tau", "tau = 0.04 s"), strict=True):
        axes.set_title(title)
    plots.one_legend(figure)
    return figure


def over_threshold(rows: pd.DataFrame, moment: str, ax: Axes) -> None:
    """Draw relative changes of pf per standard deviation over T, with intervals of 95 %."""
    own = rows[rows["moment"] == moment]
    value, half = own["per_std"], 1.96 * own["per_std_error"]
    frame = own.assign(
        series=own["input"], x=own["threshold"], y=value, low=value - half, high=value + half
    )
    label = f"relative change of pf\nby the {moment}"
    plots.points(frame, "threshold T (s)", label, limits={"-": 0.0}, ax=ax)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
