"""What the examples of the paper share: conditions, grids, and the tables of their reports."""

import math
import re
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from runner import Run, finish, new_page, percent

import uqfold
from uqfold import criteria, plots
from uqfold.analysis import independence
from uqfold.report import Page

FLOWN = uqfold.Binomial(10, 0.7)
"""Ten planned missions, each flown with probability 0.7: Examples 4 and 5."""
FFNI = {
    "ffni-spa": uqfold.methods.FFNISaddlepoint(check=False),
    "ffni-pearson": uqfold.methods.FFNIPearson(check=False),
}
SIMULATION = uqfold.methods.ConditionalMonteCarlo(blocks=96)
CHECKED = {**FFNI, "simulation": SIMULATION}
TAU = [0.03, 0.035, 0.04, 0.045, 0.05]
"""Synchronization thresholds (s) of Examples 4 and 5."""
PAIRED = (
    "The difference is that of paired runs, with two standard errors: a ten-thousandth, "
    "far too small for the curves above and for the simulation."
)
SYMBOLS = {"V_q": "V_q", "delta": r"\delta", "b": "b", "k_d": "k_d", "C_r": "C_r"}
UNITS = {"V_q": " m/s", "delta": "°", "b": " mm", "k_d": " N", "C_r": " mm"}

CHANGES = (
    ("V_q", "mean", 100.0, 180.0),
    ("delta", "mean", 30.0, -30.0),
    ("b", "mean", 6.0, 8.0),
    ("k_d", "mean", 600.0, 500.0),
    ("C_r", "mean", 2.0, 1.0),
    ("V_q", "standard deviation", 1.0, 20.0),
    ("delta", "standard deviation", 1.0, 20.0),
    ("b", "standard deviation", 0.01, 0.5),
    ("k_d", "standard deviation", 1.0, 30.0),
    ("C_r", "standard deviation", 0.005, 0.2),
)
"""Tables 8 and 9: input, what is changed, and its two values in the input's unit."""
CONDITIONS = {
    2 * k + one: (name, moment, value)
    for k, (name, moment, *values) in enumerate(CHANGES)
    for one, value in enumerate(values, 1)
}
"""The conditions 1 to 20: input, what is changed, and its value."""


def condition(number: int) -> uqfold.Problem:
    """Return the folding wing under one of the paper's conditions."""
    name, moment, value = CONDITIONS[number]
    if moment == "mean":
        return uqfold.problems.folding_wing(means={name: value})
    return uqfold.problems.folding_wing(standard_deviations={name: value})


def steps(start: float, stop: float, step: float) -> list[float]:
    """Return equally spaced numbers, both ends among them, as decimals: 0.5375 exactly."""
    count = round((stop - start) / step) + 1
    return [round(start + i * step, 6) for i in range(count)]


def accuracy_figures(page: Page, run: Run, number: int, branch: str = "") -> None:
    """Add parts (a) to (e) of Fig. 12 or 14: curves beside simulation, and their errors."""
    tail, words = (f"-{branch}", f", {branch} linkage") if branch else ("", "")
    without, simulated = f"no-sync{tail}", f"mc-no-sync{tail}"
    several = run.rows(without, simulated, missions=["2", "3", "5", "8", "10"])
    tau = {"curves": "tau", "panels": "missions"}
    error: dict[str, Any] = {"quantities": ["error"]}
    for letter, title, rows, options in (
        ("a", "one mission, without synchronization",
         run.rows(without, simulated, missions="1"), {}),
        ("b", "several missions, without synchronization",
         several, {"curves": "missions"}),
        ("c", "two and five missions, with synchronization",
         run.rows(f"sync{tail}", f"mc-sync{tail}"), tau),
        ("d", "error without synchronization", run.rows(without), {**error, "curves": "missions"}),
        ("e", "error with synchronization", run.rows(f"sync{tail}"), {**error, **tau}),
    ):  # fmt: skip
        page.figure(
            plots.reliability_panels(rows, **options),
            f"Fig. {number}({letter}): {title}{words}",
            "The smallest error drawn stands for all that are smaller." if letter in "de" else "",
            name=f"fig-{number}{letter}{tail}",
        )


def answer_pair(
    run: Run, numbers: tuple[int, int], T: Sequence[float], few: Sequence[float], one: float
) -> None:
    """Answer two conditions as Examples 4 and 5 do: tables no-sync, sync and check of their input.

    Parameters
    ----------
    T, few
        Thresholds for FFNI, and for the simulation.
    one
        The threshold of the simulation in the reduced form.
    """
    name = CONDITIONS[numbers[0]][0]
    problems = {one: run.problems[one] for one in map("condition-{}".format, numbers)}
    spa, pearson, simulation = ({label: CHECKED[label]} for label in CHECKED)
    T, missions = run.choose((T, [2, 5, 8, 10]), ([one, few[-1]], [2, 10]))
    run.compare(f"{name}-no-sync", problems, spa, criteria(T, None, missions))
    tau = run.choose(TAU, TAU[::4])
    run.compare(f"{name}-sync", problems, pearson, criteria(T, tau, FLOWN))
    if run.quick:
        problems.popitem()
        run.compare(f"{name}-check", problems, simulation, criteria(one, None, 2), [2048])
    else:
        grid = criteria(few, [None, *TAU[::4]], [2, 10, FLOWN])
        run.compare(f"{name}-check", problems, simulation, grid)


def pairs_page(
    run: Run, text: str, table: int, number: int, pairs: Iterable[tuple[int, int]]
) -> Page:
    """Show Table 8 or 9, the evaluations, and Fig. 16 or 17: conditions against each other.

    The simulation is drawn as marks. Where there is a table of paired runs, the difference is
    theirs.
    """
    page = new_page(run, text)
    page.section("Tables")
    page.table(changed_inputs(chain(*pairs)), f"Table {table}: the conditions")
    page.table(
        evaluations_table(run, "V_q-no-sync", "V_q-sync", "V_q-check"),
        "Evaluations of each method",
    )
    page.section("Figures")
    letters = iter("abcdefghij")
    for pair in pairs:
        changed, moment, _ = CONDITIONS[pair[0]]
        short, names = moment.replace("standard deviation", "std. dev."), {}
        for one in pair:
            value = f"{CONDITIONS[one][2]:g}{UNITS[changed]}"
            names[f"condition-{one}"] = f"{one}: {short} of ${SYMBOLS[changed]}$ {value}"
        for kind, words, curves, chosen in (
            ("", "without synchronization", "missions",
             {"tau": None, "missions": ["2", "5", "8", "10"]}),
            ("-sync", "with synchronization and a random number of missions", "tau",
             {"tau": TAU, "missions": str(FLOWN)}),
        ):  # fmt: skip
            answers = f"{changed}{kind or '-no-sync'}"
            rows = run.rows(answers, f"{changed}-check", **chosen).replace({"problem": names})
            paired = run.tables.get(f"{changed}{kind}-paired")
            letter = next(letters)
            page.figure(
                plots.reliability_panels(
                    rows, ["reliability", "pf", "difference"], curves=curves, differences=paired
                ),
                f"Fig. {number}({letter}): conditions {pair[0]} and {pair[1]}, {words}",
                "" if paired is None else PAIRED,
                name=f"fig-{number}{letter}",
            )  # fmt: skip
    return finish(page, run, CHECKED)


def keep_independence(run: Run, wing: uqfold.Problem, T: Sequence[float], draws: int) -> None:
    """Keep what it costs to take 2, 4, 6 or 8 wings for independent, by FFNI and by sampling."""
    found = independence(
        wing,
        units=run.choose([2, 4, 6, 8], [2, 8]),
        criteria=criteria(T),
        method=FFNI["ffni-spa"],
        draws=run.choose(draws, 256),
        evaluator=run.evaluator(wing),
    )
    run.keep("independence", found, problem="wing", label="ffni-spa")


def independence_figure(run: Run) -> Figure:
    """Draw correlated against independent units: R, its difference, by sampling too, and pf."""
    table = run.rows("independence")
    both = [
        table.assign(problem=problem, pf=table[column])
        for problem, column in (("correlated", "pf"), ("independent", "pf_independent"))
    ]
    sampled = table[table["sampled_difference"].notna()]
    sampled = sampled.assign(
        difference=sampled["sampled_difference"], std_error=sampled["sampled_std_error"]
    )
    return plots.reliability_panels(
        pd.concat(both), ["reliability", "difference", "pf"], curves="units",
        differences=pd.concat([table.assign(std_error=math.nan), sampled]),
    )  # fmt: skip


def inputs_table(problem: uqfold.Problem) -> pd.DataFrame:
    """Return the random inputs of a problem as the paper prints them."""
    own = problem.inputs
    drawn = ["once per system" if name in own.shared_names else "per unit and mission"
             for name in own.names]  # fmt: skip
    return pd.DataFrame({
        "input": own.names, "unit": problem.input_units, "drawn": drawn,
        "distribution": own.families, "mean": own.means,
        "standard deviation": own.standard_deviations,
    })  # fmt: skip


def changed_inputs(numbers: Iterable[int]) -> pd.DataFrame:
    """Return what the conditions change, beside what they change it from."""
    usual = inputs_table(uqfold.problems.folding_wing()).set_index("input")
    rows = []
    for number in numbers:
        name, moment, value = CONDITIONS[number]
        before, unit = usual.loc[name, [moment, "unit"]]
        rows.append((number, name, moment, f"{value:g} {unit}", f"{before:g} {unit}"))
    return pd.DataFrame(rows, columns=["condition", "input", "changed", "value", "instead of"])


def evaluations_table(run: Run, *names: str) -> pd.DataFrame:
    """Return the evaluations of every method, with a row for a reference by simulation."""
    frame = run.rows(*names)
    frame = frame[frame["pf"].notna()]
    asked = np.where(frame["tau"].isna(), "without", "with") + " synchronization"
    frame = frame.assign(asked="evaluations " + asked)
    cases = frame.groupby(["problem", "label", "asked"], sort=False)["n_evals"]
    table = cases.agg(lambda n: " to ".join(f"{one:,}" for one in sorted({n.min(), n.max()})))
    known = frame[frame["reference_pf"].notna()]
    for problem, one in {*zip(known["problem"], known["asked"], strict=True)}:
        if count := re.search(r"(\d+) deployments", run.problems[problem].references.how):
            table[problem, "Monte Carlo, the reference", one] = f"{int(count[1]):,}"
    table = table.unstack().reset_index().rename(columns={"label": "method"})
    table = table.sort_values("problem", kind="stable")
    return table if table["problem"].nunique() > 1 else table.drop(columns="problem")


def errors_table(run: Run, *names: str) -> pd.DataFrame:
    """Return the signed relative errors of pf, by method and decade of the reference."""
    frame = run.rows(*names)
    frame = frame[frame["error"].notna()]
    decade = np.ceil(np.log10(frame["reference_pf"])).astype(int)
    cases = frame.assign(
        signed=(frame["pf"] - frame["reference_pf"]) / frame["reference_pf"],
        unjudged=frame["error"] <= 2.0 * frame["reference_std_error"] / frame["reference_pf"],
        tau=np.where(frame["tau"].isna(), "no", "yes"), falling=-decade,
        decade="1e" + (decade - 1).astype(str) + " to 1e" + decade.astype(str),
    ).groupby(["problem", "label", "tau", "falling", "decade"])  # fmt: skip
    found = cases["signed"].agg(["size", "median", "min", "max"])
    found[["median", "min", "max"]] = found[["median", "min", "max"]].map(
        lambda error: percent(error, "+")
    )
    found["below the reference's own error"] = cases["unjudged"].sum()
    found = found.reset_index().drop(columns="falling")
    if found["problem"].nunique() == 1:
        found = found.drop(columns="problem")
    return found.rename(columns={
        "label": "method", "decade": "reference pf", "size": "criteria", "median": "median error",
        "min": "from", "max": "to",
    })  # fmt: skip
