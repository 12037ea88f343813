"""Repeated answers to known questions: bias and scatter of a method, and whether it knows them.

Answers are pooled over criteria whose references lie in the same decade, and over seeds. Errors
are relative to the reference (Eq. 49, with its sign).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance, whole

if TYPE_CHECKING:
    import pandas as pd

GROUP = ("problem", "label", "max_evals", "synchronized", "decade")
"""Columns that `benchmark_summary` groups by."""
NEEDS = (
    "problem", "label", "max_evals", "threshold", "tau", "missions", "seed", "pf", "std_error",
    "ci_low", "ci_high", "status", "n_evals", "reference_pf", "reference_std_error",
)  # fmt: skip
"""Columns that it reads."""
RESOLUTION = 0.5
"""A reference whose own error exceeds this share of the error found says too little of it."""


def benchmark_summary(frame: pd.DataFrame, units: dict[str, int]) -> pd.DataFrame:
    """Summarise repeated runs of methods against their references.

    Parameters
    ----------
    frame
        Rows of comparisons, with a column ``max_evals`` for the budget of the run.
    units
        Number of units of each problem: what one system costs crude Monte Carlo per mission.

    Returns
    -------
    pandas.DataFrame
        One row per `GROUP`, ``decade`` being the exponent d with 10^d < reference <= 10^(d + 1):

        ``answers``, ``runs``
            Rows with an answer, and rows in all.
        ``n_evals``
            Mean number of evaluations of a run, which answers all criteria of its grid.
        ``bias``, ``bias_error``
            Mean relative error, and its standard error over seeds (NaN with one seed).
        ``rms``
            Root mean square of the relative error.
        ``coverage``
            Share of intervals that hold the reference; NaN without intervals.
        ``error_ratio``
            Root mean square of the error over the stated one (joined with the reference's own); 1
            is right, above 1 overconfident.
        ``monte_carlo_rms``
            Relative standard error of crude Monte Carlo with the runs used.
        ``efficiency``
            (monte_carlo_rms / rms)^2: how many times the runs crude Monte Carlo would need.
        ``judged``
            Whether the reference is sharp enough to judge the error found.
    """
    import pandas as pd

    instance("frame", frame, pd.DataFrame, "give rows of uqfold.compare")
    missing = [name for name in NEEDS if name not in frame.columns]
    if missing:
        raise ValueError(f"the frame has no column {missing[0]!r}: give rows of uqfold.compare")
    instance("units", units, (Mapping,), "give a dict of problem -> number of units")
    units = {name: whole(f"units[{name!r}]", number, at_least=1) for name, number in units.items()}
    unknown = sorted(set(frame["problem"]) - set(units))
    if unknown:
        raise ValueError(f"units = {units!r}: give the number of units of {unknown[0]!r} too")
    known = frame[frame["reference_pf"] > 0.0].copy()
    known["synchronized"] = known["tau"].notna()
    known["decade"] = np.ceil(np.log10(known["reference_pf"])).astype(int) - 1
    rows = [
        {**dict(zip(GROUP, key, strict=True)), **_summary(own, units[key[0]])}
        for key, own in known.groupby(list(GROUP), sort=False)
    ]
    return pd.DataFrame(rows)


def _summary(rows: pd.DataFrame, units: int) -> dict[str, Any]:
    answered = rows[rows["pf"].notna()]
    pf, reference = answered["pf"], answered["reference_pf"]
    own_error, stated_error = answered["reference_std_error"], answered["std_error"]
    error = pf / reference - 1.0
    rms = _rms(error)
    ratio = (pf - reference) / np.hypot(stated_error, own_error)
    intervals = answered.dropna(subset=["ci_low", "ci_high"])
    slack = 2.0 * intervals["reference_std_error"]
    inside = (intervals["reference_pf"] >= intervals["ci_low"] - slack) & (
        intervals["reference_pf"] <= intervals["ci_high"] + slack
    )
    systems = answered["n_evals"] / (units * answered["missions"].map(_mean_missions).astype(float))
    simple = _rms(np.sqrt((1.0 - reference) / (reference * systems)))
    return {
        "answers": len(answered),
        "runs": len(rows),
        "n_evals": answered["n_evals"].mean(),
        "bias": error.mean(),
        "bias_error": error.groupby(answered["seed"]).mean().sem(),
        "rms": rms,
        "coverage": inside.mean(),
        "error_ratio": _rms(ratio[stated_error > 0.0]),
        "monte_carlo_rms": simple,
        "efficiency": math.inf if rms == 0.0 else (simple / rms) ** 2,
        "judged": bool(_rms(own_error / reference) <= RESOLUTION * rms),
    }


def _rms(values: pd.Series) -> float:
    """Root mean square; NaN of nothing."""
    return math.sqrt(values.pow(2).mean())


def _mean_missions(missions: str) -> float:
    """Mean number of missions of a profile as records write it: ``5``, or ``binomial(10, 0.7)``."""
    if missions.isdecimal():
        return float(missions)
    planned, p = missions.removeprefix("binomial(").removesuffix(")").split(",")
    return float(planned) * float(p)
