"""When active learning may stop: answers that stay, and a check that confirms the surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from uqfold.methods.active_check import Check
from uqfold.methods.active_view import View
from uqfold.typing import FloatArray

# Steps of learning over which answers have to stay the same.
_STEPS = 2


@dataclass
class Stability:
    """Stopping rule: reliability indices that neither move nor are uncertain.

    How far an index has moved is told by how far the surface has, where it matters: to first
    order in its change, without the noise of two separate integrations.

    Attributes
    ----------
    tolerance
        Largest change of an index over two steps of learning, and largest stated standard
        deviation.
    views
        What was seen, step by step.
    """

    tolerance: float
    views: list[View] = field(default_factory=list)
    _checked: View | None = field(default=None, init=False)

    def looked(self) -> None:
        """Keep what was seen when runs of a check were made."""
        self._checked = self.views[-1]

    def looks_around(self, checks: Sequence[Check]) -> bool:
        """Whether a check of one kind needs runs all around: the first one does.

        So does one after runs all around that taught what has moved an answer.
        """
        if not checks or self._checked is None:
            return True
        moved = self.views[-1].moved_since(self._checked).max() > self.tolerance
        return bool(moved and checks[-1].misled.any())

    @property
    def reached(self) -> bool:
        """Whether the answers are stable."""
        if len(self.views) <= _STEPS:
            return False
        return bool(max(self.moved.max(), self.views[-1].beta_std.max()) <= self.tolerance)

    @property
    def moved(self) -> FloatArray:
        """How far the indices (C,) have moved over the last steps; zeros at the first of them."""
        now, before = self.views[-1], self.views[-_STEPS - 1 : -1]
        moves = [np.zeros(now.beta.size), *(now.moved_since(view) for view in before)]
        return np.asarray(np.max(moves, axis=0))

    def unfinished(self, checks: Sequence[Sequence[Check]]) -> str:
        """Return why the loop ended before its end; checks are those of each kind, in order."""
        last = [own[-1] for own in checks if own]
        if not self.reached and not all(check.passed for check in last):
            why = "the last check by independent runs did not agree with the surface"
        elif self.reached:
            why = "no runs were left to check the surface independently"
        else:
            why = f"the reliability indices were not yet stable to {self.tolerance:g}"
        return f"after {self.views[-1].runs} training runs {why}"
