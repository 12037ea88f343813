"""What a row of a benchmark can hold: a damaged or invented one is refused by its first field."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, TypeVar, get_args

from uqfold.checks import LARGEST_WHOLE, choice, real, refused, text, whole
from uqfold.comparison.columns import relative_error
from uqfold.methods.result import NO_ANSWER, STATUSES, ErrorKind
from uqfold.problems.criterion import Binomial, Criterion

Row = TypeVar("Row", bound=Mapping[Any, Any])
_SLACK = 1e-9
"""Of numbers that follow from each other: they may have been written with fewer digits."""
_PROBABILITIES = ("pf", "reliability", "pf_low", "pf_high", "ci_low", "ci_high", "reference_pf")
_SIZES = ("std_error", "reference_std_error", "error")
_COUNTS = ("n_evals", "n_evals_row", "n_reused", "n_failed")


def possible_answer(row: Row) -> Row:
    """Return a row of a benchmark if a method could have given it.

    Raises
    ------
    ValueError, TypeError
        If a value is out of range, or contradicts another.
    """
    criterion = criterion_of(row)
    if str(criterion.missions) != row["missions"]:
        raise refused("missions", row["missions"], f"the profile is {criterion.missions}")
    for name in ("problem", "label", "method"):
        text(name, row[name], empty=name == "problem")
    choice("status", row["status"], STATUSES)
    choice("error_kind", row["error_kind"], get_args(ErrorKind))
    for name in _PROBABILITIES:
        real(name, row[name], at_least=0.0, at_most=1.0, nan=True, what="probability")
    for name in _SIZES:
        real(name, row[name], at_least=0.0, finite=False, nan=True)
    for name in _COUNTS:
        whole(name, row[name], at_least=0, at_most=LARGEST_WHOLE)
    for name in ("n_reused", "n_failed"):
        whole(name, row[name], at_most=row["n_evals"])
    real("seconds", row["seconds"], at_least=0.0)
    if row["seed"] < 0:
        raise refused("seed", row["seed"], "give a whole number >= 0")
    whole("inputs", row["inputs"], at_least=1)
    real("max_evals", row["max_evals"], at_least=1.0, finite=False)
    _agree(row)
    return row


def _agree(row: Mapping[str, Any]) -> None:
    """Refuse what contradicts something else in the row."""
    pf, status = row["pf"], row["status"]
    if math.isnan(pf) != (status in NO_ANSWER):
        raise refused("pf", pf, f"it does not go with the status {status!r}")
    for low, high in (("ci_low", "ci_high"), ("pf_low", "pf"), ("pf", "pf_high")):
        if row[low] > row[high] + _SLACK:
            raise refused(low, row[low], f"it is above {high} = {row[high]!r}")
    if abs(pf + row["reliability"] - 1.0) > _SLACK:
        raise refused("reliability", row["reliability"], f"it is not 1 - pf, with pf = {pf!r}")
    error = relative_error(pf, row["reference_pf"])
    if math.isnan(error) != math.isnan(row["error"]) or abs(row["error"] - error) > max(
        1e-6 * error, _SLACK
    ):
        raise refused("error", row["error"], f"that of pf against reference_pf is {error!r}")
    known = not math.isnan(row["ci_low"] + row["ci_high"] + row["reference_pf"])
    if known != (row["covered"] is not None):
        raise refused("covered", row["covered"], "it goes with an interval and a reference")


def criterion_of(row: Mapping[Any, Any]) -> Criterion:
    """Return the criterion that a row answers."""
    missions: Any = row["missions"]
    if not math.isnan(row["missions_planned"]):
        missions = Binomial(row["missions_planned"], row["missions_p"])
    elif missions.isdecimal():
        missions = int(missions)
    else:
        raise refused("missions", missions, "give a whole number, or missions_planned")
    return Criterion(row["threshold"], None if math.isnan(row["tau"]) else row["tau"], missions)
