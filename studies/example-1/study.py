"""Example 1: a mathematical series system.

Does full-factorial numerical integration (FFNI) with 75 model runs give the reliability of a series
system of four units with one shared input, without and with synchronization, and how far into the
tail does it hold?

The reference is exact: integration without sampling. `mc` is Monte Carlo with the 2,000,000 runs of
Table 3; what it can see ends near ten failures among its systems.

The text gives no values of T and tau. Our T spans failure probabilities from 0.96 to 3e-7 for one
mission, our tau from 12 to 20 the climb to the plateau, and m = 2, 3, 5, 8, 10 stands for "m > 1".
The text speaks of a dispersion that falls with m; what falls is the reliability.
"""

import sys
from pathlib import Path

import uqfold
from uqfold import criteria

sys.path.append(str(Path(__file__).parents[1]))
from paper import FFNI, accuracy_figures, errors_table, evaluations_table, inputs_table, steps
from runner import Run, finish, main, new_page

TOLERANCE = (1e-6, 1e-12)

PROBLEMS = {"series": uqfold.problems.series()}
METHODS = {**FFNI, "mc": uqfold.methods.MonteCarlo()}
NAMES = ("no-sync", "sync", "mc-no-sync", "mc-sync")


def tables(run: Run) -> None:
    """Answer with FFNI and with Monte Carlo, without and with synchronization."""
    spa, pearson, mc = ({label: METHODS[label]} for label in METHODS)
    tau = run.choose([12, 14, 16, 18, 20], [12, 16])
    missions = [1, 2, 3, 5, 8, 10]
    budget = [run.choose(2_000_000, 40_000)]

    T = run.choose(steps(-8, 8, 1), [-4, 0, 4, 8])
    run.compare("no-sync", PROBLEMS, spa, criteria(T, None, missions))
    T = run.choose(steps(-8, 8, 1), [0, 4])
    run.compare("sync", PROBLEMS, pearson, criteria(T, tau, [2, 5]))
    T = run.choose(steps(-8, 8, 2), [0, 4])
    run.compare("mc-no-sync", PROBLEMS, mc, criteria(T, None, [1, 2, 5, 10]), budget)
    run.compare("mc-sync", PROBLEMS, mc, criteria(T, tau, [2, 5]), budget)


def page(run: Run) -> "uqfold.report.Page":
    """Show Tables 2 and 3, and Fig. 12."""
    page = new_page(run, __doc__)
    page.section("Tables")
    page.table(inputs_table(PROBLEMS["series"]), "Table 2: random inputs")
    page.table(evaluations_table(run, *NAMES), "Table 3: evaluations of the model")
    page.table(
        errors_table(run, *NAMES),
        "Errors by decade of the failure probability",
        "All criteria of the figures. The saddlepoint approximation has four cumulants to tell the "
        "tail from; the errors of Monte Carlo are those of its sample. On the plateau under "
        "synchronization T no longer matters: pf is that of tau alone.",
    )
    page.section("Figures")
    accuracy_figures(page, run, 12)
    return finish(page, run, METHODS)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
