"""The contract suite: one small function for each promise that a reliability method makes.

`check_method(method)` runs them all on one method, and raises one `ContractError` with a line for
each promise that was broken. Checks of accuracy use `LinearNormalSystem`, whose answers are exact:
a method with a sampling error is judged in its own standard errors, one without a stated error
(``error_kind`` "none") to the relative tolerance that the caller names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from uqfold.checks import choice, instance, listed, or_none, real, several, whole
from uqfold.methods.base import ReliabilityMethod
from uqfold.testing import accuracy, conduct, hard_cases
from uqfold.testing.verdict import ContractError, Settings

__all__ = ["CHECKS", "ContractError", "check_method"]

Check = Callable[[ReliabilityMethod, Settings], None]


def _collected() -> dict[str, Check]:
    checks: dict[str, Check] = {}
    for module in (conduct, hard_cases, accuracy):
        for name, value in vars(module).items():
            if name.startswith("check_"):
                checks[name.removeprefix("check_")] = value
    return checks


CHECKS: dict[str, Check] = _collected()
"""Every check by name, in the order in which they run."""


def check_method(
    method: ReliabilityMethod,
    *,
    only: Iterable[str] | None = None,
    except_for: Iterable[str] = (),
    tolerance: float = 0.03,
    max_evals: int = 60_000,
) -> list[str]:
    """Run the contract on one method.

    Parameters
    ----------
    method
        The method, with whatever settings it is meant to be judged by.
    only, except_for
        Names of checks (keys of `CHECKS`) to run, or to leave out for a reason that the caller
        states next to the call.
    tolerance
        Relative error allowed where the method states no error of its own.
    max_evals
        Budget for the checks of accuracy.

    Returns
    -------
    list[str]
        Names of the checks that ran, all of them passed.

    Raises
    ------
    ContractError
        If promises are broken, with a line for each: the check, and what it saw where.
    ValueError
        If a name is not that of a check.
    """
    instance("method", method, (ReliabilityMethod,), "give a method built from its class")
    chosen = or_none("only", only, several, choice, CHECKS)
    selected = list(CHECKS) if chosen is None else list(chosen)
    left_out = {
        choice(f"except_for[{i}]", name, CHECKS)
        for i, name in enumerate(listed("except_for", except_for, sets=True))
    }
    settings = Settings(
        tolerance=real("tolerance", tolerance, above=0.0, below=1.0),
        max_evals=whole("max_evals", max_evals, at_least=1),
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
