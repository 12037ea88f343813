"""Known answers in whatever form somebody has them: numbers, a table, the result of a long run."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from uqfold.checks import listed, plain, real, refused, whole
from uqfold.problems.criterion import Binomial, Criteria, Criterion, Missions
from uqfold.problems.reference import Reference, ReferenceTable

ReferenceLike: TypeAlias = ReferenceTable | float | Iterable[float] | Mapping[Any, Any] | Any
"""What `reference_table` takes."""

_NORMAL_95 = 1.959963984540054
_REMEDY = (
    "give a failure probability (one for each criterion), a dict of threshold -> pf or (pf, "
    "std_error), a result, or a frame with the columns threshold and pf"
)
_NUMBERS = (
    "threshold", "pf", "tau", "missions_planned", "missions_p", "std_error", "ci_low", "ci_high",
)  # fmt: skip
"""Columns of a frame that hold numbers; what is missing there is NaN."""


def reference_table(
    name: str, given: ReferenceLike, grid: Criteria | None, problem: str, system: str = ""
) -> ReferenceTable:
    """Return known answers as the table of references of a problem.

    Parameters
    ----------
    name
        What errors call the argument.
    given
        One failure probability for each criterion, as a number, a list or a series of pandas; a
        dict of threshold or `Criterion` -> pf or (pf, std_error), or such a series with an index
        of its own; the result of a run, or a frame with the columns ``threshold`` and ``pf``, and
        where they matter ``tau``, ``missions`` and ``std_error``. What states no standard error
        is taken as exact, unless a method found it.
    grid
        The criteria that numbers answer in turn; None where there are none.
    problem
        Name of the problem whose answers they are.
    system
        `Problem.system_digest` of it; empty: not compared.

    Raises
    ------
    TypeError, ValueError
        If it is nothing of that, a value is no probability, a criterion is answered twice, a
        method's answer states no error, there is no answer in it, or a result is of another
        problem, or of other inputs, units or structure.
    """
    if isinstance(given, ReferenceTable):
        return given
    if isinstance(given, os.PathLike) or (isinstance(given, str) and os.path.exists(given)):
        remedy = "read the records first, by uqfold.comparison.read_records(...)"
        raise refused(name, given, remedy, TypeError)
    kind, how = "value", "given by the caller"
    given = _without_index(given)
    if hasattr(given, "to_frame") or hasattr(given, "columns"):
        _check_question(name, given, problem, system)
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
        one = isinstance(given, str | bytes) or not isinstance(given, Iterable)
        values = (given,) if one else listed(name, given)
        if grid is None:
            raise refused(name, given, "numbers answer default_criteria=: give that too, or a dict")
        if len(values) != len(grid):
            raise refused(name, given, f"for {len(grid)} criteria {_REMEDY}")
        answers = [_answer(name, one, pf) for one, pf in zip(grid, values, strict=True)]
    if not answers:
        raise refused(name, given, f"it holds no answer: {_REMEDY}")
    entries = dict[Criterion, Reference]()
    for answer in answers:
        if answer.criterion in entries:
            raise ValueError(
                f"{name}: two answers for {answer.criterion}: give those of one method"
            )
        entries[answer.criterion] = answer
    return ReferenceTable(problem, kind, how, "", entries)


def _without_index(given: Any) -> Any:
    """Return a series of pandas as a list, or as a dict if its index is its own."""
    if not (hasattr(given, "index") and hasattr(given, "items")) or hasattr(given, "columns"):
        return given
    in_turn = type(given.index).__name__ == "RangeIndex"
    return given.tolist() if in_turn else dict(given.items())


def _check_question(name: str, given: Any, problem: str, system: str) -> None:
    """Refuse the result of another problem; one of an unknown problem is taken."""
    if getattr(given, "columns", None) is not None:
        return
    if (other := getattr(given, "problem", "")) not in ("", problem):
        raise ValueError(f"{name}: it answers problem {other!r}, not {problem!r}")
    if system and getattr(given, "system", "") not in ("", system):
        what = "inputs, units or structure differ"
        raise ValueError(f"{name}: it answers another problem {problem!r}: {what}")


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
    return Reference(criterion, pf, real(f"the std_error of {name}", value[1], at_least=0.0))


def _of_a_frame(name: str, frame: Any, problem: str) -> list[Reference]:
    columns = list(frame.columns)
    for column in ("threshold", "pf"):
        if columns.count(column) != 1:
            which = "no column" if column not in columns else "more than one column"
            raise refused(name, columns, f"it has {which} {column!r}: {_REMEDY}")
    kept = [one for one in (*_NUMBERS, "missions") if columns.count(one) == 1]
    other = set(frame["problem"] if "problem" in columns else ()) - {problem}
    if other:
        raise ValueError(f"{name}: it answers problem {min(map(str, other))!r}, not {problem!r}")
    rows = [
        {one: _cell(f"{name}: {one} of row {i}", one, row[one]) for one in kept}
        for i, row in enumerate(frame[kept].to_dict("records"))
    ]
    return [
        _answer(name, _criterion_of(name, row), (row["pf"], _error(name, row)))
        for row in rows
        if not math.isnan(row["pf"])
    ]


def _cell(name: str, column: str, value: Any) -> Any:
    """Return what stands in a cell of a frame; NaN for what is missing."""
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return math.nan
    return real(name, value, finite=False, nan=True) if column in _NUMBERS else plain(value)


def _criterion_of(name: str, row: Mapping[Any, Any]) -> Criterion:
    tau, planned = row.get("tau", math.nan), row.get("missions_planned", math.nan)
    missions: Missions
    if math.isnan(planned):
        given = row.get("missions", 1)
        digits = isinstance(given, str) and given.isdecimal()
        missions = whole(f"{name}: missions", int(given) if digits else given, at_least=1)
    else:
        missions = Binomial(planned, row.get("missions_p", math.nan))
    return Criterion(row["threshold"], None if math.isnan(tau) else tau, missions)


def _error(name: str, row: Mapping[Any, Any]) -> float:
    """Return the stated standard error; where there is none, what an interval stands for."""
    error: float = row.get("std_error", 0.0)
    by_interval = (row.get("ci_high", math.nan) - row.get("ci_low", math.nan)) / (2.0 * _NORMAL_95)
    if error > 0.0 or (error == 0.0 and math.isnan(by_interval)):
        return error
    if math.isnan(by_interval):
        remedy = "it states no error, so it cannot be a reference: give a simulation, or its pf"
        raise refused(name, row["pf"], remedy)
    return float(by_interval)
