"""The reference that a comparison is given: known answers to what is asked."""

from __future__ import annotations

import math
import os

from uqfold.checks import path, refused
from uqfold.comparison.columns import ATTRIBUTE
from uqfold.comparison.header import system_of
from uqfold.comparison.records import read_records
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion
from uqfold.problems.known_answers import ReferenceLike, reference_table
from uqfold.problems.reference import ReferenceTable

_NEAR = 1e-6
"""Two thresholds that differ by less are meant to be the same one."""


def given_references(given: ReferenceLike, grid: Criteria, problem: Problem) -> ReferenceTable:
    """Return known answers as a table of references, at least one of them to a criterion asked.

    Parameters
    ----------
    given
        As `uqfold.compare` takes it: what `reference_table` does, or where records lie.
    grid
        What is asked.
    problem
        Of which problem.

    Raises
    ------
    TypeError, ValueError
        If they are not known answers, are of another system, or answer nothing that is asked; or
        if one answers nearly what is asked, since nothing is interpolated.
    OSError
        If records cannot be opened.
    """
    if isinstance(given, str | os.PathLike):
        file = path("reference", given)
        if not file.exists():
            remedy = "there is no such file: give the path of records, or failure probabilities"
            raise refused("reference", given, remedy)
        given = read_records(file)
    header = getattr(given, "attrs", {}).get(ATTRIBUTE)
    if header is not None and header.get("system") not in (None, system_of(problem)):
        what = "inputs, units or structure differ"
        raise ValueError(f"reference: it answers another problem {problem.name!r}: {what}")
    if isinstance(given, ReferenceTable) and given.problem not in ("", problem.name):
        raise ValueError(f"reference: it answers problem {given.problem!r}, not {problem.name!r}")
    table = reference_table("reference", given, grid, problem.name, problem.system_digest)
    for one in grid:
        near = [known for known in table.entries if one != known and _nearly_same(one, known)]
        if near and table.lookup(one) is None:
            told = f"it knows T = {near[0].threshold!r}, and T = {one.threshold!r} is asked"
            raise ValueError(f"reference: {told}: give the same number, nothing is interpolated")
    if not any(map(table.lookup, grid)):
        known = "; ".join(map(_exact, table.entries))
        asked = "; ".join(map(_exact, grid))
        raise ValueError(f"reference: it knows {known}, none of which is asked: {asked}")
    return table


def _nearly_same(one: Criterion, other: Criterion) -> bool:
    alike = (one.tau, one.missions) == (other.tau, other.missions)
    return alike and math.isclose(one.threshold, other.threshold, rel_tol=_NEAR)


def _exact(criterion: Criterion) -> str:
    """Return a criterion as text, with all digits of its threshold where some are missing."""
    text, threshold = str(criterion), criterion.threshold
    rounded = float(f"{threshold:g}") != threshold and text.startswith("T = ")
    return text.replace(f"T = {threshold:g}", f"T = {threshold!r}", 1) if rounded else text
