"""Checks of an input before it is let in: quantiles in the support, and back to where they were.

A distribution whose quantiles leave its support, or whose distribution function does not lead
back from a quantile, draws something else than it says. Our own form of a family is checked against
OpenTURNS' distribution function; what we have no form of, or none that passes, must pass itself.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.inputs.laws import closed_form
from uqfold.inputs.marginal import Marginal, OpenTURNSMarginal
from uqfold.inputs.stepped import discrete_marginal, mixed_marginal
from uqfold.inputs.wrapped import WrappedMarginal, wrapped

_LEVELS = np.array([0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0])
"""Where the way back is tried on both sides: to probabilities of 1e-9."""
_FURTHEST = 8.0
"""So far out a quantile must lie in the support: probabilities of 6e-16."""
_EXACT = (1e-4, 4e-16)
_NUMERICAL = (1e-3, 1e-9)
"""Relative and absolute error of a probability on the way back, the latter also of a quantile as a
share of the spread: for a form of ours, and the most that is let in."""
_TINY = 2.3e-308
_WITHIN = 1e-9
"""How near a bound probabilities must have come to their end: share of its distance from the
outermost quantile."""
_AT_AN_END = (1e5, 1e-7)
"""What may be missing there: so many times density times distance (where the density is infinite
at the bound there is more than one), and the error of a numerical integral."""


def checked_marginal(distribution: Any, name: str) -> Marginal:
    """Return one input, checked, in a form that computes its quantiles rightly.

    Parameters
    ----------
    distribution
        Univariate OpenTURNS distribution: continuous, discrete, or a mixture of both.
    name
        What messages call it.

    Raises
    ------
    ValueError
        If it does not pass, and there is no other form of it that does.
    """
    if not distribution.isContinuous():
        return _with_atoms(distribution, name)
    own = closed_form(distribution)
    if own is not None and _fault(own, _EXACT) is None:
        return own
    other = wrapped(distribution) or OpenTURNSMarginal(distribution)
    fault = _fault(other, _NUMERICAL)
    if fault is None and isinstance(other, WrappedMarginal):
        fault = _fault_at_a_bound(other)
    if fault is None:
        return other
    raise ValueError(
        f"input {name!r} = {other}: {fault}; give parameters within double precision, or another "
        "distribution"
    )


def _with_atoms(distribution: Any, name: str) -> Marginal:
    """Return an input that is not continuous; errors as in `checked_marginal`."""
    try:
        if distribution.isDiscrete():
            return discrete_marginal(distribution)
        mixed = mixed_marginal(distribution, lambda rest: checked_marginal(rest, name))
    except (RuntimeError, ValueError, TypeError) as error:
        said = str(error)
        raise ValueError(
            said if said.startswith("input ") else f"input {name!r} = {distribution}: {said}"
        ) from error
    if mixed is not None:
        return mixed
    raise ValueError(
        f"input {name!r} = {distribution} is neither continuous nor discrete: give a mixture of "
        "both (openturns.Mixture, or uqfold.inputs.censored)"
    )


def _fault(marginal: Marginal, errors: tuple[float, float]) -> str | None:
    """Say what is wrong with a marginal, or None."""
    try:
        with np.errstate(all="ignore"):
            return _found_fault(marginal, *errors)
    except (RuntimeError, TypeError, ValueError, ArithmeticError) as error:
        return f"its distribution function or its quantiles fail ({error})"


def _found_fault(marginal: Marginal, relative: float, absolute: float) -> str | None:
    from scipy.special import ndtr

    low, high = marginal.bounds
    if not low < high:
        return f"its bounds [{low:g}, {high:g}] leave nothing between"
    u = np.concatenate([[-_FURTHEST], -_LEVELS[:0:-1], _LEVELS, [_FURTHEST]])
    x = marginal.from_normal(u)
    if np.isnan(x).any():
        return "its quantiles are not numbers"
    if not np.isfinite(x).all():
        at = u[np.argmax(~np.isfinite(x))]
        return f"its quantile of the {_level(at)} is infinite"
    outside = (x < low - _slack(low)) | (x > high + _slack(high))
    if outside.any():
        i = int(np.argmax(outside))
        return f"its quantile of the {_level(u[i])} is {x[i]:g}, outside [{low:g}, {high:g}]"
    if (np.diff(x) < -_slack(x[1:])).any() or x[0] == x[-1]:
        return "its quantiles do not increase"
    u, x = u[1:-1], x[1:-1]
    step = _slack(x) + absolute * (np.interp(1.0, u, x) - np.interp(-1.0, u, x))
    upper = u > 0.0
    p = ndtr(-np.abs(u))
    near, far = x + np.where(upper, -step, step), x + np.where(upper, step, -step)
    tails = [np.where(upper, marginal.sf(at), marginal.cdf(at)) for at in (near, far)]
    for found, sign in zip(tails, (1.0, -1.0), strict=True):
        wrong = ~(sign * (found - p) >= -(relative * p + absolute))
        if wrong.any():
            i = int(np.argmax(wrong))
            return (
                f"its quantile of the {_level(u[i])} is {x[i]:g}, where its probability is "
                f"{found[i]:.3g}"
            )
    # a jump is an atom, unless the density explains it, or a bound where it may be infinite
    density = np.max([marginal.pdf(at) for at in (near, x, far)], axis=0)
    explained = relative * p + absolute + 10.0 * density * step
    jump = (tails[0] - tails[1] > explained) & (x - low > step) & (high - x > step)
    if jump.any():
        i = int(np.argmax(jump))
        return f"its distribution function jumps by {(tails[0] - tails[1])[i]:.2g} at {x[i]:g}"
    whole = marginal.cdf(x) + marginal.sf(x)
    if not np.abs(whole - 1.0).max() <= relative + 1e-9:
        return f"its lower and upper probabilities add up to {whole[np.argmax(abs(whole - 1.0))]:g}"
    return None


def _fault_at_a_bound(marginal: Marginal) -> str | None:
    """Say where the distribution function does not end at zero and one, or None.

    At an infinite bound, only whether it passes them: integrals so far out miss what is near.
    """
    ends = marginal.from_normal(np.array([-_FURTHEST, _FURTHEST]))
    reach = float(np.ptp(ends))
    tails = (marginal.cdf, marginal.sf)
    for bound, end, sign, tail in zip(marginal.bounds, ends, (-1.0, 1.0), tails, strict=True):
        open_end = math.isinf(bound)
        step = max(_WITHIN * abs(bound - end), float(_slack(bound)))
        at = np.array([end + sign * reach if open_end else bound - sign * step])
        with np.errstate(all="ignore"):
            rest, density = float(tail(at)[0]), float(marginal.pdf(at)[0])
        many, absolute = _AT_AN_END
        missing = not open_end and rest > absolute + many * density * step
        if missing or rest < -absolute:
            total = rest if sign < 0.0 else 1.0 - rest
            right = "0" if sign < 0.0 else "1"
            return f"its distribution function comes to {total:.6g} at {at[0]:g}, not to {right}"
    return None


def _level(u: float) -> str:
    from scipy.special import ndtr

    return f"{'lower' if u <= 0.0 else 'upper'} probability {ndtr(-abs(u)):.2g}"


def _slack(x: Any) -> Any:
    """A few units in the last place: two values so near are one to double precision."""
    x = np.abs(np.asarray(x, dtype=np.float64))
    finite = np.where(np.isfinite(x), x, 1.0)
    return 4.0 * np.spacing(finite) + _TINY
