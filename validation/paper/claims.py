"""The claims of the paper, in our words, and what judges them: tables of the studies.

Each claim is a function of all results (study -> table -> rows) that yields findings. A claim whose
results are missing cannot be judged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from uqfold.typing import FloatArray
from uqfold.validation import Claim, Finding

Results: TypeAlias = Mapping[str, Mapping[str, pd.DataFrame]]
"""Study -> table -> rows."""
Judge: TypeAlias = Callable[[Results], Iterable[Finding]]

IDENTITY = "an identity: every model keeps it, so it is no evidence"
"""Remark of a finding that follows from the algebra alone; a breach shows an error of ours."""
ROUNDING = 1e-9
"""Differences of reliabilities below it are none."""
STANDARD_ERRORS = 3.0
"""How far a simulation has to lie from an order to contradict it."""
NO_TAU = -1.0
NO_SYNC = {
    "example-1": ("no-sync",),
    "example-2": ("no-sync-open", "no-sync-crossed"),
    "example-3": ("no-sync",),
    "example-6": ("no-sync",),
}
"""Study -> tables of the paper's method without synchronization."""
SYNC = {
    study: tuple(table.removeprefix("no-") for table in tables) for study, tables in NO_SYNC.items()
}
"""The same with synchronization."""
BOTH = {study: NO_SYNC[study] + SYNC[study] for study in SYNC}
_AXES = ("problem", "label", "threshold", "tau", "missions")


@dataclass(frozen=True)
class PaperClaim:
    """A claim, and the function that judges it by the results."""

    said: Claim
    judge: Judge

    def findings(self, results: Results) -> list[Finding]:
        """Return what the results say; without them, a finding that cannot be judged."""
        try:
            found = list(self.judge(results))
        except MissingResultsError as error:
            found = [Finding(f"no results of {error}")]
        return [replace(one, claim=self.said.key) for one in found]

    def claim(self, findings: Iterable[Finding]) -> Claim:
        """Return the claim, marked where it holds by identities alone."""
        judged = [one for one in findings if one.verdict is not None]
        identity = all(one.verdict == "holds" and _is_identity(one) for one in judged)
        return replace(self.said, identity=bool(judged) and identity)


class MissingResultsError(LookupError):
    """A study has no results, or lacks a table."""


def claim(key: str, statement: str, source: str, rule: str) -> Callable[[Judge], PaperClaim]:
    """Make a claim of the function that judges it."""
    return lambda judge: PaperClaim(Claim(key, statement, source, rule), judge)


def _is_identity(finding: Finding) -> bool:
    return finding.remark.startswith(IDENTITY)


def table_of(results: Results, study: str, table: str) -> pd.DataFrame:
    """Return a table of a study.

    Raises
    ------
    MissingResultsError
        If there is none.
    """
    try:
        return results[study][table]
    except KeyError:
        raise MissingResultsError(f"{study}/{table}") from None


def tables_of(
    results: Results, wanted: Mapping[str, Iterable[str]]
) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield ``study/table`` and its rows, for all tables that are wanted."""
    for study, tables in wanted.items():
        for table in tables:
            yield f"{study}/{table}", table_of(results, study, table)


def fixed_missions(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with a fixed number of missions, as whole numbers."""
    own = frame[frame["missions"].str.isdecimal()]
    return own.assign(missions=own["missions"].astype(int))


def wide(frame: pd.DataFrame, column: str, values: str = "pf") -> pd.DataFrame:
    """Return one row per criterion and problem, one column per value of `column`, ascending."""
    rows = frame.assign(tau=frame["tau"].fillna(NO_TAU))
    index = [name for name in _AXES if name != column]
    return rows.pivot(index=index, columns=column, values=values).sort_index(axis=1)


def largest_rise(what: str, frame: pd.DataFrame, column: str) -> Finding:
    """Return the largest rise of R along a column, where no model can rise."""
    return Finding(f"largest rise of R {what}", _largest(frame, column), ROUNDING, remark=IDENTITY)


def largest_fall(what: str, frame: pd.DataFrame, column: str) -> Finding:
    """Return the largest fall of R along a column, where no model can fall."""
    fall = _largest(frame, column, -1.0)
    return Finding(f"largest fall of R {what}", fall, ROUNDING, remark=IDENTITY)


def _largest(frame: pd.DataFrame, column: str, sign: float = 1.0) -> float:
    """Largest change of R from each value of `column` to the next one."""
    return float(np.nanmax(-sign * wide(frame, column).diff(axis=1).iloc[:, 1:].to_numpy()))


def at_largest_threshold(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the largest T: the plateau."""
    return frame[frame["threshold"] == frame["threshold"].max()]


def spread(frame: pd.DataFrame, column: str, by: str) -> pd.Series[float]:
    """Return the largest range of R over a column, by another one in ascending order."""
    table = wide(frame, column)
    return (table.max(axis=1) - table.min(axis=1)).groupby(by).max().sort_index()


def advantage(frame: pd.DataFrame, first: str, second: str) -> pd.DataFrame:
    """Set the reliability of one problem against that of another, criterion by criterion.

    Returns
    -------
    pandas.DataFrame
        Columns ``threshold``, ``tau``, ``missions``, ``gain`` (R of the first less R of the
        second), ``relative`` (the same over the larger R, or over the larger pf where that is
        smaller) and ``error`` (joint standard error; NaN where none is stated), ordered by T.

    Raises
    ------
    ValueError
        If the table lacks a problem.
    """
    keys = ["threshold", "tau", "missions"]
    one, other = (of_problem(frame, name).fillna({"tau": NO_TAU}) for name in (first, second))
    both = one.merge(other, on=keys, suffixes=("", "_other"), validate="one_to_one")
    # from the side on which nothing cancels
    gain = np.where(
        both["pf"] > 0.5,
        both["reliability"] - both["reliability_other"],
        both["pf_other"] - both["pf"],
    )
    # gains of tiny reliabilities, and gains over tiny failure probabilities, count as well
    scale = np.minimum(
        both[["reliability", "reliability_other"]].max(axis=1),
        both[["pf", "pf_other"]].max(axis=1),
    )
    error = np.hypot(_error(both, ""), _error(both, "_other"))
    return (
        both[keys]
        .assign(gain=gain, relative=gain / scale, error=error)
        .sort_values(keys, ignore_index=True)
    )


def _error(frame: pd.DataFrame, suffix: str) -> FloatArray:
    """Return standard errors; of an estimate of 0 or 1 half the length of its interval."""
    half = 0.5 * (frame[f"ci_high{suffix}"] - frame[f"ci_low{suffix}"])
    return np.asarray(frame[f"std_error{suffix}"].fillna(half), dtype=np.float64)


def of_problem(frame: pd.DataFrame, problem: str) -> pd.DataFrame:
    """Return the rows of one problem.

    Raises
    ------
    ValueError
        If there are none.
    """
    rows = frame[frame["problem"] == problem]
    if rows.empty:
        raise ValueError(f"the table has no problem {problem!r}")
    return rows


def contradictions(what: str, gains: pd.DataFrame) -> Finding:
    """Count simulated gains that are negative by more than `STANDARD_ERRORS` of their errors."""
    known = gains[gains["error"] > 0.0]
    scores = known["gain"] / known["error"]
    clear = int((scores > STANDARD_ERRORS).sum())
    return Finding(
        f"simulated points against it, {what}",
        float((scores < -STANDARD_ERRORS).sum()),
        0.0,
        remark=f"{clear} of {len(known)} clearly for it (over {STANDARD_ERRORS:g} standard errors)",
    )


def widening(what: str, gaps: pd.Series[float]) -> Finding:
    """Return the largest widening of a gap as tau grows."""
    ends = ", ".join(f"{gaps.iloc[i]:.3g} at tau = {gaps.index[i]:g} s" for i in (0, -1))
    return Finding(
        f"largest widening of {what} as tau grows",
        float(gaps.diff().max()),
        0.0,
        remark=f"spread {ends}",
    )


def positive(what: str, value: Any, **more: Any) -> Finding:
    """Return a number that has to be positive."""
    return Finding(what, float(value), 0.0, at_least=True, **more)
