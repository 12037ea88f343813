"""How biased is each method, how much does it scatter, and what does it cost?

Repeats every method on Example 1 over several seeds, at a small budget, and sets the answers
against the exact reference. See README.md beside this file.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

import uqfold

THRESHOLDS = (0.0, 2.0, 4.0)


def benchmark(seeds: int, max_evals: int, methods: Sequence[str] | None = None) -> pd.DataFrame:
    """Run every method once per seed (a method without randomness only once).

    Returns
    -------
    pandas.DataFrame
        The rows of `uqfold.compare` of all seeds; column ``seed`` tells them apart.
    """
    problem = uqfold.problems.series()
    grid = uqfold.criteria(threshold=THRESHOLDS)
    known = uqfold.methods.available()
    chosen = {name: uqfold.methods.build(name) for name in (methods or known)}
    random = {name: method for name, method in chosen.items() if method.stochastic}
    frames = [
        uqfold.compare(problem, repeated, grid, max_evals=max_evals, rng=seed)
        for seed in range(seeds)
        if (repeated := chosen if seed == 0 else random)
    ]
    return pd.concat(frames, ignore_index=True)


def summary(runs: pd.DataFrame) -> pd.DataFrame:
    """Summarise repeated runs by threshold and method.

    Returns
    -------
    pandas.DataFrame
        Number of runs with an answer; bias, its standard error and root mean square error of pf,
        all relative to the reference; share of intervals that cover the reference; mean number of
        evaluations of one criterion. NaN where a method has no interval, or only one run.
    """
    return (
        runs.groupby(["threshold", "label"], sort=False)
        .apply(_summary_of_one, include_groups=False)
        .reset_index()
        .sort_values("threshold", kind="stable", ignore_index=True)
    )


def _summary_of_one(runs: pd.DataFrame) -> pd.Series:
    answered = runs[runs["pf"].notna()]
    ratio = answered["pf"] / answered["reference_pf"] - 1.0
    n = len(answered)
    with_interval = answered[answered["ci_low"].notna()]
    covered = with_interval["reference_pf"].between(
        with_interval["ci_low"], with_interval["ci_high"]
    )
    return pd.Series(
        {
            "runs": n,
            "bias": ratio.mean(),
            "bias_std_error": ratio.std(ddof=1) / math.sqrt(n) if n > 1 else math.nan,
            "rmse": float(np.sqrt((ratio**2).mean())),
            "coverage": covered.mean() if len(covered) else math.nan,
            "n_evals_row": answered["n_evals_row"].mean(),
        }
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="repetitions (default: 20)")
    parser.add_argument("--max-evals", type=int, default=12_000, help="budget of one run")
    parser.add_argument("--method", action="append", help="method to run; may be repeated")
    parser.add_argument("--out", type=Path, help="folder for runs.csv and summary.csv")
    options = parser.parse_args(arguments)
    if options.seeds < 1:
        parser.error(f"--seeds {options.seeds}: give at least 1")
    runs = benchmark(options.seeds, options.max_evals, options.method)
    table = summary(runs)
    print(
        table.to_string(
            index=False,
            formatters={
                "runs": "{:.0f}".format,
                "bias": "{:+.1%}".format,
                "bias_std_error": "{:.1%}".format,
                "rmse": "{:.1%}".format,
                "coverage": "{:.0%}".format,
                "n_evals_row": "{:,.0f}".format,
            },
        )
    )
    if options.out is not None:
        options.out.mkdir(parents=True, exist_ok=True)
        runs.to_csv(options.out / "runs.csv", index=False)
        table.to_csv(options.out / "summary.csv", index=False)


if __name__ == "__main__":
    main()
