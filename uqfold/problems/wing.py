"""The folding-wing system, and the one whose arms have random lengths.

Four wings fold out side by side. Each must reach its lock before the threshold T, and under a
synchronization threshold tau the first and the last may not lie further apart than that. Flight
speed and pitch angle are one draw for the vehicle and stay the same over its missions; drive
force, wing thickness and joint clearance are drawn anew for every wing and every mission, since
the mechanisms are replaced after each flight. The lengths of crank and rod may be random as well.

- `folding_wing()`: section 4.3, Table 6. Its references come from simulation of the same mechanism.
  Any mean or standard deviation can be changed, as sections 4.4 and 4.5 do:
  `folding_wing(means={"V_q": 100.0})`.
- `folding_wing_random_lengths()`: section 4.6, Table 10.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import instance, mapping, or_none, real, refused
from uqfold.inputs import normal
from uqfold.lazy import former
from uqfold.mechanism import WingParameters
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, criteria
from uqfold.problems.deployment_time import (
    INPUT_UNITS,
    DeploymentTime,
    IdealDeploymentTime,
    in_si,
    version_of,
)
from uqfold.problems.reference import load_references

InputTable: TypeAlias = Mapping[str, tuple[float, float]]
"""Input -> (mean, standard deviation), in `INPUT_UNITS`."""

SHARED = ("V_q", "delta")

TABLE_6: InputTable = {
    "V_q": (140.0, 10.0),
    "delta": (0.0, 5.0),
    "k_d": (550.0, 10.0),
    "b": (7.0, 0.25),
    "C_r": (1.5, 0.05),
}
TABLE_10: InputTable = {
    "V_q": (200.0, 25.0),
    "delta": (0.0, 25.0),
    "k_d": (1100.0, 10.0),
    "b": (6.0, 0.25),
    "C_r": (1.5, 0.05),
    "l_1": (1500.0, 2.0),
    "l_2": (1300.0, 2.0),
}

DEFAULT_THRESHOLDS = (0.545, 0.550, 0.555, 0.560, 0.565, 0.570)
DEFAULT_TAU = (None, 0.04)
RANDOM_LENGTHS_THRESHOLDS = (0.360, 0.365, 0.370, 0.375, 0.380, 0.385)
RANDOM_LENGTHS_TAU = (None, 0.025)

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        return former(__name__, name)


def folding_wing(
    parameters: WingParameters | None = None,
    *,
    means: Mapping[str, float] | None = None,
    standard_deviations: Mapping[str, float] | None = None,
) -> Problem:
    """Return the folding-wing system of Table 6, or one with other means and standard deviations.

    Parameters
    ----------
    parameters
        The mechanism; None takes Table 1. Its values of V_q, delta, k_d, b and C_r do not matter,
        since these five are the random inputs.
    means, standard_deviations
        Values in place of those of Table 6, by input name and in its unit (`INPUT_UNITS`).

    Returns
    -------
    Problem
        Four units; shared inputs V_q (m/s) and delta (deg), individual inputs k_d (N), b (mm) and
        C_r (mm); the response is the deployment time (s), +inf for a wing that never locks. Its
        low-fidelity partner is the wing with ideal joints, which takes no notice of C_r.
        References are attached only to
        the default mechanism under Table 6, default criteria only under Table 6.

    Raises
    ------
    ValueError
        If a name is not one of the inputs, a mean is not a possible value, or a standard deviation
        is not positive.
    TypeError
        If a value is not a number.

    Examples
    --------
    >>> folding_wing(means={"V_q": 100.0}).inputs.means[0].item()
    100.0
    """
    wing = _checked(parameters)
    table = _changed(TABLE_6, wing, means, standard_deviations)
    as_printed = table == TABLE_6
    return _problem(
        "folding-wing",
        wing,
        table,
        criteria(DEFAULT_THRESHOLDS, DEFAULT_TAU) if as_printed else None,
        references="folding_wing" if as_printed and wing == WingParameters() else None,
    )


def folding_wing_random_lengths(
    parameters: WingParameters | None = None,
    *,
    means: Mapping[str, float] | None = None,
    standard_deviations: Mapping[str, float] | None = None,
) -> Problem:
    """Return the folding-wing system of Table 10, whose arms have random lengths.

    Parameters
    ----------
    parameters
        The mechanism; None takes Table 1. Its values of the seven random inputs do not matter.
    means, standard_deviations
        Values in place of those of Table 10, by input name and in its unit (`INPUT_UNITS`).

    Returns
    -------
    Problem
        Four units; shared inputs V_q (m/s) and delta (deg), individual inputs k_d (N), b (mm),
        C_r (mm), l_1 (mm) and l_2 (mm); response and partner as in `folding_wing`. The full rule
        of the paper takes 28,125 = 3^2 * 5^5 runs. There are no references; default criteria
        belong to Table 10.

    Raises
    ------
    ValueError, TypeError
        As `folding_wing`.
    """
    wing = _checked(parameters)
    table = _changed(TABLE_10, wing, means, standard_deviations)
    return _problem(
        "folding-wing-random-lengths",
        wing,
        table,
        criteria(RANDOM_LENGTHS_THRESHOLDS, RANDOM_LENGTHS_TAU) if table == TABLE_10 else None,
        references=None,
    )


def _checked(parameters: WingParameters | None) -> WingParameters:
    wanted = "give WingParameters(...)"
    given = or_none("parameters", parameters, instance, WingParameters, wanted)
    return WingParameters() if given is None else given


def _changed(
    table: InputTable,
    wing: WingParameters,
    means: Mapping[str, float] | None,
    standard_deviations: Mapping[str, float] | None,
) -> InputTable:
    """Put the changed values into the table, if they are possible."""
    new_means = or_none("means", means, mapping, real) or {}
    new_deviations = (
        or_none("standard_deviations", standard_deviations, mapping, real, above=0.0) or {}
    )
    for argument, changes in (("means", new_means), ("standard_deviations", new_deviations)):
        unknown = [name for name in changes if name not in table]
        if unknown:
            raise refused(
                argument, changes, f"no input is named {unknown[0]!r}, only {', '.join(table)}"
            )
    changed = {
        name: (new_means.get(name, mean), new_deviations.get(name, deviation))
        for name, (mean, deviation) in table.items()
    }
    try:
        wing.replace(**{name: mean * in_si(name) for name, (mean, _) in changed.items()})
    except ValueError as error:
        raise ValueError(f"no wing can be built at the means of its inputs: {error}") from error
    return changed


def _problem(
    name: str,
    wing: WingParameters,
    table: InputTable,
    default: Criteria | None,
    *,
    references: str | None,
) -> Problem:
    marginals = {one: normal(*row) for one, row in table.items()}
    names = tuple(table)
    return Problem(
        DeploymentTime(wing, names),
        shared={one: marginals.pop(one) for one in SHARED},
        individual=marginals,
        units=4,
        low_fidelity=IdealDeploymentTime(wing, names),
        name=name,
        version=version_of(wing),
        response="deployment time",
        response_unit="s",
        input_units=[INPUT_UNITS[one] for one in names],
        default_criteria=default,
        references=None if references is None else load_references(references),
    )
