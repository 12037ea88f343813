"""References of Example 3 (section 4.3, Table 6) by simulation of the real mechanism.

Work comes in blocks of fixed size with random streams of their own. A block has 128 draws of the
shared inputs, and for each of them 40 replicates of a unit. The deployment time changes mostly
along one direction of a unit's own inputs; the standard-normal coordinate in that direction is cut
into strata, far into both tails. A replicate is one deployment out of each stratum, weighted with
its probability: its weighted shares estimate the distribution of one unit without bias, wherever
the direction points and however the model behaves. The direction, taken from the low-fidelity
partner, only says where errors get small. `mission_estimators.py` turns replicates into estimates
without bias, and the standard error comes from the spread of the block means.

All deployments are kept in `STORE`, so that a run that was stopped or killed is continued by the
same command, with more blocks if wanted.

    python validation/references/folding_wing.py --blocks 104
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from mission_estimators import estimate, missions_of
from scipy.special import ndtr, ndtri
from scipy.stats.qmc import Sobol
from tables import BINOMIAL_PROFILES, Grid, write

from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.problems import Problem, folding_wing
from uqfold.problems.reference import Reference
from uqfold.typing import FloatArray, Model

GRID = Grid(
    thresholds=tuple(round(0.53 + 0.0025 * i, 4) for i in range(29)),
    taus=(None, 0.02, 0.025, 0.03, 0.035, 0.04, 0.045, 0.05, 0.06),
    profiles=(1, 2, 5, 8, 10, *BINOMIAL_PROFILES),
)
# the deployment time is nearly linear in this variable: its 5.6 standard deviations are 0.592 s
STRATA = tuple(round(0.7 * i, 1) for i in range(-5, 9))
"""Edges between the strata."""
SHARED_DRAWS = 128
SEED = 20261
LARGEST_RELATIVE_ERROR = 0.3
STORE = Path("uqfold-results") / "folding-wing-reference.db"


def simulate(
    problem: Problem,
    grid: Grid,
    *,
    blocks: int,
    seed: int = SEED,
    draws: int = SHARED_DRAWS,
    strata: Sequence[float] = STRATA,
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
    replicates = missions_of(grid) * grid.units

    def generator(block: int, purpose: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(block, purpose)))

    def drawn(block: int) -> FloatArray:
        return block_inputs(inputs, direction, strata, generator(block, 0), draws, replicates)

    session = (evaluator or Evaluator(failed_runs="raise")).open(problem, None)
    estimates = []
    for block, y in enumerate(session.stream(drawn(block) for block in range(blocks))):
        times = y.reshape(draws, replicates, -1)
        estimates.append(estimate(grid, times, probabilities(strata), generator(block, 1)))
    return np.array(estimates)


def ends(strata: Sequence[float]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the probabilities beyond both ends of each of the L strata, in its nearer tail.

    Parameters
    ----------
    strata
        Edges between the strata of a standard-normal variable, ascending.

    Returns
    -------
    tuple
        Sign (L,) of the variable, -1 where the upper tail is the nearer one; distribution function
        of the variable of that sign at the left and at the right end.
    """
    edges = np.array([-np.inf, *strata, np.inf])
    sign = np.where(edges[:-1] >= 0.0, -1.0, 1.0)
    return sign, ndtr(sign * edges[:-1]), ndtr(sign * edges[1:])


def probabilities(strata: Sequence[float]) -> FloatArray:
    """Return the probability (L,) of each stratum, exact in both tails."""
    _, left, right = ends(strata)
    return np.abs(right - left)


def steepest_direction(model: Model, inputs: JointInputs) -> FloatArray:
    """Return the direction (n_individual,) in which the response rises most, at the medians."""
    step = 0.01
    here = np.zeros((2 * inputs.n_individual, inputs.dimension))
    here[:, inputs.n_shared :] = np.repeat(step * np.eye(inputs.n_individual), 2, axis=0)
    here[1::2] *= -1.0
    y = model(inputs.from_standard_normal(here))
    gradient = y[::2] - y[1::2]
    direction: FloatArray = gradient / np.linalg.norm(gradient)
    return direction


def block_inputs(
    inputs: JointInputs,
    direction: FloatArray,
    strata: Sequence[float],
    rng: np.random.Generator,
    draws: int,
    replicates: int,
) -> FloatArray:
    """Draw the inputs of one block.

    The shared draws are a scrambled Sobol sequence, each of them uniform, so that the mean over a
    block has no bias.

    Parameters
    ----------
    inputs
        Shared and individual inputs.
    direction
        Unit vector (n_individual,).
    strata
        Edges of the L strata along it.
    rng
        Stream of this block.
    draws, replicates
        Shared draws (a power of 2), and replicates of each.

    Returns
    -------
    FloatArray
        X (draws * replicates * L, d), the strata running fastest.
    """
    levels = Sobol(inputs.n_shared, scramble=True, rng=rng).random(draws)
    sign, left, right = ends(strata)
    along = left + (right - left) * (1.0 - rng.random((draws * replicates, sign.size)))
    # rounding may reach 0
    z = sign * ndtri(np.maximum(along, np.finfo(np.float64).tiny))
    own = rng.standard_normal((z.size, inputs.n_individual))
    own += (z.reshape(-1, 1) - own @ direction[:, None]) * direction
    shared = ndtri(np.maximum(levels, np.finfo(np.float64).tiny))
    repeated = np.repeat(shared, z.size // draws, axis=0)
    return inputs.from_standard_normal(np.column_stack([repeated, own]))


def known(grid: Grid, estimates: FloatArray) -> list[Reference]:
    """Return the answers whose relative standard error is small enough to call them known."""
    error = estimates.std(axis=0, ddof=1) / np.sqrt(len(estimates))
    return [
        one
        for one in grid.references(estimates.mean(axis=0), error)
        if one.pf > 0.0 and one.std_error <= LARGEST_RELATIVE_ERROR * one.pf
    ]


def explained(grid: Grid, blocks: int) -> str:
    """Return how the references were made."""
    replicates = missions_of(grid) * grid.units
    deployments = blocks * SHARED_DRAWS * replicates * (len(STRATA) + 1)
    return (
        f"Simulation of the mechanism, {deployments} deployments: {blocks} blocks of "
        f"{SHARED_DRAWS} shared draws (scrambled Sobol), each with {replicates} replicates of "
        f"a wing in {len(STRATA) + 1} strata along the gradient of the deployment time with ideal "
        "joints; estimators without bias given the shared draw. The error is the standard error "
        f"from the spread of the block means; rows where it exceeds {LARGEST_RELATIVE_ERROR:.0%} "
        "of pf are left out."
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=104, help="blocks in all, at least 2")
    parser.add_argument("--seed", type=int, default=SEED)
    options = parser.parse_args(arguments)
    blocks, seed = options.blocks, options.seed
    if blocks < 2:
        parser.error(f"--blocks {blocks}: a standard error takes at least 2 blocks")
    STORE.parent.mkdir(parents=True, exist_ok=True)
    evaluator = Evaluator(failed_runs="raise", store=STORE)
    estimates = simulate(folding_wing(), GRID, blocks=blocks, seed=seed, evaluator=evaluator)
    command = f"python validation/references/folding_wing.py --blocks {blocks} --seed {seed}"
    found = known(GRID, estimates)
    write("folding_wing", explained(GRID, blocks), command, found, kind="simulation")


if __name__ == "__main__":
    main()
