"""Example 5: other standard deviations.

How does the reliability of the folding-wing system change when the standard deviation of one input
changes, without and with synchronization, and is it the real model that says so, or the method?

Conditions 11 to 20 of Table 9: Table 6 with one standard deviation changed. FFNI with 1,125 model
runs answers: with the saddlepoint approximation without synchronization (our choice of missions,
m = 2, 5, 8, 10, as in Fig. 15), with the Pearson distribution under synchronization (tau = 0.03 to
0.05 s and a binomial number of missions with 10 planned and p = 0.7, as in the text). The text
gives no ranges of T; ours span both curves from almost certain failure to the plateau. Marks are a
simulation of the real model without any approximation, 61,440 deployments per condition, with 95 %
intervals.

The clearance moves the deployment time so little, and so roughly (chaotic first impacts, errors of
the time steps), that five nodes of it sample mostly roughness: the difference of conditions 19 and
20 by FFNI has no meaning. It comes from both conditions run with the same random numbers and
mirrored clearances instead (`uqfold.analysis.paired_differences`, 8,000 draws of the shared inputs,
416,004 runs), and its band is two standard errors wide on either side.
"""

import sys
from pathlib import Path

import uqfold
from uqfold import criteria
from uqfold.analysis import paired_differences

sys.path.append(str(Path(__file__).parents[1]))
import paper
from paper import FLOWN, TAU, steps
from runner import Run, main

TOLERANCE = (1e-3, 1e-6)

PAIRS = {
    (11, 12): (steps(0.51, 0.60, 0.003), [0.54, 0.549, 0.558, 0.567, 0.576], 0.549),
    (13, 14): (steps(0.51, 0.60, 0.003), [0.54, 0.549, 0.558, 0.567, 0.576], 0.549),
    (15, 16): (steps(0.50, 0.635, 0.005), [0.54, 0.55, 0.565, 0.58, 0.6], 0.55),
    (17, 18): (steps(0.50, 0.64, 0.005), [0.54, 0.55, 0.565, 0.58, 0.6], 0.55),
    (19, 20): (steps(0.51, 0.60, 0.003), [0.54, 0.549, 0.558, 0.57], 0.549),
}
"""Conditions -> thresholds (s) for FFNI, for the simulation, and of its reduced form."""


PROBLEMS = {f"condition-{number}": paper.condition(number) for number in range(11, 21)}


def tables(run: Run) -> None:
    """Answer every pair of conditions; run the last one with the same random numbers besides."""
    for numbers, thresholds in PAIRS.items():
        paper.answer_pair(run, numbers, *thresholds)
    T = run.choose(steps(0.51, 0.60, 0.005), [0.555, 0.57])
    keep_differences(run, "C_r-paired", criteria(T, None, run.choose([2, 5, 8, 10], [2, 10])))
    T, tau = run.choose((steps(0.51, 0.60, 0.005), TAU), ([0.54, 0.57], [0.03, 0.05]))
    keep_differences(run, "C_r-sync-paired", criteria(T, tau, FLOWN))


def keep_differences(run: Run, name: str, grid: uqfold.Criteria) -> None:
    """Keep R of condition 19 less R of condition 20, from the same random numbers."""
    draws = run.choose(8000, 12)
    first, second = PROBLEMS["condition-19"], PROBLEMS["condition-20"]
    found = paired_differences(first, second, grid, draws, rng=0)
    frame = found.to_frame().drop(columns=["pf", "pf_other"])
    frame.insert(3, "draws", draws)
    frame = frame.assign(n_evals=found.n_evals, seed=0)
    run.keep(name, frame, problem="condition-19", other="condition-20")


def page(run: Run) -> "uqfold.report.Page":
    """Show Table 9, the evaluations, and Fig. 17."""
    return paper.pairs_page(run, __doc__, 9, 17, PAIRS)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
