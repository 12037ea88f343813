"""How a check says that a promise was broken."""

from __future__ import annotations

from dataclasses import dataclass


class ContractError(AssertionError):
    """A method breaks the contract; the message says which promise and how."""


@dataclass(frozen=True)
class Settings:
    """Tolerance (relative, for methods that state no error) and budget of the accuracy checks."""

    tolerance: float
    max_evals: int


def demand(condition: bool, message: str) -> None:
    """Raise `ContractError` unless the condition holds (unlike ``assert``, also under ``-O``)."""
    if not condition:
        raise ContractError(message)
