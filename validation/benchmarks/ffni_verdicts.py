"""How often the verdict of FFNI is right: prints the table of docs/ffni.md.

    python -m validation.benchmarks.ffni_verdicts

asks the paper's two methods and members of the family about the paper's examples, linear and
curved systems of several units, redundant units under one stress, the four-branch system and the
problems of the validation case "no false confidence"; some minutes. With ``--quick`` a few criteria
of each example are asked, and the wing about none.
"""

import math
import sys
from collections import Counter
from collections.abc import Iterator

import numpy as np

from uqfold.methods import (
    FFNI,
    DimensionReduction,
    FFNIPearson,
    FFNISaddlepoint,
    ReliabilityMethod,
    SparseGrid,
)
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems import Problem, folding_wing, four_bar, four_branch, series, stress_strength
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.testing.curved import CurvedSystem
from validation.no_false_confidence.problems import PROBLEMS

Truths = dict[Criterion, tuple[float, float]]
"""Smallest and largest exact pf of each criterion; they differ where runs fail."""
MOST_INPUTS = 7
EXAMPLES = (
    series,
    four_bar,
    lambda: four_bar("crossed"),
    four_branch,
    lambda: stress_strength(4, 1),
    lambda: stress_strength(4, 3),
    folding_wing,
)
CRITERIA_OF_EXAMPLE = 60
METHODS: dict[str, ReliabilityMethod] = {
    "FFNISaddlepoint()": FFNISaddlepoint(),
    "FFNIPearson()": FFNIPearson(),
    "FFNI.mended()": FFNI.mended(),
    "FFNI(DimensionReduction(1))": FFNI(DimensionReduction()),
    "FFNI(SparseGrid(2), 'pearson')": FFNI(SparseGrid(2), "pearson"),
}


def asked(quick: bool = False) -> Iterator[tuple[Problem, Truths]]:
    """Yield problems and what is known of them."""
    for example in EXAMPLES[:-1] if quick else EXAMPLES:
        problem = example()
        assert problem.references is not None
        known = [
            one
            for one in problem.references
            if one.std_error < 0.02 * one.pf and 1e-9 < one.pf < 0.999
        ]
        step = max(1, len(known) // (12 if quick else CRITERIA_OF_EXAMPLE))
        yield problem, {one.criterion: (one.pf, one.pf) for one in known[::step]}
    profiles = 1, 5, Binomial(4, 0.7)
    for units in (1, 3, 4, 20):
        for shared in (0.0, 0.3, 0.6, 0.8):
            system = LinearNormalSystem(units=units, shared_std=shared)
            spread = math.hypot(shared, system.individual_std)
            levels = [10.0 + far * spread for far in (0.5, 1.5, 2.5, 3.5, 4.5, 6.0)]
            grid = criteria(levels, tau=[None, 3.5], missions=profiles)
            yield system.problem(), {one: (system.pf(one),) * 2 for one in grid}
    system = LinearNormalSystem(units=20, mean=2.5, shared_std=0.6, individual_std=0.8)
    grid = criteria([2.5 + far for far in range(1, 8)])
    yield system.problem(), {one: (system.pf(one),) * 2 for one in grid}
    for units in (1, 2, 5):
        curved = CurvedSystem(units=units)
        levels = [10.5, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0]
        yield curved.problem(), {Criterion(level): (curved.pf(level),) * 2 for level in levels}
    for hard in PROBLEMS:
        if hard.d <= MOST_INPUTS:
            yield hard.problem(), {hard.criterion: (hard.least, hard.pf)}


def verdict(row: CriterionResult, low: float, high: float) -> tuple[str, str]:
    """Return the status of a row, and whether it is right.

    A converged row is wrong if it is more than three stated errors and 1 % off, any other one if
    it is more than 10 % off, in both of the smaller of pf and 1 - pf.
    """
    beyond = max(0.0, row.pf - high, low - row.pf)
    share = beyond / max(min(high, 1.0 - low), np.finfo(float).tiny)
    if row.status == "converged":
        return row.status, "wrong" if share > 0.01 and beyond > 3.0 * row.std_error else "right"
    return row.status, "wrong" if share > 0.1 else "right"


def measure(method: ReliabilityMethod, quick: bool) -> tuple[Counter[tuple[str, str]], float]:
    """Return how often each verdict was right, and the share of intervals that hold the truth."""
    counts: Counter[tuple[str, str]] = Counter()
    inside = []
    for problem, truths in asked(quick):
        for criterion, row in zip(truths, method.estimate(problem, [*truths]), strict=True):
            if row.status in NO_ANSWER:
                continue
            low, high = truths[criterion]
            found = verdict(row, low, high)
            counts[found] += 1
            if row.status == "converged":
                inside.append(row.ci_low <= high and low <= row.ci_high)
    return counts, float(np.mean(inside))


def main() -> None:
    """Print the table."""
    print("| method | converged: right | wrong | doubtful: right | wrong | intervals that hold |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, method in METHODS.items():
        counts, inside = measure(method, "--quick" in sys.argv)
        cells = [
            str(counts[status, verdict])
            for status in ("converged", "doubtful")
            for verdict in ("right", "wrong")
        ]
        print(f"| `{name}` | {' | '.join(cells)} | {100.0 * inside:.1f} % |", flush=True)


if __name__ == "__main__":
    main()
