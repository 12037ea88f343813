"""Do samplers lose regions of failure? Prints a row on random unions for docs/rare-events.md.

    python -m validation.benchmarks.unions importance-sampling [runs] [unions]

asks one method, with 25,000 runs each unless told otherwise, about 60 unions of two or three
regions in 2 to 40 standard-normal inputs, turned at random. Every region has inputs of its own, so
that pf follows from theirs: half-spaces, slabs, what lies beyond two parallel planes, balls,
outsides of balls, and what lies behind a parabola. They have 5 to 95 % of pf, which is between 1e-6
and 1e-3, and their responses rise at different rates, up to twice as steep as another.
"""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtri, ndtr, ndtri
from scipy.stats import ncx2, ortho_group

from uqfold.methods import build
from uqfold.problems import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray
from validation.benchmarks.rare_events import Height, integral, standard_normal

DIMENSIONS = (2, 3, 5, 10, 20, 40)
RAREST, COMMONEST = 1e-6, 1e-3
LEAST_PART = 0.05
STEEPEST = 2.0
OFF = 3.0
"""A converged answer is wrong if it is more than so many stated errors off, and 5 % of pf."""


@dataclass(frozen=True)
class Region:
    """A region of failure over inputs of its own.

    Attributes
    ----------
    inputs
        How many.
    height
        Leads to it from everywhere: positive within.
    """

    inputs: int
    height: Height


def half_space(pf: float, rng: np.random.Generator) -> Region:
    """Behind a plane."""
    beta = -float(ndtri(pf))
    return Region(1, lambda u: u[:, 0] - beta)


def slab(pf: float, rng: np.random.Generator) -> Region:
    """Between two parallel planes that lie behind each other."""
    near = -float(ndtri(pf)) - rng.uniform(0.05, 0.5)
    far = -float(ndtri(ndtr(-near) - pf))
    return Region(1, lambda u: 0.5 * (far - near) - np.abs(u[:, 0] - 0.5 * (near + far)))


def both_sides(pf: float, rng: np.random.Generator) -> Region:
    """Beyond two parallel planes on both sides of the origin."""
    beta = -float(ndtri(0.5 * pf))
    return Region(1, lambda u: np.abs(u[:, 0]) - beta)


def outside(pf: float, rng: np.random.Generator) -> Region:
    """Outside of a ball about the origin."""
    inputs = int(rng.integers(2, 4))
    radius = math.sqrt(float(chdtri(inputs, pf)))
    return Region(inputs, lambda u: np.linalg.norm(u, axis=1) - radius)


def ball(pf: float, rng: np.random.Generator) -> Region:
    """Within a ball that lies aside."""
    inputs, radius = int(rng.integers(2, 4)), rng.uniform(0.4, 1.5)

    def missed(away: float) -> float:
        return float(ncx2.logcdf(radius**2, inputs, away**2)) - math.log(pf)

    away = brentq(missed, 0.0, 8.0)
    centre = away * np.eye(1, inputs)
    return Region(inputs, lambda u: radius - np.linalg.norm(u - centre, axis=1))


def parabola(pf: float, rng: np.random.Generator) -> Region:
    """Behind a parabola that bends to or fro."""
    bend = rng.uniform(-0.15, 0.3)

    def missed(limit: float) -> float:
        return math.log(integral(lambda w: float(ndtr(-limit - bend * w * w))) / pf)

    limit = brentq(missed, 0.5, 9.0)
    return Region(2, lambda u: u[:, 0] - bend * u[:, 1] ** 2 - limit)


KINDS: tuple[Callable[[float, np.random.Generator], Region], ...] = (
    half_space, slab, both_sides, outside, ball, parabola,
)  # fmt: skip


def union(rng: np.random.Generator) -> tuple[Problem, float, int]:
    """Return a union of regions, its failure probability, and its inputs."""
    dimension = int(rng.choice(DIMENSIONS))
    pf = math.exp(rng.uniform(math.log(RAREST), math.log(COMMONEST)))
    parts: list[float] = []
    regions: list[Region] = []
    while len(parts) < 2 or sum(one.inputs for one in regions) > dimension:
        number = min(int(rng.integers(2, 4)), dimension)
        shares = rng.dirichlet(np.ones(number))
        if shares.min() < LEAST_PART:
            continue
        # each fails on its own, and they are independent
        parts = [-math.expm1(share * math.log1p(-pf)) for share in shares]
        kinds = [KINDS[k] for k in rng.integers(len(KINDS), size=number)]
        regions = [kind(part, rng) for kind, part in zip(kinds, parts, strict=True)]
    slopes = STEEPEST ** rng.random(len(regions))
    turned = ortho_group.rvs(dimension, random_state=rng)
    first = np.cumsum([0, *(one.inputs for one in regions)])

    def height(u: FloatArray) -> FloatArray:
        v = u @ turned
        own = [
            slope * one.height(v[:, start : start + one.inputs])
            for slope, one, start in zip(slopes, regions, first, strict=False)
        ]
        return np.asarray(np.max(own, axis=0))

    return standard_normal(height, dimension), pf, dimension


def main(method: str, runs: int, unions: int) -> None:
    """Print how many answers are converged, and how many of them are wrong."""
    rows = []
    for seed in range(unions):
        problem, pf, dimension = union(np.random.default_rng(seed))
        row = build(method).estimate(problem, Criterion(0.0), max_evals=runs, rng=seed)[0]
        rows.append((row.status == "converged", row.pf / pf - 1.0, row.std_error / pf, dimension))
        if row.status == "converged" and _wrong(row.pf / pf - 1.0, row.std_error / pf):
            print(f"seed {seed}, {dimension} inputs, pf {pf:.3g}: {row.pf / pf:.3f} of it",
                  file=sys.stderr)  # fmt: skip
    print("| method | runs | unions | converged | wrong | largest error | in stated errors |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    sure = [(off, stated) for converged, off, stated, _ in rows if converged]
    wrong = sum(_wrong(off, stated) for off, stated in sure)
    largest = max((abs(off) for off, _ in sure), default=math.nan)
    errors = max((abs(off) / stated for off, stated in sure), default=math.nan)
    cells = method, f"{runs:,}", str(unions), str(len(sure)), str(wrong)
    print("| " + " | ".join((*cells, f"{100.0 * largest:.1f} %", f"{errors:.1f}")) + " |")


def _wrong(off: float, stated: float) -> bool:
    return abs(off) > max(0.05, OFF * stated)


if __name__ == "__main__":
    given = [int(one) for one in sys.argv[2:]]
    main(sys.argv[1], *given, *(25_000, 60)[len(given) :])
