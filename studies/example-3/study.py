"""Example 3: deployment reliability of the folding wings.

How reliable is the deployment of four folding wings over the deployment-time threshold T: how do
the number of missions, its randomness and the synchronization threshold act, does FFNI with 1,125
model runs agree with simulation of the same mechanism, and what would the assumption of independent
wings cost?

The reference is a simulation of the same mechanism, with its own standard error; the grey band is
two of them, and errors smaller than that are drawn hollow. Points that the simulation does not
resolve have no reference.

The text gives m = 2, 5, 8, 10 for Fig. 15(a), N_t = 2, 4, 6, 8, 10 at p_m = 0.5 for (d), N_t = 10
for (e), and the marks T = 0.545 s and 0.57 s. Ours are T from 0.53 to 0.59 s, tau from 0.03 to
0.05 s, p_m = 0.3, 0.5, 0.7, 0.9, and n = 2, 4, 6, 8 wings for (h). Independent in (h) means that
every wing's time is drawn from the marginal distribution; both curves come from the same
conditional distributions, and the sampled differences from the mechanism alone.
"""

import sys
from pathlib import Path

import uqfold
from uqfold import Binomial, criteria, plots

sys.path.append(str(Path(__file__).parents[1]))
import paper
from paper import FFNI, steps
from runner import Run, finish, main, new_page

TOLERANCE = (0.02, 1e-5)

WING = uqfold.problems.folding_wing()
PROBLEMS = {"wing": WING}
SPA, PEARSON = ({label: method} for label, method in FFNI.items())


def tables(run: Run) -> None:
    """Answer with FFNI; then set correlated wings against independent ones."""
    every = steps(0.53, 0.59, 0.0025)
    T = run.choose(every, [0.545, 0.56, 0.575])
    run.compare("no-sync", PROBLEMS, SPA, criteria(T, None, [1, 2, 5, 8, 10]))

    T = run.choose(every, [0.545, 0.57])
    tau = run.choose([0.03, 0.035, 0.04, 0.045, 0.05], [0.03, 0.05])
    run.compare("sync", PROBLEMS, PEARSON, criteria(T, tau, [2, 5, 8, 10]))
    tau = run.choose([0.03, 0.04, 0.05], [0.03, 0.05])
    planned = [Binomial(number, 0.5) for number in (2, 4, 6, 8, 10)]
    run.compare("planned", PROBLEMS, PEARSON, criteria(T, tau, planned))
    flown = [Binomial(10, p) for p in (0.3, 0.5, 0.7, 0.9)]
    run.compare("flown", PROBLEMS, PEARSON, criteria(T, tau, flown))

    T = run.choose(every, [0.545, 0.56, 0.575])
    paper.keep_independence(run, WING, T, 16_384)


def page(run: Run) -> "uqfold.report.Page":
    """Show Tables 6 and 7, and Fig. 15."""
    page = new_page(run, __doc__)
    page.section("Tables")
    page.table(paper.inputs_table(WING), "Table 6: random inputs")
    page.table(
        paper.evaluations_table(run, "no-sync", "sync"),
        "Table 7: evaluations of the model",
        "Sizes are model runs (deployments), and so we read those of the paper: 2,000,000 without "
        "and 1,200,000 with synchronization for its Monte Carlo, 1,125 for its methods.",
    )
    names = ("no-sync", "sync", "planned", "flown")
    page.table(paper.errors_table(run, *names), "Errors by decade of the failure probability")

    page.section("Figures")
    by_m, by_tau = {"curves": "missions", "panels": "tau"}, {"curves": "tau", "panels": "missions"}
    one, error = {"curves": "missions"}, {"quantities": ["error"]}
    for letter, title, rows, options in (
        ("a", "m missions, without synchronization",
         run.rows("no-sync", missions=["2", "5", "8", "10"]), one),
        ("b", "two and five missions, with synchronization",
         run.rows("sync", missions=["2", "5"]), by_tau),
        ("c", "m, tau and T", run.rows("sync", tau=[0.03, 0.04, 0.05]), by_m),
        ("d", "number of planned flights, each flown with probability 0.5",
         run.rows("planned"), by_m),
        ("e", "probability that each of ten planned flights is flown", run.rows("flown"), by_m),
        ("f", "error without synchronization", run.rows("no-sync"), {**one, **error}),
        ("g", "error with synchronization",
         run.rows("sync", tau=[0.03, 0.04, 0.05]), {**by_m, **error}),
    ):  # fmt: skip
        figure = plots.reliability_panels(rows, **options)
        page.figure(figure, f"Fig. 15({letter}): {title}", name=f"fig-15{letter}")
    title = "Fig. 15(h): correlated against independent, n wings"
    page.figure(paper.independence_figure(run), title, name="fig-15h")
    return finish(page, run, FFNI)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
