r"""What each method states of itself: its idea, its equations, and whom to cite.

A method names its `Theory` in the class attribute ``theory``; a comparison keeps it in its records,
and reports make their methods section from there. Equations are LaTeX; numbers in parentheses are
those of the folding-wing paper.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass


@dataclass(frozen=True)
class Equation:
    """One displayed equation.

    Attributes
    ----------
    lead
        The sentence that leads to it, without a full stop.
    latex
        The equation.
    source
        Where it stands, for instance ``Eq. (35)``; may be empty.
    """

    lead: str
    latex: str
    source: str = ""


@dataclass(frozen=True)
class Theory:
    """What a method is, for the methods section of a report.

    Attributes
    ----------
    summary
        A few sentences: what is done, what is assumed, what the stated error covers.
    equations
        In the order in which they are used.
    references
        Publications to cite.
    """

    summary: str = ""
    equations: tuple[Equation, ...] = ()
    references: tuple[str, ...] = ()

    @classmethod
    def of(cls, method: type) -> Theory:
        """Return what a method states of itself: its ``theory``, or else its docstring's start."""
        stated: Theory = getattr(method, "theory", cls())
        if stated.summary:
            return stated
        first = inspect.cleandoc(method.__doc__ or "").partition("\n\n")[0]
        return cls(" ".join(first.split()), stated.equations, stated.references)
