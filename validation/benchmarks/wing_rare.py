"""A rare failure of the folding wing under tau, by samplers on the mechanism and by surfaces.

    python -m validation.benchmarks.wing_rare [runs]

Example 3 with four wings over one mission, T = 0.60 s and tau = 0.073 s, fails about once in a
million. Subset simulation answers on the mechanism itself, with 400,000 deployments unless told
otherwise, and is set beside a Kriging surface and FFNI, whose answers need no sampling.
"""

import sys

import numpy as np

import uqfold
from uqfold.methods import FFNIPearson, Kriging, ReliabilityMethod, SubsetSimulation

ASKED = uqfold.Criterion(0.60, tau=0.073)


def answers(runs: int) -> dict[str, uqfold.ReliabilityResult]:
    """Return the answer of each method."""
    wing = uqfold.problems.folding_wing()
    asked: dict[str, tuple[ReliabilityMethod, int | None]] = {
        "subset-simulation": (SubsetSimulation(), runs),
        "kriging": (Kriging(), 400),
        "ffni-pearson": (FFNIPearson(), None),
    }
    return {
        name: method.estimate(wing, ASKED, max_evals=most, rng=1)
        for name, (method, most) in asked.items()
    }


def main(runs: int) -> None:
    """Print a row for each method."""
    found = answers(runs)
    sampled = found["subset-simulation"][0]
    print("| method | runs | pf | standard error | 95 % interval | off subset simulation |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, result in found.items():
        row = result[0]
        apart = (row.pf - sampled.pf) / np.hypot(row.std_error, sampled.std_error)
        print(
            f"| `{name}` | {row.n_evals:,} | {row.pf:.3g} | {row.std_error:.1g} "
            f"| {row.ci_low:.3g} to {row.ci_high:.3g} | {apart:+.1f} standard errors |"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 400_000)
