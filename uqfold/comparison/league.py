"""What the answers of a benchmark say of the methods, problem by problem and in all.

An answer is clean if it is ``converged``. It solves the problem if it is clean and right, its error
being at most `RIGHT_WITHIN` of pf; it is wrong if it is clean, not right, and more than
`WRONG_ERRORS` of its stated errors (joined with the reference's own) off.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.checks import instance
from uqfold.comparison.form import OF_BENCHMARK

if TYPE_CHECKING:
    import pandas as pd

RIGHT_WITHIN = 0.10
"""Relative error up to which an answer is right."""
WRONG_ERRORS = 3.0
USABLE_COV = 0.2
"""Intervals are judged where the stated error is below this part of pf."""
REFUTED_BELOW = 1e-3
"""Probability of as few covering intervals below which their level is refuted."""
INSTANCE = ["problem", "threshold", "tau", "missions", "inputs", "reference_pf"]
"""Columns that tell questions apart, and what is known of them."""


def problem_scores(frame: pd.DataFrame) -> pd.DataFrame:
    """Sum up the answers of each method to each question over the seeds.

    Parameters
    ----------
    frame
        Rows of `uqfold.benchmark`, all with one budget; those without a reference are left out.

    Returns
    -------
    pandas.DataFrame
        One row per problem, criterion and method: what `INSTANCE` tells of the question, and

        ``answers``, ``clean``, ``right``, ``solved``, ``wrong``, ``failed``, ``unsupported``
            Rows in all, and how many of them are what the words mean.
        ``bias``, ``rmse``
            Mean and root mean square of the relative error of the clean answers.
        ``usable``, ``covered``, ``coverage_p``
            Intervals whose stated error is below `USABLE_COV` of pf, how many hold the reference,
            and the probability of so few if each did with 95 % (one-sided binomial test).
        ``n_evals``, ``seconds``
            Medians over the answers with a number.
        ``cost``
            Median of the evaluations, those of an answer that does not solve being infinite.
    """
    return _summed(_judged(frame), [*INSTANCE, "label"])


def league_table(frame: pd.DataFrame) -> pd.DataFrame:
    """Sum up a benchmark: one row per method, those first that solve the most questions.

    Parameters
    ----------
    frame
        As for `problem_scores`.

    Returns
    -------
    pandas.DataFrame
        ``label`` and the columns of `problem_scores`, over all questions; ``questions``, those
        ``questions_solved`` with half of the seeds at least, and those on which the test of the
        intervals refutes them (``refuted``, at the level `REFUTED_BELOW`); ``coverage_p`` is the
        smallest of its probabilities.
    """
    rows, scores = _judged(frame), problem_scores(frame)
    of = scores.assign(
        questions_solved=np.isfinite(scores["cost"]), refuted=scores["coverage_p"] < REFUTED_BELOW
    ).groupby("label", sort=False)
    table = _summed(rows, ["label"]).set_index("label").drop(columns="cost")
    table["coverage_p"] = of["coverage_p"].min()
    table = table.assign(questions=of.size(), **of[["questions_solved", "refuted"]].sum())
    order = ["questions_solved", "wrong"]
    return table.sort_values(order, ascending=[False, True], kind="stable").reset_index()


def solving_costs(frame: pd.DataFrame) -> pd.DataFrame:
    """Return what it takes each method (columns) to solve each question (rows).

    Evaluations as ``cost`` in `problem_scores`, infinite where a method does not solve with half of
    the seeds; the index is `INSTANCE`, with an infinite ``tau`` for none.
    """
    # without a threshold on it the spread may be infinite
    scores = problem_scores(frame).fillna({"tau": math.inf})
    costs = scores.pivot(index=INSTANCE, columns="label", values="cost").fillna(math.inf)
    return costs[scores["label"].unique()]


def _summed(rows: pd.DataFrame, by: Sequence[str]) -> pd.DataFrame:
    import pandas as pd
    from scipy.stats import binom

    found = []
    for key, own in rows.groupby(by, sort=False, dropna=False):
        clean, answered = own[own["clean"]], own[own["pf"].notna()]
        error = clean["pf"] / clean["reference_pf"] - 1.0
        held = own.loc[own["usable"], "covered"]
        p = binom.cdf(held.sum(), len(held), 0.95) if len(held) else math.nan
        found.append(
            dict(zip(by, key, strict=True))
            | {"answers": len(own)}
            | {name: int(own[name].sum()) for name in ("clean", "right", "solved", "wrong")}
            | {name: int((own["status"] == name).sum()) for name in ("failed", "unsupported")}
            | {"bias": error.mean(), "rmse": math.sqrt((error**2).mean())}
            | {"usable": len(held), "covered": int(held.sum()), "coverage_p": p}
            | {name: answered[name].median() for name in ("n_evals", "seconds")}
            | {"cost": own["n_evals"].where(own["solved"], math.inf).quantile(0.5, "lower")}
        )
    return pd.DataFrame(found)


def _judged(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with a reference, and what is said of each."""
    import pandas as pd

    instance("frame", frame, pd.DataFrame, "give rows of uqfold.benchmark")
    missing = [name for name in OF_BENCHMARK if name not in frame.columns]
    if missing:
        raise ValueError(f"frame has no column {missing[0]!r}: give rows of uqfold.benchmark")
    if len(budgets := frame["max_evals"].unique()) > 1:
        said = f"give one, as in frame[frame['max_evals'] == {budgets[0]:g}]"
        raise ValueError(f"frame has {len(budgets)} budgets: {said}")
    rows: pd.DataFrame = frame[frame["reference_pf"] > 0.0]
    if rows.empty:
        raise ValueError("frame has no row with a reference: give some")
    clean: Any = rows["status"] == "converged"
    right = rows["error"] <= RIGHT_WITHIN
    stated = np.hypot(rows["std_error"].fillna(0.0), rows["reference_std_error"])
    off = (rows["pf"] - rows["reference_pf"]).abs() > WRONG_ERRORS * stated
    usable = rows["covered"].notna() & (rows["std_error"] < USABLE_COV * rows["pf"])
    more = {"clean": clean, "right": right, "usable": usable}
    return rows.assign(**more, solved=clean & right, wrong=clean & ~right & off)
