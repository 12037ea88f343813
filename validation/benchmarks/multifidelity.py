"""What the wing with ideal joints saves of runs of the wing: prints the tables of docs.

    python -m validation.benchmarks.multifidelity

asks `multifidelity-mc` about Example 3 at pf = 1e-3 with several budgets, and sets beside each the
runs and the processor time that crude Monte Carlo would take for the same standard error. Then it
asks `conditional-mc` with and without the partner as control variate, and `kriging` with and
without it as trend, the latter also about a pair of models whose answer is known; in all about
three minutes.
"""

import math
import time

import numpy as np
from scipy.special import ndtr

import uqfold
from uqfold.inputs import normal
from uqfold.methods import ConditionalMonteCarlo, Kriging, MonteCarlo, MultifidelityMonteCarlo
from uqfold.problems import folding_wing
from uqfold.problems.criterion import Criterion, criteria

QUESTION = Criterion(0.5717)
"""At this threshold (s) pf is about 1e-3."""
COST_RATIO = 60.0
BUDGETS = 6_000, 20_000, 60_000
SEED = 14
GRID = criteria([0.5450, 0.5532, 0.5655, 0.5717])
CONDITIONAL_RUNS, SEEDS = 25_600, range(8)
NEW = 4_000
"""New runs that tell by how much a surface misses them."""
TIMED = 20_000
"""Runs that tell what one run of crude Monte Carlo costs."""


def main() -> None:
    """Print both tables."""
    by_budget()
    print()
    as_control_variate()
    print()
    as_trend()


def waves(x):
    """What the pair has in common: too many waves for some hundred runs."""
    return 0.4 * np.sin(1.5 * x[:, 0] + x[:, 1]) + 0.3 * np.cos(1.2 * x[:, 1] - 1.5 * x[:, 2])


def cheap(x):
    """Return the partner's responses (n,) to X (n, 3)."""
    return 0.8 * x[:, 0] + x[:, 1] + 0.6 * x[:, 2] + waves(x)


def dear(x):
    """Return the model's."""
    return 0.9 * x[:, 0] + 0.9 * x[:, 1] + 0.6 * x[:, 2] + 0.05 * x[:, 0] * x[:, 2] + 1.1 * waves(x)


def pair():
    """Three units in series of that pair."""
    return uqfold.Problem(
        dear,
        low_fidelity=cheap,
        shared={"V": normal(0, 1)},
        individual={"U": normal(0, 1), "W": normal(0, 1)},
        units=3,
    )


def exact(threshold):
    """Return pf of the pair by sums over grids, the limit smoothed over a hundredth."""
    steps, places = 14.0 / 600, np.linspace(-7.0, 7.0, 601)
    both = np.stack(np.meshgrid(places, places, indexing="ij"), axis=-1).reshape(-1, 2)
    weights = np.exp(-0.5 * (both**2).sum(axis=1)) / (2.0 * math.pi) * steps**2
    fails = []
    for v in places:
        y = dear(np.column_stack([np.full(len(both), v), both]))
        fails.append(weights @ ndtr((y - threshold) / 0.01))
    density = np.exp(-0.5 * places**2) / math.sqrt(2.0 * math.pi) * steps
    return float(density @ -np.expm1(3.0 * np.log1p(-np.array(fails))))


def as_trend() -> None:
    """Print what Kriging makes of few runs of the model, with the partner and without."""
    wing = folding_wing()
    rng = np.random.default_rng(SEED)
    new = {}
    for problem, threshold in ((pair(), 4.5), (wing, 0.5655)):
        x = problem.inputs.sample(rng, NEW)
        new[threshold] = problem, x, problem.model(x)
    columns = "model", "runs", "partner runs", "pf", "stated error", "status"
    columns += "new runs missed by (rms)", "processor seconds of the fit"
    print("| " + " | ".join(columns) + " |\n" + "| --- " * len(columns) + "|")
    for threshold, (problem, x, y) in new.items():
        for runs in (40, 100):
            for ratio in (0, 10):
                begun = time.process_time()
                result = Kriging(runs=runs, partner_runs=ratio).estimate(problem, threshold, rng=1)
                seconds, row = time.process_time() - begun, result[0]
                foretold = result.details.surface.mean(problem.inputs.to_standard_normal(x))
                cells = (
                    "pair" if problem is not wing else "wing",
                    f"{runs}",
                    f"{result.details.partner_evals:,}",
                    f"{row.pf:.4g}",
                    f"{row.std_error:.1e}",
                    f"`{row.status}`",
                    f"{np.sqrt(np.mean((foretold - y) ** 2)):.2g}",
                    f"{seconds:.1f}",
                )
                print("| " + " | ".join(cells) + " |", flush=True)
    print(f"\nExact for the pair: {exact(4.5):.5g}")


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
