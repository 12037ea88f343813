"""Example 4: other means.

How does the reliability of the folding-wing system change when the mean of one input changes,
without and with synchronization, and is it the real model that says so, or the method?

Conditions 1 to 10 of Table 8: Table 6 with one mean changed. FFNI with 1,125 model runs answers:
with the saddlepoint approximation without synchronization (our choice of missions, m = 2, 5, 8, 10,
as in Fig. 15), with the Pearson distribution under synchronization (tau = 0.03 to 0.05 s and a
binomial number of missions with 10 planned and p = 0.7, as in the text). The text gives no ranges
of T; ours span both curves from almost certain failure to the plateau. Marks are a simulation of
the real model without any approximation, 61,440 deployments per condition, with 95 % intervals.

On the plateau under synchronization conditions 3 and 4 lie close together, which a longer
simulation resolves (table delta-plateau); conditions 9 and 10 differ little as well, and the
scatter of the model is set beside their difference (table C_r-sync-scatter).
"""

import hashlib
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.special import ndtri

import uqfold
from uqfold import criteria

sys.path.append(str(Path(__file__).parents[1]))
import paper
from paper import FLOWN, steps
from runner import Run, main

TOLERANCE = (1e-3, 1e-6)

PAIRS = {
    (1, 2): (steps(0.51, 0.61, 0.004), [0.534, 0.55, 0.558, 0.566, 0.582, 0.598], 0.55),
    (3, 4): (steps(0.51, 0.60, 0.003), [0.528, 0.54, 0.549, 0.558, 0.57, 0.579, 0.597], 0.54),
    (5, 6): (steps(0.48, 0.63, 0.005), [0.51, 0.525, 0.535, 0.575, 0.59, 0.605, 0.625], 0.525),
    (7, 8): (steps(0.49, 0.63, 0.005), [0.52, 0.535, 0.545, 0.575, 0.59, 0.605, 0.62], 0.535),
    (9, 10): (steps(0.51, 0.60, 0.003), [0.54, 0.549, 0.558, 0.57, 0.597], 0.549),
}
"""Conditions -> thresholds (s) for FFNI, for the simulation, and of its reduced form."""


PROBLEMS = {f"condition-{number}": paper.condition(number) for number in range(1, 11)}


def tables(run: Run) -> None:
    """Answer every pair of conditions; look closer where they hardly differ."""
    for numbers, thresholds in PAIRS.items():
        paper.answer_pair(run, numbers, *thresholds)
    pair = {name: PROBLEMS[name] for name in ("condition-3", "condition-4")}
    long = {"long simulation": uqfold.methods.ConditionalMonteCarlo(blocks=384)}
    budget = [run.choose(None, 3072)]
    run.compare("delta-plateau", pair, long, criteria(0.597, [0.03, 0.05], FLOWN), budget)
    run.keep("C_r-sync-scatter", scatter(run))


def scatter(run: Run) -> pd.DataFrame:
    """Return pf by FFNI, and how it scatters when the clearance of every run is nudged.

    The first impacts are chaotic: two runs with nearly the same inputs differ by more than the
    inputs do, and so do answers made from 1,125 runs.
    """
    tables, repeats = [], run.choose(20, 2)
    method = paper.FFNI["ffni-pearson"]
    grid = criteria(*run.choose(([0.549, 0.6], [0.03, 0.05]), (0.549, 0.03)), FLOWN)
    for number in run.choose([9, 10], [10]):
        problem = PROBLEMS[f"condition-{number}"]
        plain = method.estimate(problem, grid, rng=0, evaluator=run.evaluator(problem)).to_frame()
        for relative in run.choose([1e-6, 1e-3, 1e-2], [1e-2]):
            nudged = [
                method.estimate(nudge(problem, relative, seed), grid, rng=0).pf
                for seed in range(repeats)
            ]
            spread = pd.DataFrame(nudged).agg(["mean", "std", "min", "max"]).T
            spread.columns = ["pf_mean", "pf_std", "pf_low", "pf_high"]
            tables.append(plain[["threshold", "tau", "missions", "pf"]].join(spread).assign(
                problem=f"condition-{number}", label="ffni-pearson", relative=relative,
                repeats=repeats,
            ))  # fmt: skip
    order = ["problem", "label", "relative", "threshold", "tau", "missions", "repeats"]
    return pd.concat(tables)[[*order, "pf", "pf_mean", "pf_std", "pf_low", "pf_high"]]


def nudge(problem: uqfold.Problem, relative: float, seed: int) -> uqfold.Problem:
    """Return a problem whose model sees its clearance changed by a tiny relative amount.

    The change is a standard-normal number made from the row itself and the seed, so that a row has
    one response, whatever batch it comes in.
    """
    names, salt = problem.inputs.names, seed.to_bytes(8, "little")

    def model(x: np.ndarray) -> np.ndarray:
        digests = [hashlib.blake2b(row.tobytes(), digest_size=8, salt=salt) for row in x]
        uniform = np.array([int.from_bytes(one.digest(), "little") for one in digests]) / 2.0**64
        nudged = np.array(x)
        nudged[:, names.index("C_r")] *= 1.0 + relative * ndtri(uniform + 0.5 / 2.0**64)
        return problem.model(nudged)

    return uqfold.Problem(
        model, inputs=problem.inputs.distribution, names=names,
        shared=problem.inputs.shared_names, units=problem.n_units,
    )  # fmt: skip


def page(run: Run) -> "uqfold.report.Page":
    """Show Table 8, the evaluations, and Fig. 16."""
    return paper.pairs_page(run, __doc__, 8, 16, PAIRS)


if __name__ == "__main__":
    main(__file__, PROBLEMS, tables, page, TOLERANCE)
