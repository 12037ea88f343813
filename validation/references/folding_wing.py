"""References of Example 3 (section 4.3, Table 6) by simulation of the real mechanism.

Work comes in blocks of fixed size with random streams of their own. A block has 128 draws of the
shared inputs, and for each of them 40 replicates of a unit that is stratified along the direction
in which its deployment time rises most (`stratified_draws.py`); `mission_estimators.py` turns them
into estimates without bias, from the body of the distribution far into its tail. The standard error
comes from the spread of the block means.

All deployments are kept in a store, so that a run that was stopped or killed is continued by the
same command, with more blocks if wanted.

    python validation/references/folding_wing.py --blocks 104
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mission_estimators import MissionGrid
from stratified_draws import Strata, block_inputs, steepest_direction
from tables import BINOMIAL_PROFILES, SHIPPED, Row, as_text, write

from uqfold.evaluation import Evaluator
from uqfold.problems import Problem, folding_wing
from uqfold.typing import FloatArray

GRID = MissionGrid(
    thresholds=tuple(round(0.53 + 0.0025 * i, 4) for i in range(29)),
    taus=(None, 0.02, 0.025, 0.03, 0.035, 0.04, 0.045, 0.05, 0.06),
    profiles=(1, 2, 5, 8, 10, *BINOMIAL_PROFILES),
)
# the deployment time is nearly linear in this variable: its 5.6 standard deviations are 0.592 s
STRATA = Strata(tuple(round(0.7 * i, 1) for i in range(-5, 9)))
SHARED_DRAWS = 128
SEED = 20261
LARGEST_RELATIVE_ERROR = 0.3
DEFAULT_STORE = Path("uqfold-results") / "folding-wing-reference.db"


def simulate(
    problem: Problem,
    grid: MissionGrid,
    *,
    blocks: int,
    seed: int = SEED,
    draws: int = SHARED_DRAWS,
    strata: Strata = STRATA,
    evaluator: Evaluator | None = None,
) -> FloatArray:
    """Return the estimates of blocks 0 ... `blocks` - 1: an array (blocks, *grid.shape).

    Block i always has the random streams (i, 0) and (i, 1).

    Parameters
    ----------
    problem
        Model and inputs; its low-fidelity partner, if it has one, gives the direction of the
        strata.
    grid
        What is estimated.
    blocks, seed, draws, strata
        How much, and how it is drawn.
    evaluator
        Store and executor; a failed run has to raise.
    """
    inputs = problem.inputs
    direction = steepest_direction(problem.low_fidelity or problem.model, inputs)
    shape = (draws, grid.replicates, strata.count)

    def generator(block: int, purpose: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(block, purpose)))

    def drawn(block: int) -> FloatArray:
        rng = generator(block, 0)
        return block_inputs(inputs, direction, strata, rng, draws, grid.replicates)

    settings = evaluator or Evaluator(failed_runs="raise")
    session = settings.open(problem, None)
    responses = session.stream(drawn(block) for block in range(blocks))
    return np.array(
        [
            grid.estimate(y.reshape(shape), strata.probabilities, generator(block, 1))
            for block, y in enumerate(responses)
        ]
    )


def known_rows(grid: MissionGrid, estimates: FloatArray) -> list[Row]:
    """Return the rows whose relative standard error is small enough to call them known."""
    mean = estimates.mean(axis=0)
    error = estimates.std(axis=0, ddof=1) / np.sqrt(len(estimates))
    known = (mean > 0.0) & (error <= LARGEST_RELATIVE_ERROR * mean)
    return [
        Row(threshold, tau, profile, float(mean[i, j, k]), float(error[i, j, k]))
        for i, tau in enumerate(grid.taus)
        for j, profile in enumerate(grid.profiles)
        for k, threshold in enumerate(grid.thresholds)
        if known[i, j, k]
    ]


def document(grid: MissionGrid, estimates: FloatArray, seed: int) -> str:
    """Return the text of ``folding_wing.json``."""
    blocks = len(estimates)
    deployments = blocks * SHARED_DRAWS * grid.replicates * STRATA.count
    how = (
        f"Simulation of the mechanism, {deployments} deployments: {blocks} blocks of "
        f"{SHARED_DRAWS} shared draws (scrambled Sobol), each with {grid.replicates} replicates of "
        f"a wing in {STRATA.count} strata along the gradient of the deployment time with ideal "
        "joints; estimators without bias given the shared draw. The error is the standard error "
        f"from the spread of the block means; rows where it exceeds {LARGEST_RELATIVE_ERROR:.0%} "
        "of pf are left out."
    )
    command = f"python validation/references/folding_wing.py --blocks {blocks} --seed {seed}"
    return as_text("folding-wing", "simulation", how, command, known_rows(grid, estimates))


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=104, help="blocks in all, at least 2")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, help="keeps the deployments")
    parser.add_argument("--out", type=Path, default=SHIPPED / "folding_wing.json")
    options: Any = parser.parse_args(arguments)
    if options.blocks < 2:
        parser.error(f"--blocks {options.blocks}: a standard error takes at least 2 blocks")
    options.store.parent.mkdir(parents=True, exist_ok=True)
    evaluator = Evaluator(failed_runs="raise", store=options.store)
    estimates = simulate(
        folding_wing(), GRID, blocks=options.blocks, seed=options.seed, evaluator=evaluator
    )
    write(options.out, document(GRID, estimates, options.seed))


if __name__ == "__main__":
    main()
