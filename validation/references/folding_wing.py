"""References of Example 3 (section 4.3, Table 6) by simulation of the real mechanism.

Work comes in blocks of fixed size with random streams of their own. In a block, 512 draws of the
shared inputs are stratified (Latin hypercube: each is uniform, so that the block stays unbiased),
and each has 10 missions x 4 wings of independent deployments; `mission_estimators.py` turns them
into estimates without bias. The standard error comes from the spread of the block means.

Only running sums are kept. They are saved after every block, so that a run can be interrupted
(Ctrl-C) and continued by the same command, with more blocks if wanted.

    python validation/references/folding_wing.py --blocks 400
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mission_estimators import MissionGrid
from scipy.special import ndtri
from tables import BINOMIAL_PROFILES, SHIPPED, Row, as_text, write

from uqfold.inputs import JointInputs
from uqfold.problems import folding_wing
from uqfold.typing import FloatArray, Model

GRID = MissionGrid(
    thresholds=tuple(round(0.53 + 0.0025 * i, 4) for i in range(25)),
    taus=(None, 0.02, 0.025, 0.03, 0.035, 0.04, 0.045, 0.05, 0.06),
    profiles=(1, 2, 5, 8, 10, *BINOMIAL_PROFILES),
)
SHARED_DRAWS = 512
SEED = 20240
LARGEST_RELATIVE_ERROR = 0.3
DEFAULT_CHECKPOINT = Path("uqfold-results") / "folding_wing_reference.npz"


def block_times(
    model: Model, inputs: JointInputs, grid: MissionGrid, rng: np.random.Generator, draws: int
) -> FloatArray:
    """Simulate one block: responses (draws, missions, units)."""
    d = inputs.n_shared
    strata = np.column_stack([rng.permutation(draws) for _ in range(d)])
    level = (strata + rng.random((draws, d))) / draws
    shared = ndtri(np.maximum(level, np.finfo(np.float64).tiny))  # random() may be 0
    per_draw = grid.missions * grid.units
    individual = rng.standard_normal((draws * per_draw, inputs.n_individual))
    u = np.column_stack([np.repeat(shared, per_draw, axis=0), individual])
    y = np.asarray(model(inputs.from_standard_normal(u)), dtype=np.float64)
    return y.reshape(draws, grid.missions, grid.units)


@dataclass
class Accumulation:
    """Running mean and spread of the block estimates, and what they belong to.

    Attributes
    ----------
    settings
        Text that names seed, block size, grid and model; sums of other settings are refused.
    blocks
        Blocks so far; block i always has random stream i.
    mean, squares
        Mean of the block estimates and sum of squared deviations from it.
    """

    settings: str
    mean: FloatArray
    squares: FloatArray
    blocks: int = 0

    def add(self, estimate: FloatArray) -> None:
        """Take in the estimates of the next block (Welford's recurrence)."""
        self.blocks += 1
        change = estimate - self.mean
        self.mean = self.mean + change / self.blocks
        self.squares = self.squares + change * (estimate - self.mean)

    @property
    def std_error(self) -> FloatArray:
        """Standard error of the mean; NaN before the second block."""
        if self.blocks < 2:
            return np.full_like(self.mean, np.nan)
        error: FloatArray = np.sqrt(self.squares / (self.blocks * (self.blocks - 1)))
        return error

    def save(self, path: Path) -> None:
        """Write the sums; the former file is replaced at once."""
        path.parent.mkdir(parents=True, exist_ok=True)
        partial = path.with_name(path.name + ".partial")
        with partial.open("wb") as file:
            np.savez(
                file,
                settings=np.array(self.settings),
                blocks=np.array(self.blocks),
                mean=self.mean,
                squares=self.squares,
            )
        os.replace(partial, path)

    def load(self, path: Path) -> None:
        """Continue from saved sums.

        Raises
        ------
        ValueError
            If they belong to other settings or another model.
        """
        with np.load(path, allow_pickle=False) as saved:
            if str(saved["settings"]) != self.settings:
                raise ValueError(
                    f"{path} belongs to another seed, grid, block size or model: name another "
                    "--checkpoint, or remove the file to start afresh"
                )
            self.blocks = int(saved["blocks"])
            self.mean, self.squares = saved["mean"], saved["squares"]


def start(
    model: Model, inputs: JointInputs, grid: MissionGrid, seed: int, draws: int
) -> Accumulation:
    """Give empty sums for these settings."""
    # a few responses stand for the model: a changed mechanism must not continue old sums
    probe = np.random.default_rng(0).standard_normal((4, inputs.dimension))
    settings = {
        "seed": seed,
        "shared_draws": draws,
        "grid": repr(grid),
        "model": [float(y) for y in model(inputs.from_standard_normal(probe))],
    }
    return Accumulation(json.dumps(settings), np.zeros(grid.shape), np.zeros(grid.shape))


def simulate(
    model: Model,
    inputs: JointInputs,
    grid: MissionGrid,
    *,
    blocks: int,
    seed: int = SEED,
    draws: int = SHARED_DRAWS,
    checkpoint: Path | None = None,
    progress: Callable[[Accumulation], None] | None = None,
) -> Accumulation:
    """Simulate up to `blocks` blocks in all, continuing from the checkpoint if there is one."""
    sums = start(model, inputs, grid, seed, draws)
    if checkpoint is not None and checkpoint.exists():
        sums.load(checkpoint)
    while sums.blocks < blocks:
        rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(sums.blocks,)))
        sums.add(grid.estimate(block_times(model, inputs, grid, rng, draws), rng))
        if checkpoint is not None:
            sums.save(checkpoint)
        if progress is not None:
            progress(sums)
    return sums


def known_rows(grid: MissionGrid, sums: Accumulation) -> list[Row]:
    """Give the rows whose relative standard error is small enough to call them known."""
    error = sums.std_error
    known = (sums.mean > 0.0) & (error <= LARGEST_RELATIVE_ERROR * sums.mean)
    return [
        Row(threshold, tau, profile, float(sums.mean[i, j, k]), float(error[i, j, k]))
        for i, tau in enumerate(grid.taus)
        for j, profile in enumerate(grid.profiles)
        for k, threshold in enumerate(grid.thresholds)
        if known[i, j, k]
    ]


def document(grid: MissionGrid, sums: Accumulation, seed: int, draws: int) -> str:
    """Give the text of ``folding_wing.json``."""
    deployments = sums.blocks * draws * grid.missions * grid.units
    how = (
        f"Simulation of the mechanism, {deployments} deployments: {sums.blocks} blocks of {draws} "
        f"stratified shared draws with {grid.missions} missions of {grid.units} wings each; "
        "estimators without bias given the shared draw. The error is the standard error from the "
        "spread of the block means; rows where it exceeds "
        f"{LARGEST_RELATIVE_ERROR:.0%} of pf are left out."
    )
    command = f"python validation/references/folding_wing.py --blocks {sums.blocks} --seed {seed}"
    return as_text("folding-wing", "simulation", how, command, known_rows(grid, sums))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--blocks", type=int, default=400, help="blocks in all (default 400)")
    parser.add_argument("--seed", type=int, default=SEED, help=f"seed (default {SEED})")
    parser.add_argument(
        "--checkpoint",
        type=Path,
        default=DEFAULT_CHECKPOINT,
        help=f"file that keeps the sums between runs (default {DEFAULT_CHECKPOINT})",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=SHIPPED / "folding_wing.json",
        help="reference file to write (default: the package's)",
    )
    options: Any = parser.parse_args(arguments)
    if options.blocks < 2:
        parser.error(f"--blocks {options.blocks}: a standard error takes at least 2 blocks")
    problem = folding_wing()
    began = time.monotonic()
    first: list[int] = []

    def progress(sums: Accumulation) -> None:
        if not first:
            first.append(sums.blocks - 1)
        each = (time.monotonic() - began) / (sums.blocks - first[0])
        left = each * (options.blocks - sums.blocks)
        line = f"block {sums.blocks}/{options.blocks}, {each:.1f} s each, {left / 60:.0f} min left"
        print(f"\r{line:<60}", end="", file=sys.stderr, flush=True)

    shown = progress if sys.stderr.isatty() else None
    try:
        sums = simulate(
            problem.model,
            problem.inputs,
            GRID,
            blocks=options.blocks,
            seed=options.seed,
            checkpoint=options.checkpoint,
            progress=shown,
        )
    except KeyboardInterrupt:
        print(
            f"\nstopped; the finished blocks are in {options.checkpoint}: the same command "
            "continues from there",
            file=sys.stderr,
        )
        return 130
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    text = document(GRID, sums, options.seed, SHARED_DRAWS)
    write(options.out, text)
    print(f"{options.out}: {len(json.loads(text)['rows'])} of {sums.mean.size} rows known")
    return 0


if __name__ == "__main__":
    sys.exit(main())
