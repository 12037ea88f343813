"""Do the intervals of samplers of rare events hold? Prints a table of docs/rare-events.md.

    python -m validation.benchmarks.rare_events subset-simulation [seeds]

asks one method about limit states whose failure probability is known, with 1,000 seeds each unless
told otherwise: a quarter of an hour. Coverage is that of the rows with a stated error below a
fifth of pf; `p` is the probability of so few of them, were it 95 %.
"""

import math
import sys
from collections.abc import Callable, Iterator

import numpy as np
import openturns as ot
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri
from scipy.stats import binom, chi2, gamma

from uqfold.inputs import normal
from uqfold.methods import build
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

USABLE = 0.2
"""Coverage is judged where the stated error is below this part of pf."""
EXPONENTIALS_SEEDS = 5
"""Exponential inputs take the most time: one part in so many of the seeds."""

Height = Callable[[FloatArray], FloatArray]


def standard_normal(height: Height, dimension: int) -> Problem:
    """Return a height over independent standard-normal inputs as a problem."""
    return Problem(height, individual={f"u{i}": normal(0.0, 1.0) for i in range(dimension)})


def linear(u: FloatArray) -> FloatArray:
    """Return the sum of the inputs (n,), standardised."""
    return u.sum(axis=1) / math.sqrt(u.shape[1])


def parabola(u: FloatArray) -> FloatArray:
    """Return heights (n,) that bend towards failure."""
    return u[:, 0] + 0.15 * u[:, 1] ** 2


def parabola_pf(limit: float) -> float:
    """Failure probability of the parabola."""
    return integral(lambda w: float(ndtr(0.15 * w * w - limit)))


def branches(u: FloatArray) -> FloatArray:
    """Return heights (n,) of the series system with four branches."""
    v, w = (u[:, 0] + u[:, 1]) / math.sqrt(2.0), (u[:, 0] - u[:, 1]) / math.sqrt(2.0)
    return np.maximum(np.abs(v) - 3.0 - 0.2 * w * w, math.sqrt(2.0) * (np.abs(w) - 3.5))


def branches_pf(limit: float) -> float:
    """Failure probability of the four branches."""
    end = 3.5 + limit / math.sqrt(2.0)
    inner = quad(lambda w: density(w) * 2.0 * ndtr(-3.0 - limit - 0.2 * w * w), -end, end)[0]
    return float(inner + 2.0 * ndtr(-end))


def density(w: float) -> float:
    """Density of the standard normal law."""
    return math.exp(-0.5 * w * w) / math.sqrt(2.0 * math.pi)


def integral(value: Callable[[float], float]) -> float:
    """Return the mean of a function of one standard-normal variable."""
    return float(quad(lambda w: density(w) * value(w), -12.0, 12.0, epsabs=0.0, limit=400)[0])


def rising_and_jumping(u: FloatArray) -> FloatArray:
    """Return heights (n,) that rise towards 1 and jump beyond it where failure begins."""
    rising = u[:, 0] / (8.0 + np.abs(u[:, 0]))
    return np.where(u[:, 0] > -ndtri(1e-7), 10.0, rising)


def limit_states() -> Iterator[tuple[str, Problem, int, float, float, int]]:
    """Yield name, problem, inputs, limit, pf and runs of each."""
    for pf, runs in ((1e-2, 10_000), (1e-4, 30_000), (1e-6, 50_000), (1e-9, 100_000)):
        yield "linear", standard_normal(linear, 2), 2, -ndtri(pf), pf, runs
    yield "linear", standard_normal(linear, 10), 10, -ndtri(1e-6), 1e-6, 50_000
    yield "linear", standard_normal(linear, 100), 100, -ndtri(1e-4), 1e-4, 30_000
    chi_square = standard_normal(lambda u: (u * u).sum(axis=1), 100)
    yield "chi-square", chi_square, 100, chi2.isf(1e-4, 100), 1e-4, 30_000
    limit = brentq(lambda t: math.log(parabola_pf(t) / 1e-5), 2.0, 9.0)
    yield "parabola", standard_normal(parabola, 2), 2, limit, 1e-5, 40_000
    yield "four branches", standard_normal(branches, 2), 2, 1.5, branches_pf(1.5), 50_000
    both = standard_normal(lambda u: np.abs(u[:, 0]), 2)
    yield "two regions", both, 2, -ndtri(5e-7), 1e-6, 50_000
    yield "jump", standard_normal(rising_and_jumping, 2), 2, 1.0, 1e-7, 60_000
    inputs = {f"e{i}": ot.Exponential(1.0) for i in range(100)}
    exponentials = Problem(lambda x: x.sum(axis=1), individual=inputs)
    yield "exponentials", exponentials, 100, gamma.isf(1e-7, 100), 1e-7, 60_000


def main(method: str, seeds: int) -> None:
    """Print a row for each limit state."""
    columns = "limit state", "inputs", "pf", "runs", "seeds", "bias", "error", "stated", "covered"
    columns += "p", "converged", "off"
    print("| " + " | ".join(columns) + " |\n" + "| --- " * len(columns) + "|", flush=True)
    for name, problem, inputs, limit, pf, runs in limit_states():
        tried = seeds // EXPONENTIALS_SEEDS if name == "exponentials" else seeds
        rows = [
            build(method).estimate(problem, Criterion(float(limit)), max_evals=runs, rng=seed)[0]
            for seed in range(tried)
        ]
        ratio = np.array([row.pf for row in rows]) / pf
        stated = np.array([row.std_error for row in rows]) / pf / np.maximum(ratio, 1e-300)
        held = np.array([row.ci_low <= pf <= row.ci_high for row in rows])
        usable = stated < USABLE
        clean = np.array([row.status == "converged" for row in rows])
        off = clean & (np.abs(ratio - 1.0) > 0.1) & (np.abs(ratio - 1.0) > 3.0 * stated * ratio)
        n, k = int(usable.sum()), int(held[usable].sum())
        cells = (
            name,
            str(inputs),
            f"{pf:.2g}",
            f"{runs:,}",
            f"{tried:,}",
            f"{100.0 * (ratio.mean() - 1.0):+.1f} ± {100.0 * ratio.std() / math.sqrt(tried):.1f} %",
            f"{100.0 * math.sqrt(np.mean((ratio - 1.0) ** 2)):.1f} %",
            f"{100.0 * np.nanmedian(stated):.1f} %",
            f"{k} of {n}" if n else "",
            f"{binom.cdf(k, n, 0.95):.2g}" if n else "",
            str(int(clean.sum())),
            str(int(off.sum())),
        )
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1_000)
