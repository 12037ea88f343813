"""Surfaces with a cheap partner: its runs beside those of the model, and many more.

The difference of model and partner is asked first, which takes no more of the partner than one run
for each of the model. Only if that is foretold much better than the model is the partner run more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import STREAMS
from uqfold.methods.partner_control import WORTH
from uqfold.methods.partner_sample import Partner, PartnerError
from uqfold.methods.task import Solution, Task
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.partner_surface import PartnerSurface, factor_of
from uqfold.typing import FloatArray

SurfaceOfKind: TypeAlias = GaussianProcess | PartnerSurface
OfKind: TypeAlias = tuple[SurfaceOfKind, FittedKind]
FitRuns: TypeAlias = Callable[[DesignRuns, str], tuple[list[GaussianProcess], str]]
"""SurfaceOfKind of some runs, the best one first; and why there are no more of them."""

# Stream of random numbers of a kind that the partner's further runs come from.
_STREAM = 600


class PartnerRuns:
    """The partner of each kind of units, and its runs so far, each made once.

    Parameters
    ----------
    task
        The question.
    ratio
        Runs of the partner for each of the model.
    spread
        Standard deviation of the points of its design.
    most
        Most runs that a surface can bear.

    Attributes
    ----------
    note
        Why the partner was not asked, or was not used; empty where it was.
    """

    def __init__(self, task: Task, ratio: int, spread: float, most: int) -> None:
        self.task, self.ratio, self.spread, self.most = task, ratio, spread, most
        self.note = ""
        self._partner = Partner(task)
        self._known: dict[tuple[int, bytes], float] = {}
        self._exponents: dict[int, int] = {}

    @property
    def evals(self) -> int:
        """How many runs were made."""
        return self._partner.session.n_evals

    @property
    def failed(self) -> int:
        """How many of them failed."""
        return self._partner.session.n_failed

    def beside(self, kind: int, u: FloatArray) -> FloatArray | None:
        """Responses (n,) at the model's own points (n, d); None where one of them is missing.

        They are in a unit of their own, a power of two: their factor in the model's is fitted.
        """
        try:
            y = self._at(kind, u)
            self._exponents[kind] = int(np.frexp(np.abs(y).max())[1])
            y = np.ldexp(y, -self._exponents[kind])
        except (PartnerError, TimeLimitError) as error:
            self.note = str(error)
            return None
        if np.isfinite(y).all():
            return y
        self.note = "the partner gives no response where the model does, and was not used"
        return None

    def with_more(self, kind: int, u: FloatArray) -> DesignRuns:
        """Return its runs `beside` the model's points (n, d), and at further ones of its own."""
        wanted = min(self.ratio * len(u), self.most) - len(u)
        if wanted > 0:
            rng = self.task.generator(kind * STREAMS + _STREAM)
            # the first one is the origin, where the model's own design begins
            own = space_filling_design(wanted + 1, u.shape[1], rng, self.spread)
            u = np.concatenate([u, own[1:]])
        y = np.ldexp(self._at(kind, u), -self._exponents[kind])
        some = np.isfinite(y)
        return DesignRuns(u[some], y[some], int(some.sum()))

    def noted(self, solution: Solution) -> Solution:
        """Return the answers with what is to be said of the partner."""
        if not self.note:
            return solution
        noted = [
            replace(one, message="; ".join(filter(None, (one.message, self.note))))
            for one in solution.estimates
        ]
        return replace(solution, estimates=noted)

    def _at(self, kind: int, u: FloatArray) -> FloatArray:
        keys = [(kind, point.tobytes()) for point in u]
        new = [row for row, key in enumerate(keys) if key not in self._known]
        if new:
            kinds = self.task.problem.kinds
            x = kinds.rows_of(kind, kinds.inputs[kind].from_standard_normal(u[new]))
            found = self._partner.responses(x).tolist()
            self._known.update(zip((keys[row] for row in new), found, strict=True))
        return np.array([self._known[key] for key in keys])


def with_partner(
    task: Task, partner: PartnerRuns, kind: int, alone: OfKind, fit: FitRuns
) -> tuple[OfKind, float]:
    """Return the surface of one kind with its partner, and what it gains; or without, and NaN.

    Parameters
    ----------
    task
        The question.
    partner
        The partner's runs.
    kind
        The kind of units.
    alone
        The surface of the model alone.
    fit
        How surfaces are fitted.
    """
    plain, fitted = alone
    assert isinstance(plain, GaussianProcess)
    low, missed = partner.beside(kind, plain.u), plain.leave_one_out().rms
    if low is None:
        return alone, math.nan
    of_no_use = "the partner is of no use: as if it had not been asked"
    process, differences, factor = plain, [plain], 0.0
    # the factor of a process that knows nothing of the partner yet, and again of the difference
    for _ in range(2 if np.ptp(low) > 0.0 else 0):
        factor = factor_of(process, low, plain.y)
        own = DesignRuns(plain.u, plain.y - factor * low, plain.size)
        differences, _ = task.summed_up(partial(fit, own))
        process = differences[0]
    # were the partner known everywhere
    if WORTH * process.leave_one_out().rms ** 2 >= missed**2:
        partner.note = of_no_use
        return alone, math.nan
    try:
        every = partner.with_more(kind, plain.u)
    except (PartnerError, TimeLimitError) as error:
        partner.note = str(error)
        return alone, math.nan
    partners, stopped = task.summed_up(partial(fit, every))
    surface = PartnerSurface(partners[0], process, factor)
    others = [
        *(PartnerSurface(partners[0], other, factor) for other in differences[1:]),
        *(PartnerSurface(other, process, factor) for other in partners[1:]),
    ]
    left = surface.leave_one_out().rms
    gain = (missed / left) ** 2 if left > 0.0 else math.inf
    if gain < WORTH:
        partner.note = of_no_use
        return alone, math.nan
    made = replace(fitted.runs, stopped=stopped) if stopped else fitted.runs
    rivals = [Rival.by_prediction(surface, other) for other in others]
    return (surface, FittedKind(surface, made, surface.noise_std, rivals)), gain
