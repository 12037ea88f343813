"""The contract suite: one small function for each promise that a reliability method makes.

`check_method(method)` runs them all on one method, and raises one `ContractError` with a line for
each promise that was broken: the check, the criterion, the status and what it saw. Level ``full``
goes through all systems, structures, criteria and seeds; ``quick`` asks for each promise once, in
the cheapest way that can still show a breach, for a run after every change. Checks of accuracy use
`LinearNormalSystem`, whose answers are exact: a method with a sampling error is judged in its own
standard errors, one without a stated error (``error_kind`` "none") to the relative tolerance that
the caller names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from uqfold.checks import choice, instance, listed, or_none, real, several, whole
from uqfold.methods.base import ReliabilityMethod
from uqfold.testing import accuracy, conduct, hard_cases, honesty, invariance
from uqfold.testing.verdict import ContractError, Level, Settings

__all__ = ["CHECKS", "ContractError", "check_method"]

Check = Callable[[ReliabilityMethod, Settings], None]


def _collected() -> dict[str, Check]:
    checks: dict[str, Check] = {}
    for module in (conduct, hard_cases, accuracy, invariance, honesty):
        for name, value in vars(module).items():
            if name.startswith("check_"):
                checks[name.removeprefix("check_")] = value
    return checks


BUDGETS: dict[Level, int] = {"quick": 6_000, "full": 60_000}
"""Budget of the checks of accuracy, by level."""
CHECKS: dict[str, Check] = _collected()
"""Every check by name, in the order in which they run."""


def check_method(
    method: ReliabilityMethod,
    level: Level = "full",
    *,
    only: Iterable[str] | None = None,
    except_for: Iterable[str] = (),
    tolerance: float = 0.03,
    max_evals: int | None = None,
) -> list[str]:
    """Run the contract on one method.

    Parameters
    ----------
    method
        The method, with whatever settings it is meant to be judged by.
    level
        ``full``, or ``quick``: every promise, each with as little as can show that it is broken.
    only, except_for
        Names of checks (keys of `CHECKS`) to run, or to leave out for a reason that the caller
        states next to the call.
    tolerance
        Relative error allowed where the method states no error of its own.
    max_evals
        Budget for the checks of accuracy; None: 60,000 runs at level ``full``, 6,000 at ``quick``.

    Returns
    -------
    list[str]
        Names of the checks that ran, all of them passed.

    Raises
    ------
    ContractError
        If promises are broken, with a line for each: the check, and what it saw where.
    ValueError
        If the level or a check is unknown.
    """
    instance("method", method, (ReliabilityMethod,), "give a method built from its class")
    chosen = or_none("only", only, several, choice, CHECKS)
    selected = list(CHECKS) if chosen is None else list(chosen)
    left_out = {
        choice(f"except_for[{i}]", name, CHECKS)
        for i, name in enumerate(listed("except_for", except_for, sets=True))
    }
    choice("level", level, BUDGETS)
    budget = or_none("max_evals", max_evals, whole, at_least=1)
    settings = Settings(
        level,
        tolerance=real("tolerance", tolerance, above=0.0, below=1.0),
        max_evals=BUDGETS[level] if budget is None else budget,
    )
    ran = [name for name in selected if name not in left_out]
    broken = []
    for name in ran:
        try:
            CHECKS[name](method, settings)
        except ContractError as error:
            broken.append(f"{name}: {error}")
    if broken:
        raise ContractError("\n".join(broken))
    return ran
