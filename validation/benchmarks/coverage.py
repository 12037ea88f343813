"""How often do the intervals of a sampler hold its known answers? Prints a table of the docs.

    python -m validation.benchmarks.coverage qmc [seeds]

asks one method about four limit states whose failure probability is known, with 200 seeds each
unless told otherwise: two minutes. Unlike `rare_events` it judges all rows with an interval, and
those apart that are `converged`; `p` is the probability of so few that hold, were it 95 %.
"""

import math
import sys
from collections.abc import Iterator

import numpy as np
from scipy.special import ndtri
from scipy.stats import binom, chi2

from uqfold.methods import build
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion
from validation.benchmarks.rare_events import branches, branches_pf, linear, standard_normal

RUNS = {
    "qmc": (200_000, 60_000, 400_000, 1_000_000),
    "openturns-nais": (60_000, 60_000, 30_000, 60_000),
}
"""Runs for each limit state."""


def limit_states() -> Iterator[tuple[str, Problem, int, float, float]]:
    """Yield name, problem, inputs, limit and pf of each."""
    yield "linear", standard_normal(linear, 2), 2, -ndtri(1e-3), 1e-3
    yield "four branches", standard_normal(branches, 2), 2, 0.0, branches_pf(0.0)
    chi_square = standard_normal(lambda u: (u * u).sum(axis=1), 10)
    yield "chi-square", chi_square, 10, chi2.isf(1e-3, 10), 1e-3
    yield "tail", standard_normal(linear, 3), 3, -ndtri(1e-5), 1e-5


def held(rows: np.ndarray, pf: float) -> str:
    """Say how many intervals (n, 2) hold pf, and how likely so few are at 95 %."""
    k, n = int(np.count_nonzero((rows[:, 0] <= pf) & (pf <= rows[:, 1]))), len(rows)
    return f"{k} of {n} (p = {binom.cdf(k, n, 0.95):.2g})" if n else ""


def main(method: str, seeds: int) -> None:
    """Print a row for each limit state."""
    columns = "limit state", "inputs", "pf", "runs", "bias", "error", "stated", "covered"
    columns += ("of converged",)
    print("| " + " | ".join(columns) + " |\n" + "| --- " * len(columns) + "|", flush=True)
    for (name, problem, inputs, limit, pf), runs in zip(limit_states(), RUNS[method], strict=True):
        rows = [
            build(method).estimate(problem, Criterion(float(limit)), max_evals=runs, rng=seed)[0]
            for seed in range(seeds)
        ]
        ratio = np.array([row.pf for row in rows]) / pf
        stated = np.array([row.std_error for row in rows]) / pf / np.maximum(ratio, 1e-300)
        ends = np.array([(row.ci_low, row.ci_high) for row in rows])
        clean = np.array([row.status == "converged" for row in rows])
        cells = (
            name,
            str(inputs),
            f"{pf:.2g}",
            f"{runs:,}",
            f"{100.0 * (ratio.mean() - 1.0):+.1f} ± {100.0 * ratio.std() / math.sqrt(seeds):.1f} %",
            f"{100.0 * math.sqrt(np.mean((ratio - 1.0) ** 2)):.1f} %",
            f"{100.0 * np.nanmedian(stated):.1f} %",
            held(ends[np.isfinite(ends).all(axis=1)], pf),
            held(ends[clean], pf),
        )
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 200)
