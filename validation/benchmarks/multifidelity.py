"""What the wing with ideal joints saves of runs of the wing: prints the tables of docs.

    python -m validation.benchmarks.multifidelity

asks `multifidelity-mc` about Example 3 at pf = 1e-3 with several budgets, and sets beside each the
runs and the processor time that crude Monte Carlo would take for the same standard error. Then it
asks `conditional-mc` with and without the partner as control variate; in all about two minutes.
"""

import time

import numpy as np

from uqfold.methods import ConditionalMonteCarlo, MonteCarlo, MultifidelityMonteCarlo
from uqfold.problems import folding_wing
from uqfold.problems.criterion import Criterion, criteria

QUESTION = Criterion(0.5717)
"""At this threshold (s) pf is about 1e-3."""
COST_RATIO = 60.0
BUDGETS = 6_000, 20_000, 60_000
SEED = 14
GRID = criteria([0.5450, 0.5532, 0.5655, 0.5717])
CONDITIONAL_RUNS, SEEDS = 25_600, range(8)
TIMED = 20_000
"""Runs that tell what one run of crude Monte Carlo costs."""


def main() -> None:
    """Print both tables."""
    by_budget()
    print()
    as_control_variate()


def as_control_variate() -> None:
    """Print for each threshold the stated errors without and with the partner, over the seeds."""
    problem = folding_wing()
    found = {}
    for blocks in (0, 20):
        method = ConditionalMonteCarlo(partner_blocks=blocks)
        found[blocks] = [
            method.estimate(problem, GRID, max_evals=CONDITIONAL_RUNS, rng=seed) for seed in SEEDS
        ]
    gains = np.mean([one.details.gain for one in found[20]], axis=0)
    print("| T (s) | pf | error without | with the partner | variance divided by |")
    print("| --- | --- | --- | --- | --- |")
    for i, criterion in enumerate(GRID):
        pf = np.mean([one[i].pf for one in found[20]])
        errors = [
            f"{100.0 * np.mean([one[i].std_error / one[i].pf for one in found[blocks]]):.2g} %"
            for blocks in found
        ]
        cells = f"{criterion.threshold:.4f}", f"{pf:.2g}", *errors, f"{gains[i]:.1f}"
        print("| " + " | ".join(cells) + " |", flush=True)


def by_budget() -> None:
    """Print a row for each budget."""
    problem = folding_wing()
    method = MultifidelityMonteCarlo(cost_ratio=COST_RATIO)
    # both models are compiled before anything is timed
    for warm_up in (MonteCarlo(), method):
        warm_up.estimate(problem, QUESTION, max_evals=1_000, rng=SEED)
    started = time.process_time()
    MonteCarlo().estimate(problem, QUESTION, max_evals=TIMED, rng=SEED)
    per_run = (time.process_time() - started) / TIMED
    columns = "runs", "partner runs", "pf", "standard error", "95 % interval", "status"
    columns += "crude runs for it", "times the runs", "times the time"
    print("| " + " | ".join(columns) + " |\n" + "| --- " * len(columns) + "|")
    for budget in BUDGETS:
        started = time.process_time()
        result = method.estimate(problem, QUESTION, max_evals=budget, rng=SEED)
        seconds, row = time.process_time() - started, result[0]
        crude = problem.n_units * row.pf * (1.0 - row.pf) / row.std_error**2
        cells = (
            f"{row.n_evals:,}",
            f"{result.details.partner_evals:,}",
            f"{row.pf:.3e}",
            f"{row.std_error:.1e} ({100.0 * row.std_error / row.pf:.2g} %)",
            f"{row.ci_low:.2e} to {row.ci_high:.2e}",
            f"`{row.status}`",
            f"{crude:,.0f}",
            f"{crude / row.n_evals:.0f}",
            f"{crude * per_run / seconds:.0f}",
        )
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
