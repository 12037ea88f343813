"""What members of FFNI make of few runs: prints two tables of docs/ffni.md.

    python -m validation.benchmarks.ffni_members

First Example 1 at pf = 1.25e-6, then three nodes for each shared input as they are, and mended by
two more on each of their lines; all without the check. Less than a minute.
"""

from functools import partial

from uqfold.methods import (
    FFNI,
    DimensionReduction,
    FFNISaddlepoint,
    FullFactorial,
    GaussOuter,
    RefinedOuter,
    SparseGrid,
)
from uqfold.problems import folding_wing_random_lengths, four_bar, series
from uqfold.problems.criterion import Criterion

RARE = Criterion(7.5)
FAMILIES = "saddlepoint", "saddlepoint-6", "maximum-entropy", "pearson", "cubic-normal"
OUTER = RefinedOuter(nodes=3, most=3)
MEMBERS = {
    "FFNISaddlepoint()": FFNISaddlepoint(check=False),
    **{
        f"FFNI.mended({name!r})": FFNI(FullFactorial(5), name, OUTER, check=False)
        for name in FAMILIES
    },
    "FFNI(DimensionReduction(1))": FFNI(DimensionReduction(1), check=False),
}
MENDED = {
    "Example 1": (series, Criterion(6.0), FullFactorial(5)),
    "Example 2, crossed": (partial(four_bar, "crossed"), Criterion(-137.0), FullFactorial(5)),
    "Example 6": (folding_wing_random_lengths, Criterion(0.39), SparseGrid(2)),
}


def main() -> None:
    """Print both tables."""
    problem = series()
    truth = problem.references.lookup(RARE).pf
    print(f"Example 1, pf = {truth:.3g}\n\n| member | runs | error |\n| --- | --- | --- |")
    for name, member in MEMBERS.items():
        row = member.estimate(problem, RARE)[0]
        print(f"| `{name}` | {row.n_evals} | {row.pf / truth - 1.0:+.1%} |", flush=True)
    print("\n| | runs | mended | pf | error before | after |\n" + "| --- " * 6 + "|")
    for name, (example, criterion, inner) in MENDED.items():
        problem = example()
        known = problem.references and problem.references.lookup(criterion)
        many = FFNI(inner, "cubic-normal", GaussOuter(9), check=False)
        truth = known.pf if known else many.estimate(problem, criterion)[0].pf
        rows = [
            FFNI(inner, "cubic-normal", outer, check=False).estimate(problem, criterion)[0]
            for outer in (GaussOuter(3), OUTER)
        ]
        errors = " | ".join(f"{row.pf / truth - 1.0:+.2%}" for row in rows)
        runs = " | ".join(f"{row.n_evals}" for row in rows)
        print(f"| {name} | {runs} | {truth:.2g} | {errors} |", flush=True)


if __name__ == "__main__":
    main()
