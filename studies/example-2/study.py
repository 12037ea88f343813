"""Example 2: two four-bar linkages on one crank.

Does FFNI with 375 model runs give the positioning reliability of two four-bar linkages that share
their crank, without and with synchronization, and does it matter on which branch they are
assembled?

The reference is exact: integration without sampling. `mc` is Monte Carlo with 2,000,000 runs.

Table 5 is lost in the text; three nodes for the shared and five for each of three individual inputs
give 375 runs. The sign in Eq. (50) is not given: + is the open linkage (phi near 99 deg), on which
the shared crank carries a quarter of a per cent of the variance; - is the crossed one (phi near
-142 deg), on which it carries about a third, so that correlation shows. Figures (a) to (e) are
drawn for both. Table 4 as printed gives the second linkage a ground R_7 of 66.5 mm; it is taken as
the misprint it seems to be, since the two rockers would stand 50 deg apart.

The text gives no values of T and tau. Our T spans failure probabilities from 0.7 to 1e-7, our tau
from 2 to 6 deg the climb to the plateau.
"""

import sys
from pathlib import Path

import uqfold
from uqfold import criteria

sys.path.append(str(Path(__file__).parents[1]))
from paper import FFNI, accuracy_figures, errors_table, evaluations_table, inputs_table, steps
from runner import Run, finish, main, new_page

TOLERANCE = (1e-6, 1e-12)

METHODS = {**FFNI, "mc": uqfold.methods.MonteCarlo()}
BRANCHES = {"open": (98, 106), "crossed": (-144, -135)}
"""Branch -> range of T (deg)."""
PROBLEMS = {branch: uqfold.problems.four_bar(branch=branch) for branch in BRANCHES}
NAMES = [
    f"{kind}-{branch}"
    for branch in BRANCHES
    for kind in ("no-sync", "sync", "mc-no-sync", "mc-sync")
]


def tables(run: Run) -> None:
    """Answer on both branches with FFNI and with Monte Carlo, without and with synchronization."""
    spa, pearson, mc = ({label: METHODS[label]} for label in METHODS)
    tau = run.choose([2, 3, 4, 5, 6], [3, 5])
    budget = [run.choose(2_000_000, 20_000)]
    for branch, (low, high) in BRANCHES.items():
        one = {branch: PROBLEMS[branch]}
        few = {"open": [99, 102, 105], "crossed": [-142, -139, -136]}[branch]
        T = run.choose(steps(low, high, 0.5), few)
        grid = criteria(T, None, [1, 2, 3, 5, 8, 10])
        run.compare(f"no-sync-{branch}", one, spa, grid)
        T = run.choose(steps(low, high, 0.5), few[:2])
        run.compare(f"sync-{branch}", one, pearson, criteria(T, tau, [2, 5]))
        T = run.choose(steps(low, high, 1), few[:2])
        run.compare(f"mc-no-sync-{branch}", one, mc, criteria(T, None, [1, 2, 5, 10]), budget)
        run.compare(f"mc-sync-{branch}", one, mc, criteria(T, tau, [2, 5]), budget)


def page(run: Run) -> "uqfold.report.Page":
    """Show Tables 4 and 5, and Fig. 14 on both branches."""
    page = new_page(run, __doc__)
    page.section("Tables")
    page.table(inputs_table(PROBLEMS["open"]), "Table 4: random inputs")
    page.table(evaluations_table(run, *NAMES), "Table 5: evaluations of the model")
    page.table(errors_table(run, *NAMES), "Errors by decade of the failure probability")
    page.section("Figures")
    for branch in BRANCHES:
        accuracy_figures(page, run, 14, branch)
    return finish(page, run, METHODS)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
