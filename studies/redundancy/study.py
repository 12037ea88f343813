"""Redundancy: what is another unit worth when causes are shared?

What is a second, third and fourth unit worth when all of them are under the same load, and what
would one believe who takes their failures for independent?

Two systems are asked. Units under one exponential stress, with exponential strengths of 20 mean
stresses, in parallel: the published formula is the reference, and a further unit divides pf by 1 +
20 / n only, not by 21. And the four folding wings, of which one, two, three or all must deploy in
time; they share flight speed and pitch angle.

"Independent" gives every unit the same chance to fail as it has, and lets nothing be shared by
units and missions. `shared_correlation` is the correlation between the failures of two systems
under the same shared inputs: 0 where these do not matter, 1 where nothing else does.

Last, five units under one stress in a bridge: 0 and 3 in a row, 1 and 4 in a row, and unit 2, half
as likely to fail, between the rows. Which of them is worth most?
"""

import sys
from pathlib import Path

import pandas as pd

import uqfold
from uqfold import CutSets, KOutOfN, Problem, Unit, criteria, plots
from uqfold.analysis import importance_of_units, joint_failures
from uqfold.methods import Kriging, MonteCarlo, PolynomialChaos

sys.path.append(str(Path(__file__).parents[1]))
from runner import Run, finish, main, new_page

TOLERANCE = (1e-3, 1e-12)

CHAOS = PolynomialChaos(runs=40)
METHODS = {"pce": CHAOS, "mc": MonteCarlo(systems=1_000_000)}
WING = Kriging()
BRIDGE = CutSets([[0, 1], [3, 4], [0, 2, 4], [1, 2, 3]])
PROBLEMS = {f"1 of {n}": uqfold.problems.stress_strength(n) for n in (1, 2, 3, 4)}


def of_wings(works: int) -> Problem:
    """Return the folding wings, of which so many must work."""
    wing = uqfold.problems.folding_wing()
    return Problem(
        wing.model, inputs=wing.inputs, units=wing.n_units, structure=KOutOfN(works),
        name=wing.name, version=wing.version, response=wing.response,
        response_unit=wing.response_unit, input_units=wing.input_units,
    )  # fmt: skip


def bridge() -> Problem:
    """Return five units under one stress, the middle one half as likely to fail."""
    one = uqfold.problems.stress_strength(5)
    units = [Unit(name=name, offset=-0.7 * (name == "link")) for name in
             ("left 1", "left 2", "link", "right 1", "right 2")]  # fmt: skip
    return Problem(one.model, inputs=one.inputs, units=units, structure=BRIDGE, name="bridge",
                   version=one.version)  # fmt: skip


def tables(run: Run) -> None:
    """Answer both systems; put independence beside them; ask which unit of the bridge matters."""
    stress = run.choose(PROBLEMS, {"1 of 2": PROBLEMS["1 of 2"]})
    wings = {f"{k} of 4": of_wings(k) for k in run.choose((4, 3, 2, 1), ())}
    budget = [run.choose(4_000_000, 40_000)]
    run.compare("pce", stress, {"pce": CHAOS}, criteria(0.0))
    run.compare("mc", stress, {"mc": METHODS["mc"]}, criteria(0.0), budget)
    found = [worth(run, "stress", name, one, CHAOS, criteria(0.0)) for name, one in stress.items()]
    T = criteria([0.55, 0.57], None, 1)
    found += [worth(run, "wings", name, one, WING, T) for name, one in wings.items()]
    run.keep("worth", pd.concat(found, ignore_index=True))
    asked = {"criteria": criteria(0.0), "method": CHAOS, "rng": 0}
    weighed = importance_of_units(bridge(), **asked)
    run.keep("bridge", weighed, problem="bridge, " + weighed["unit"], label="pce")
    pairs = joint_failures(bridge(), **asked)
    named = "bridge, " + pairs["unit"] + " and " + pairs["other"]
    run.keep("pairs", pairs, problem=named, label="pce")


def worth(
    run: Run, system: str, name: str, problem: Problem, method: object, asked: uqfold.Criteria
) -> pd.DataFrame:
    """Return pf of a system and its pf as if nothing were shared, one row per criterion."""
    frame = importance_of_units(problem, asked, method, rng=0, evaluator=run.evaluator(problem))
    frame = frame.drop_duplicates("threshold")
    columns = ["threshold", "pf", "pf_independent", "shared_correlation", "status", "message"]
    return frame[columns].assign(problem=f"{system}, {name}", label=method.name)


def page(run: Run) -> "uqfold.report.Page":
    """Show what a unit is worth, with shared causes and without."""
    page = new_page(run, __doc__)
    found = run.tables["worth"]
    system = found["problem"].str.partition(", ")
    found = found.assign(system=system[0], units=system[2])
    found["independence is off by"] = (found["pf"] / found["pf_independent"]).map("{:.3g} x".format)
    shown = ["threshold", "units", "pf", "pf_independent", "independence is off by"]
    page.section("Another unit")
    for name, title in (("stress", "Units under one stress"), ("wings", "Wings that must work")):
        page.table(
            found[found["system"] == name][[*shown, "shared_correlation"]],
            f"{title}: failure probability of the system",
        )
    page.figure(
        over_units(run, found),
        "Failure probability with 1 to 4 units in parallel",
        "Independence promises a factor of 21 for each further unit.",
        name="units",
    )
    page.section("Which unit of the bridge")
    page.figure(
        plots.importance(run.tables["bridge"]).figure,
        "Importance of the five units",
        name="importance",
    )
    weighed = run.tables["bridge"].loc[:, "unit":"risk_reduction_worth"].drop(columns="pf")
    page.table(weighed, "Importance with the common cause")
    columns = ["unit", "other", "pf_both", "pf_both_independent", "correlation"]
    page.table(run.tables["pairs"][columns], "Units that fail together")
    return finish(page, run, {**METHODS, "kriging, of the wings": WING})


def over_units(run: Run, found: pd.DataFrame) -> object:
    """Draw pf against the number of parallel units: exact, by the methods, and independent."""
    answers = run.rows(*METHODS)
    answers = answers.rename(columns={"label": "series", "problem": "units", "pf": "y"})
    answers = answers.assign(low=answers["ci_low"], high=answers["ci_high"])
    exact = answers.drop_duplicates("units").assign(series="reference", y=answers["reference_pf"])
    exact = exact.assign(low=exact["y"], high=exact["y"])
    apart = found[found["system"] == "stress"].assign(series="as if independent")
    apart = apart.assign(y=apart["pf_independent"], low=float("nan"), high=float("nan"))
    frame = pd.concat([exact, answers, apart])
    frame = frame.assign(x=frame["units"].str.removeprefix("1 of ").astype(float))
    frame = frame[["series", "x", "y", "low", "high"]].query("y > 0")
    axes = plots.points(frame, "units in parallel", "failure probability", log="y")
    axes.set_xticks(sorted(frame["x"].unique()))
    return axes.figure


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
