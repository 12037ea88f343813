"""One unit's response over standard-normal space and its linearisation, for FORM-like methods.

The response y(u) is seen through a memo, so that an optimiser that asks twice pays once. Its
gradient is the model's own, if there is one and it agrees with differences where the search starts;
else it comes from central differences, whose step must be large against the noise of the model.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from uqfold.evaluation import (
    BudgetExceededError,
    EvaluationSession,
    FailedRunError,
    GradientError,
)
from uqfold.inputs import JointInputs
from uqfold.methods.result import Estimate
from uqfold.typing import FloatArray

SEARCH_RADIUS = 10.0
"""The response is searched within this distance of the origin; 1 - Phi(10) = 8e-24."""

_MAP_STEP = 1e-4
"""Half width of the central differences of the map from standard-normal space to the inputs."""
_AGREES = 0.05
"""Share of the slope by which a gradient may differ from differences."""
_FINER = 8.0
"""Where it seems to, the differences are taken again over a step so many times smaller."""

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

    def beyond(self, y: FloatArray, threshold: float) -> FloatArray:
        """Distances (n,) by which responses (n,) exceed T, at the slope here."""
        with np.errstate(over="ignore", invalid="ignore"):
            gap = y - threshold
            # what is too far apart for a number may be a few standard deviations
            apart = y / self.slope - threshold / self.slope
            return np.where(np.isfinite(gap), gap / self.slope, apart)

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
    gradient
        Derivatives (k, d) by the inputs (k, d), if the model offers them.
    refuted
        Why the model's gradient is not used; empty where it is, or there is none.
    """

    inputs: JointInputs
    session: EvaluationSession
    step: float
    allowed: int
    row_of: Callable[[FloatArray], FloatArray] = np.asarray
    gradient: Callable[[FloatArray], FloatArray] | None = None
    refuted: str = ""
    _confirmed: bool = False
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
        """Value and gradient at u (d,): one run with the model's own gradient, else 2 d + 1.

        The first time, and where the model's own is zero, both are asked for: where they contradict
        each other, differences are used from then on, and `refuted` says why. They are also used
        where the model's own is zero or not a number, and beyond `SEARCH_RADIUS`. Where one of the
        two neighbours in a direction has an infinite response, the difference is one-sided.

        Raises
        ------
        NoGradientError
            If the response is infinite at u or on both sides of it, or does not change around it.
        """
        own = self._own_gradient(u)
        if own is None:
            return self._by_differences(u)
        if not (self._confirmed and own.any()):
            known = self._by_differences(u)
            if self._doubts(u, own) or not own.any():
                return known
            self._confirmed = True
        centre = float(self.values(u[None, :])[0])
        if not math.isfinite(centre):
            raise NoGradientError(f"the response is {centre} at u = {shown(u)}")
        return Linearisation(u, centre, own)

    def doubts_gradient(self, u: FloatArray) -> bool:
        """Whether the model's own gradient, if it is in use, contradicts differences at u (d,).

        Then differences are used from then on, and `refuted` says why. Errors as in `values`.
        """
        own = self._own_gradient(u)
        return own is not None and self._doubts(u, own)

    def _doubts(self, u: FloatArray, own: FloatArray) -> bool:
        self.refuted = self._contradiction(u, own)
        if self.refuted:
            self.gradient = None
        return bool(self.refuted)

    def _own_gradient(self, u: FloatArray) -> FloatArray | None:
        """Return the model's gradient (d,) by u, by the chain rule; None where there is none."""
        if self.gradient is None or math.hypot(*u) > SEARCH_RADIUS:
            return None
        steps = _MAP_STEP * np.eye(u.size)
        x = self.inputs.from_standard_normal(np.vstack([u, u + steps, u - steps]))
        try:
            by_inputs = self.gradient(x[:1])[0]
        except GradientError as error:
            self.refuted, self.gradient = str(error), None
            return None
        slopes = (x[1 : u.size + 1] - x[u.size + 1 :]) / (2.0 * _MAP_STEP)
        with np.errstate(invalid="ignore"):
            found = np.einsum("ij,j->i", slopes, by_inputs)
        return found if np.isfinite(found).all() else None

    def _contradiction(self, u: FloatArray, own: FloatArray) -> str:
        """Return how a gradient (d,) contradicts differences around u (d,); empty if it does not.

        A slope between those to both sides agrees, whatever the curvature.
        """
        ahead, back = self._sides(u, self.step)
        low, high = np.minimum(ahead, back), np.maximum(ahead, back)
        slack = _AGREES * max(math.hypot(*own), math.hypot(*(0.5 * (ahead + back))))
        off = np.fmax(np.fmax(low - own, own - high), 0.0)
        if not math.hypot(*off) > slack:
            return ""
        ahead, back = self._sides(u, self.step / _FINER)
        by_differences = 0.5 * (ahead + back)
        off = np.abs(own - by_differences)
        if math.hypot(*off) <= slack:
            return ""
        worst = int(np.nanargmax(off))
        return (
            f"the gradient says {own[worst]:.3g} per standard deviation of "
            f"{self.inputs.names[worst]}, differences {by_differences[worst]:.3g}"
        )

    def _sides(self, u: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
        """Slopes (d,) to both sides of u (d,)."""
        steps = step * np.eye(u.size)
        y = self.values(np.vstack([u, u + steps, u - steps]))
        with np.errstate(invalid="ignore"):
            return (y[1 : u.size + 1] - y[0]) / step, (y[0] - y[u.size + 1 :]) / step

    def _by_differences(self, u: FloatArray) -> Linearisation:
        """Value and central-difference gradient at u (d,); errors as in `linearise`."""
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


def in_doubt(estimate: Estimate, refuted: str) -> Estimate:
    """Return an answer that differences gave, since the model's own gradient was `refuted`."""
    if not refuted or estimate.status in ("failed", "unsupported"):
        return estimate
    said = f"{refuted}: model and gradient do not belong together, differences were used"
    message = f"{said}; {estimate.message}" if estimate.message else said
    return replace(estimate, status="doubtful", message=message)


def shown(u: FloatArray) -> str:
    """Show a point in a message."""
    return "(" + ", ".join(f"{value:.3g}" for value in u) + ")"
