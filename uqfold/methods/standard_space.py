"""One unit's response over standard-normal space and its linearisation, for FORM-like methods.

The response y(u) is seen through a memo, so that an optimiser that asks twice pays once, and its
gradient comes from central differences, whose step must be large against the noise of the model.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from uqfold.evaluation import BudgetExceededError, EvaluationSession, FailedRunError
from uqfold.inputs import JointInputs
from uqfold.typing import FloatArray

SEARCH_RADIUS = 10.0
"""The response is searched within this distance of the origin; 1 - Phi(10) = 8e-24."""

_LEVEL = 1e-300
"""Slope of a response that has none."""


class NoGradientError(RuntimeError):
    """The response has no usable gradient at a point."""


@dataclass(frozen=True, eq=False)
class Linearisation:
    """First-order picture of the response around one point: y(u) + a . (v - u).

    Attributes
    ----------
    u
        The point, in standard-normal space (d,).
    y
        Response there.
    gradient
        Gradient a (d,), in the response's unit per standard deviation.
    """

    u: FloatArray
    y: float
    gradient: FloatArray

    @classmethod
    def level(cls, u: FloatArray, y: float) -> Linearisation:
        """A response y that does not change around u: no plane is met, whatever the direction."""
        return cls(u, y, np.where(np.arange(u.size) == 0, _LEVEL, 0.0))

    @property
    def slope(self) -> float:
        """Length of the gradient."""
        return math.hypot(*self.gradient)

    @property
    def alpha(self) -> FloatArray:
        """Unit vector (d,) of steepest rise, which points towards failure."""
        return self.gradient / self.slope

    def beta(self, threshold: float) -> float:
        """Signed distance from the origin to the plane y = T, negative if the origin fails."""
        if self.slope == _LEVEL:
            return math.copysign(math.inf, threshold - self.y)
        return (threshold - self.y) / self.slope + float(self.alpha @ self.u)

    def residual(self, threshold: float) -> float:
        """Distance from u to the foot beta * alpha of that plane, zero at a design point.

        It holds both errors that a wrong design point can have: not on the limit state, and not
        collinear with the gradient.
        """
        beta = self.beta(threshold)
        # hypot scales, so that a threshold of 1e300 does not overflow
        return math.hypot(*(self.u - beta * self.alpha)) if math.isfinite(beta) else math.inf


@dataclass(eq=False)
class StandardSpaceResponse:
    """The response of one unit over standard-normal space: remembered, counted, with gradient.

    A `step` beyond `SEARCH_RADIUS` the response is continued as a constant along each ray, so that
    an optimiser's wild step does not run the model at inputs that mean nothing.

    Attributes
    ----------
    inputs
        The unit's inputs.
    session
        Counted access to the model.
    step
        Half width of the central differences, in standard deviations.
    allowed
        Runs that may have been made in all (`session.n_evals`) before `BudgetExceededError`.
    row_of
        Makes rows for the session of inputs (k, d).
    """

    inputs: JointInputs
    session: EvaluationSession
    step: float
    allowed: int
    row_of: Callable[[FloatArray], FloatArray] = np.asarray
    _known: dict[bytes, float] = field(default_factory=dict)

    def values(self, u: FloatArray) -> FloatArray:
        """Responses (k,) at the points u (k, d); only points not seen before cost a run.

        Raises
        ------
        BudgetExceededError
            If the new points do not fit into `allowed`; none is run then.
        FailedRunError
            If a run fails: there is no gradient through a hole.
        """
        radius = np.linalg.norm(u, axis=1, keepdims=True)
        # differences at the edge must not be bent
        furthest = SEARCH_RADIUS + self.step
        u = np.where(radius > furthest, u * (furthest / np.maximum(radius, 1.0)), u)
        keys = [(row + 0.0).tobytes() for row in u]
        new = {key: i for i, key in enumerate(keys) if key not in self._known}
        if new:
            if self.session.n_evals + len(new) > self.allowed:
                raise BudgetExceededError(f"{len(new)} more runs do not fit into the share")
            x = self.inputs.from_standard_normal(u[list(new.values())])
            self._known.update(
                zip(new, self.session.evaluate(self.row_of(x)).tolist(), strict=True)
            )
        y = np.array([self._known[key] for key in keys])
        if np.isnan(y).any():
            raise FailedRunError(f"no linearisation with failed runs: {self.session.first_failure}")
        return y

    def linearise(self, u: FloatArray) -> Linearisation:
        """Value and central-difference gradient at u (d,): 2 d + 1 runs.

        Where one of the two neighbours in a direction has an infinite response, the difference
        is one-sided.

        Raises
        ------
        NoGradientError
            If the response is infinite at u or on both sides of it, or does not change around it.
        """
        steps = self.step * np.eye(u.size)
        y = self.values(np.vstack([u, u + steps, u - steps]))
        centre, up, down = y[0], y[1 : u.size + 1], y[u.size + 1 :]
        if not math.isfinite(centre):
            raise NoGradientError(f"the response is {centre} at u = {shown(u)}")
        above, below = np.isfinite(up), np.isfinite(down)
        if not (above | below).all():
            raise NoGradientError(f"the response is infinite on both sides of u = {shown(u)}")
        rise = np.where(above, up, centre) - np.where(below, down, centre)
        gradient = rise / (self.step * (above.astype(float) + below))
        # symmetry, or no dependence at all: the differences cancel against the change itself
        change = float(np.abs(np.concatenate([up[above], down[below]]) - centre).max())
        if not math.hypot(*gradient) > 1e-6 * change / self.step:
            what = "is stationary" if change > 0.0 else "does not change"
            raise NoGradientError(f"the response {what} around u = {shown(u)}")
        return Linearisation(u, float(centre), gradient)


def shown(u: FloatArray) -> str:
    """Show a point in a message."""
    return "(" + ", ".join(f"{value:.3g}" for value in u) + ")"
