"""Known answers in whatever form somebody has them: numbers, a table, the result of a long run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from uqfold.checks import listed, real, refused, whole
from uqfold.problems.criterion import Binomial, Criteria, Criterion, Missions
from uqfold.problems.reference import Reference, ReferenceTable

ReferenceLike: TypeAlias = ReferenceTable | float | Iterable[float] | Mapping[Any, Any] | Any
"""What `reference_table` takes."""

_NORMAL_95 = 1.959963984540054
_REMEDY = (
    "give a failure probability (one for each criterion), a dict of threshold -> pf or (pf, "
    "std_error), a result, or a frame with the columns threshold and pf"
)


def reference_table(
    name: str, given: ReferenceLike, grid: Criteria | None, problem: str
) -> ReferenceTable:
    """Return known answers as the table of references of a problem.

    Parameters
    ----------
    name
        What errors call the argument.
    given
        One failure probability for each criterion; a dict of threshold or `Criterion` -> pf or
        (pf, std_error); the result of a run, or a frame with the columns ``threshold`` and ``pf``,
        and where they matter ``tau``, ``missions`` and ``std_error``. What states no standard
        error is taken as exact, unless a method found it.
    grid
        The criteria that numbers answer in turn; None where there are none.
    problem
        Name of the problem.

    Raises
    ------
    TypeError, ValueError
        If it is nothing of that, a value is no probability, a criterion is answered twice, a
        method's answer states no error, or a comparison is of another problem.
    """
    if isinstance(given, ReferenceTable):
        return given
    kind, how = "value", "given by the caller"
    if hasattr(given, "to_frame") or hasattr(given, "columns"):
        frame: Any = given if hasattr(given, "columns") else given.to_frame()
        answers = _of_a_frame(name, frame, problem)
        told = {"method", "n_evals", "seed"} <= set(frame.columns)
        if told and frame["method"].nunique() == 1:
            run = frame.iloc[0]
            kind, how = "method", f"{run['method']}, {run['n_evals']:,} runs, seed {run['seed']}"
    elif isinstance(given, Mapping):
        answers = [
            _answer(f"{name}[{key!r}]", _criterion(name, key), value)
            for key, value in given.items()
        ]
    else:
        values = listed(name, given) if isinstance(given, Iterable) else (given,)
        if grid is None:
            raise refused(name, given, "numbers answer default_criteria=: give that too, or a dict")
        if len(values) != len(grid):
            raise refused(name, given, f"for {len(grid)} criteria {_REMEDY}")
        answers = [_answer(name, one, pf) for one, pf in zip(grid, values, strict=True)]
    entries = dict[Criterion, Reference]()
    for one in answers:
        if one.criterion in entries:
            raise ValueError(f"{name}: two answers for {one.criterion}: give those of one method")
        entries[one.criterion] = one
    return ReferenceTable(problem, kind, how, "", entries)


def _criterion(name: str, key: Any) -> Criterion:
    if isinstance(key, Criterion):
        return key
    return Criterion(real(f"a key of {name}", key, finite=False, what="threshold or Criterion"))


def _answer(name: str, criterion: Criterion, value: Any) -> Reference:
    """Return a value, pf or (pf, std_error), as the answer to a criterion."""
    if not isinstance(value, tuple):
        value = (value, 0.0)
    if len(value) != 2:
        raise refused(name, value, _REMEDY)
    pf = real(name, value[0], at_least=0.0, at_most=1.0, what="probability")
    return Reference(criterion, pf, value[1])


def _of_a_frame(name: str, frame: Any, problem: str) -> list[Reference]:
    for column in ("threshold", "pf"):
        if column not in frame.columns:
            raise refused(name, list(frame.columns), f"it has no column {column!r}: {_REMEDY}")
    other = set(frame.get("problem", ())) - {problem}
    if other:
        raise ValueError(f"{name}: it answers problem {min(other)!r}, not {problem!r}")
    return [
        _answer(name, _criterion_of(row), (row["pf"], _error(name, row)))
        for row in frame.to_dict("records")
        if not math.isnan(row["pf"])
    ]


def _criterion_of(row: Mapping[Any, Any]) -> Criterion:
    tau, planned = row.get("tau", math.nan), row.get("missions_planned", math.nan)
    missions: Missions
    if math.isnan(planned):
        missions = whole("missions", float(row.get("missions", 1)), at_least=1)
    else:
        missions = Binomial(planned, row["missions_p"])
    return Criterion(row["threshold"], None if math.isnan(tau) else tau, missions)


def _error(name: str, row: Mapping[Any, Any]) -> float:
    """Return the stated standard error; where there is none, what an interval stands for."""
    error = float(row.get("std_error", 0.0))
    by_interval = (row.get("ci_high", math.nan) - row.get("ci_low", math.nan)) / (2.0 * _NORMAL_95)
    if error > 0.0 or (error == 0.0 and math.isnan(by_interval)):
        return error
    if math.isnan(by_interval):
        remedy = "it states no error, so it cannot be a reference: give a simulation, or its pf"
        raise refused(name, row["pf"], remedy)
    return float(by_interval)
