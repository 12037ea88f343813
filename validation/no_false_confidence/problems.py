"""Problems on which a method may be wrong without knowing, each with its exact answer.

Most are functions of independent standard normal variables. `PROBLEMS` is the list; each entry
says what kind of trouble it holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import openturns as ot
from scipy import special, stats

import uqfold
from uqfold.problems.criterion import Criterion
from validation.no_false_confidence import truths
from validation.no_false_confidence.truths import average, tail

Array = Any
ROOT_2 = math.sqrt(2.0)


@dataclass(frozen=True)
class Hard:
    """A problem, its question and its answer.

    Attributes
    ----------
    name, kind
        What it is, and the trouble that it holds.
    d
        Number of inputs.
    response
        Takes X (n, d), gives y (n,); it works while y <= T.
    threshold
        T.
    truth
        Computes pf.
    smooth
        Whether it is one for which a smooth surface is the right tool.
    inputs
        Builds the joint distribution; None: standard normals.
    units, missions, shared
        The system; the first `shared` inputs are shared.
    safe
        Computes pf with all failed runs safe; None: no run fails.
    """

    name: str
    kind: str
    d: int
    response: Callable[[Array], Array]
    threshold: float
    truth: Callable[[], float]
    smooth: bool = False
    inputs: Callable[[], Any] | None = None
    units: int = 1
    missions: int = 1
    shared: int = 0
    safe: Callable[[], float] | None = None

    @cached_property
    def pf(self) -> float:
        """The exact failure probability, failed runs counted as failures."""
        return self.truth()

    @cached_property
    def least(self) -> float:
        """The exact failure probability with failed runs safe."""
        return self.pf if self.safe is None else self.safe()

    @property
    def criterion(self) -> Criterion:
        """What is asked."""
        return Criterion(self.threshold, None, self.missions)

    def problem(self) -> uqfold.Problem:
        """Return the problem as a method takes it."""
        if self.inputs is not None:
            return uqfold.Problem(self.response, inputs=self.inputs(), name=self.name)
        marginals = [stats.norm() for _ in range(self.d)]
        return uqfold.Problem(
            self.response,
            shared=marginals[: self.shared] or None,
            individual=marginals[self.shared :],
            units=self.units,
            name=self.name,
            names=[f"u{i}" for i in range(self.d)],
        )


def given(
    name: str,
    kind: str,
    level: float,
    mean: Callable[..., Array],
    slopes: Sequence[float] | Callable[..., Sequence[Array]],
    *,
    known: Sequence[int] = (0,),
    breaks: Sequence[float] = (),
    **more: Any,
) -> Hard:
    """Return a response that is linear in all inputs but some: normal, once these are known.

    Parameters
    ----------
    name, kind, level
        Name, trouble and threshold.
    mean
        Function of the known inputs; NaN where a run fails.
    slopes
        Factor of each other input, or a function of the known ones that gives these.
    known
        Columns of the known inputs.
    breaks
        Where the mean or a slope has a kink or a step.
    more
        Further fields of `Hard`.
    """

    def slopes_at(u: Sequence[Array]) -> Sequence[Array]:
        return slopes(*u) if callable(slopes) else slopes

    def response(x: Array) -> Array:
        u, others = x[:, known].T, np.delete(x, known, axis=1).T
        return mean(*u) + sum(s * one for s, one in zip(slopes_at(u), others, strict=True))

    def pf(failed: float) -> float:
        def beyond(*u: Array) -> Array:
            middle, spread = mean(*u), np.sqrt(sum(slope**2 for slope in slopes_at(u)))
            works = special.log_ndtr((level - middle) / spread)
            trials = more.get("units", 1) * more.get("missions", 1)
            return np.where(np.isnan(middle), failed, -np.expm1(trials * works))

        return average(beyond, len(known), breaks)

    d = len(known) + len(slopes_at(np.zeros(len(known))))
    return Hard(name, kind, d, response, level, lambda: pf(1.0), safe=lambda: pf(0.0), **more)


# linear, and bent a little


def linear(d: int, pf: float) -> Hard:
    """A weighted sum; its reliability index is the threshold."""
    weights = np.arange(1.0, d + 1.0) ** -0.5
    weights /= math.sqrt(float(weights @ weights))
    beta = float(-special.ndtri(pf))
    return Hard(
        f"linear, {d} inputs, {pf:g}", "linear", d, lambda x: x @ weights, beta,
        lambda: tail(beta), smooth=True,
    )  # fmt: skip


def mild(d: int, threshold: float, curvature: float) -> Hard:
    """All inputs matter alike, each bent a little."""
    slope = 1.0 / math.sqrt(d)
    return Hard(
        f"mildly curved, {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: slope * x.sum(axis=1) + curvature * (x**2).sum(axis=1), threshold,
        lambda: truths.curved_sum(threshold, d, slope, curvature), smooth=True,
    )  # fmt: skip


def bent(d: int, directions: int, threshold: float, curvature: float) -> Hard:
    """Linear in the first input, curved in some of the others, without the rest."""
    return Hard(
        f"curved in {directions} of {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: x[:, 0] + curvature * (x[:, 1 : directions + 1] ** 2).sum(axis=1), threshold,
        lambda: truths.bent(threshold, curvature, directions), smooth=True,
    )  # fmt: skip


def sphere(d: int, pf: float) -> Hard:
    """Failure all around."""
    return Hard(
        f"|x|^2, {d} inputs, {pf:g}", "failure all around", d, lambda x: (x**2).sum(axis=1),
        float(stats.chi2.isf(pf, d)), lambda: pf, smooth=True,
    )  # fmt: skip


def exponentials(d: int, sigma: float, threshold: float) -> Hard:
    """A sum of exponentials of normal variables: one large term is enough."""
    return Hard(
        f"{d} exponentials, sigma = {sigma:g}", "heavy tails", d,
        lambda x: np.exp(sigma * x).sum(axis=1), threshold,
        lambda: truths.sum_of_exponentials(threshold, d, sigma), smooth=True,
    )  # fmt: skip


def waiting(d: int, pf: float) -> Hard:
    """A sum of exponential variables."""
    return Hard(
        f"{d} exponential variables, {pf:g}", "skewed inputs", d, lambda x: x.sum(axis=1),
        float(stats.gamma.isf(pf, d)), lambda: pf, smooth=True,
        inputs=lambda: [stats.expon() for _ in range(d)],
    )  # fmt: skip


def lognormal(name: str, kind: str, slopes: Sequence[float], pf: float, **more: Any) -> Hard:
    """A product of lognormal variables."""
    factors = np.array(slopes)
    beta = float(-special.ndtri(pf))
    return Hard(
        f"{name}, {pf:g}", kind, len(factors), lambda x: np.exp(x @ factors),
        math.exp(math.sqrt(float(factors @ factors)) * beta), lambda: pf, **more,
    )  # fmt: skip


def powers_of_ten(sigma: float, pf: float) -> Hard:
    """A response that spans many powers of ten."""
    slopes = sigma * np.array([0.6, 0.64, 0.48])
    return lognormal(f"exp({sigma:g} u)", "scales", slopes, pf)


SMOOTH = [
    linear(1, 0.9), linear(2, 1e-8), linear(10, 1e-6), linear(50, 1e-4), linear(100, 1e-6),
    mild(2, 3.5, 0.1), mild(10, 4.0, 0.03), mild(30, 4.5, 0.02), mild(49, 5.0, 0.02),
    bent(2, 1, 3.0, 0.2), bent(8, 3, 5.0, -0.1), bent(100, 5, 5.5, 0.1),
    sphere(2, 1e-4), sphere(8, 1e-4), sphere(10, 1e-2),
    exponentials(2, 1.0, 22.0), exponentials(5, 0.5, 15.0),
    waiting(2, 1e-5), waiting(20, 1e-3), waiting(100, 1e-7), powers_of_ten(8.0, 1e-3),
]  # fmt: skip

# sharp features, kinks, steps, plateaus, bands


def sharp(power: int, factor: float, level: float, inert: int = 0) -> Hard:
    """A narrow valley of the limit state: safe only near u1 = 0."""
    name = f"x2 - {factor:g} x1^{power}{f', {inert} inert' if inert else ''}"
    return given(name, "sharp", level, lambda u: -factor * u**power, [1.0] + [0.0] * inert)


def kink(level: float) -> Hard:
    """|a| + b."""
    return given(f"|a| + b, T = {level:g}", "kink", level, np.abs, [1.0], breaks=[0.0])


def largest(d: int, level: float) -> Hard:
    """The largest of d inputs."""
    return Hard(
        f"max of {d}, T = {level:g}", "kink", d, lambda x: x.max(axis=1), level,
        lambda: -math.expm1(d * float(special.log_ndtr(level))),
    )  # fmt: skip


def hockey(level: float) -> Hard:
    """Steeper beyond a kink, short of which nearly all runs lie."""

    def response(x: Array) -> Array:
        along = x.sum(axis=1) / math.sqrt(3.0)
        return along + 9.0 * np.maximum(along - 2.5, 0.0)

    return Hard(
        f"slope 1, beyond 2.5 slope 10, T = {level:g}", "kink", 3, response, level,
        lambda: tail(2.5 + (level - 2.5) / 10.0),
    )  # fmt: skip


def step(at: float, height: float, level: float, d: int) -> Hard:
    """A step at one input, beyond which the response is higher."""
    name = f"step of {height:g} at {at:g}, {d} inputs"
    return given(
        name, "steps", level, lambda u: height * (u > at), [1.0] * (d - 1), breaks=[at]
    )  # fmt: skip


def plateau(top: float, level: float) -> Hard:
    """A response that saturates above the threshold and below it."""
    return Hard(
        f"clipped at {top:g}, T = {level:g}", "plateau", 2,
        lambda x: np.clip(x.sum(axis=1), -top, top), level,
        lambda: tail(level / ROOT_2) if level < top else 0.0,
    )  # fmt: skip


def band(centre: float, pf: float, d: int) -> Hard:
    """A bump that exceeds T only in a thin band of one input."""
    half = 0.5 * pf / float(stats.norm.pdf(centre))
    width = half / math.sqrt(math.log(2.0))
    return Hard(
        f"band at {centre:g}, {pf:g}, {d} inputs", "thin band", d,
        lambda x: np.exp(-(((x[:, 0] - centre) / width) ** 2)), 0.5,
        lambda: tail(centre - half) - tail(centre + half),
    )  # fmt: skip


ROUGH = [
    sharp(4, 100.0, 2.5), sharp(6, 30.0, 3.0), sharp(4, 100.0, 2.5, inert=3),
    kink(3.0), largest(10, 4.0), hockey(20.0),
    Hard(
        "round(2 (x + y)) / 2, T = 3", "steps", 2,
        lambda x: np.round(2.0 * x.sum(axis=1)) / 2.0, 3.0, lambda: tail(3.25 / ROOT_2),
    ),
    step(2.0, 3.0, 4.0, 2), step(3.5, 6.0, 5.0, 4), plateau(1.0, 0.5), plateau(4.0, 3.9),
    Hard(
        "0 or 1 at 1.5", "plateau", 2, lambda x: (x[:, 0] > 1.5).astype(float), 0.5,
        lambda: tail(1.5),
    ),
    given(
        "two regimes, T = 3", "regimes", 3.0, lambda u: np.where(u < 1.0, 0.0, 1.0),
        lambda u: [np.where(u < 1.0, 1.0, -2.0)], breaks=[1.0],
    ),
    given(
        "three regimes, T = 4", "regimes", 4.0,
        lambda u: np.select([u < -0.5, u < 0.5], [0.0, 0.5], -1.0),
        lambda u: [
            np.select([u < -0.5, u < 0.5], slopes)
            for slopes in ([1.0, 1.0], [1.0, -1.0])
        ] + [np.where((u < -0.5) | (u >= 0.5), 1.0, 0.0)],
        breaks=[-0.5, 0.5],
    ),
    band(2.5, 4e-5, 1), band(1.0, 1e-3, 3),
]  # fmt: skip

# several failure regions


def square(level: float, d: int) -> Hard:
    """Two regions, one on either side."""
    root = math.sqrt(level + 0.0025)
    return Hard(
        f"u^2 + 0.1 u, {d} inputs, T = {level:g}", "two regions", d,
        lambda x: x[:, 0] ** 2 + 0.1 * x[:, 0], level,
        lambda: tail(root - 0.05) + tail(root + 0.05), smooth=True,
    )  # fmt: skip


def four(level: float) -> Hard:
    """Four regions, one on either side of two inputs."""
    return Hard(
        f"max(|a|, |b|), T = {level:g}", "four regions", 2,
        lambda x: np.abs(x).max(axis=1), level, lambda: truths.either(*[2.0 * tail(level)] * 2),
    )  # fmt: skip


def two_sides(near: float, far: float, d: int) -> Hard:
    """One region near, and one of another input a little further, at an angle."""
    return Hard(
        f"regions at {near:g} and {far:g}, {d} inputs", "two regions", d,
        lambda x: np.maximum(x[:, 0] - near, (x[:, 1:].sum(axis=1)) / math.sqrt(d - 1.0) - far),
        0.0, lambda: truths.either(tail(near), tail(far)),
    )  # fmt: skip


def rare_second(d: int) -> Hard:
    """A cliff of an input that matters nowhere else holds most of the failures."""
    return Hard(
        f"hidden second region, {d} inputs", "hidden region", d,
        lambda x: np.maximum(x[:, 0] / 4.0, 4.0 * (x[:, 1] - 2.75)), 1.0,
        lambda: truths.either(tail(4.0), tail(3.0)),
    )  # fmt: skip


def beyond_either_side(distance: Array) -> Array:
    """Return P(|u| > distance)."""
    return 2.0 * special.ndtr(-np.maximum(distance, 0.0))


SEVERAL = [
    square(9.0, 1), square(16.0, 4), four(3.0), two_sides(3.5, 3.0, 6),
    Hard(
        "|b| + a^2 / 4", "two regions", 2, lambda x: np.abs(x[:, 1]) + 0.25 * x[:, 0] ** 2, 3.0,
        lambda: average(
            lambda a: beyond_either_side(3.0 - 0.25 * a**2),
            breaks=[-math.sqrt(12.0), math.sqrt(12.0)],
        ),
    ),
    Hard(
        "cosh a + cosh b, T = 16", "four regions", 2, lambda x: np.cosh(x).sum(axis=1), 16.0,
        lambda: average(
            lambda a: beyond_either_side(np.arccosh(np.maximum(16.0 - np.cosh(a), 1.0))),
            breaks=[-math.acosh(15.0), math.acosh(15.0)],
        ),
        smooth=True,
    ),
    rare_second(2), rare_second(5),
]  # fmt: skip

# bounded, heavy-tailed and dependent inputs


def uniforms(d: int, level: float) -> Hard:
    """A sum of uniform variables, near its upper end (Irwin and Hall)."""
    return Hard(
        f"{d} uniform variables, T = {level:g}", "bounded inputs", d, lambda x: x.sum(axis=1),
        level, lambda: (d - level) ** d / math.factorial(d), smooth=True,
        inputs=lambda: [stats.uniform() for _ in range(d)],
    )  # fmt: skip


def student(df: float, level: float) -> Hard:
    """A sum of two Student variables."""

    def pf() -> float:
        x = np.sinh(np.linspace(-30.0, 30.0, 600_001))
        return float(np.trapezoid(stats.t.pdf(x, df) * stats.t.sf(level - x, df), x))

    return Hard(
        f"two Student variables of {df:g}", "heavy tails", 2, lambda x: x.sum(axis=1), level, pf,
        inputs=lambda: [stats.t(df), stats.t(df)],
    )  # fmt: skip


def joined(marginal: Any, copula: Any) -> Any:
    """Return two variables of one distribution, joined by a copula."""
    return ot.JointDistribution([marginal, marginal], copula)


def correlation(rho: float) -> Any:
    """Return the matrix of two variables."""
    return ot.CorrelationMatrix(2, [1.0, rho, rho, 1.0])


SHAPED = [
    uniforms(3, 2.95), uniforms(6, 5.0), student(3.0, 20.0),
    Hard(
        "Pareto and normal, T = 9", "heavy tails", 2, lambda x: x.sum(axis=1), 9.0,
        lambda: average(lambda u: stats.pareto.sf(9.0 - u, 4.0), breaks=[8.0]),
        inputs=lambda: [stats.pareto(4.0), stats.norm()],
    ),
    # P(sqrt(U) sqrt(V) > t) = 1 - t^2 (1 - log t^2)
    Hard(
        "product of beta variables", "bounded inputs", 2, lambda x: x.prod(axis=1), 0.98,
        lambda: 1.0 - 0.98**2 * (1.0 - math.log(0.98**2)), smooth=True,
        inputs=lambda: [stats.beta(2.0, 1.0), stats.beta(2.0, 1.0)],
    ),
    Hard(
        "correlated normals, T = 6", "dependent inputs", 2, lambda x: x.sum(axis=1), 6.0,
        lambda: tail(6.0 / math.sqrt(3.4)), smooth=True,
        inputs=lambda: ot.Normal([0.0, 0.0], [1.0, 1.0], correlation(0.7)),
    ),
    Hard(
        "product of correlated lognormals", "dependent inputs", 2, lambda x: x.prod(axis=1),
        math.exp(0.3 * math.sqrt(3.0) * 4.0), lambda: tail(4.0), smooth=True,
        inputs=lambda: joined(ot.LogNormal(0.0, 0.3), ot.NormalCopula(correlation(0.5))),
    ),
    Hard(
        "sum under a Clayton copula", "dependent inputs", 2, lambda x: x.sum(axis=1), 4.0,
        lambda: truths.clayton_sum(4.0, 2.0), smooth=True,
        inputs=lambda: joined(ot.Normal(), ot.ClaytonCopula(2.0)),
    ),
    Hard(
        "smaller under a Clayton copula", "dependent inputs", 2, lambda x: -x.max(axis=1), 2.0,
        lambda: truths.clayton(tail(2.0), tail(2.0), 2.0),
        inputs=lambda: joined(ot.Normal(), ot.ClaytonCopula(2.0)),
    ),
]  # fmt: skip

# oscillators, frames, panels, systems


def oscillator(level: float) -> Hard:
    """Six inputs: displacement of an oscillator under a pulse, against its yield point."""

    def peak(c: Array, m: Array, t: Array, damping: Array) -> Array:
        stiffness, mass, time = 1.1 * (1.0 + 0.05 * c), 1.0 + 0.05 * m, 1.0 + 0.2 * t
        swing = 2.0 / stiffness * np.abs(np.sin(0.5 * np.sqrt(stiffness / mass) * time))
        return swing * (1.0 - 0.01 * damping)

    # the others are force and yield point
    return given(
        f"oscillator, T = {level:g}", "oscillator", level, lambda *u: peak(*u) - 1.5,
        lambda *u: [0.2 * peak(*u), -0.15], known=[0, 1, 2, 5], smooth=True,
    )  # fmt: skip


def frame(level: float) -> Hard:
    """Nine inputs: sway of a frame, six loads over two stiffnesses and a length."""
    loads = [1.0, 0.8, 0.6, 0.5, 0.3, 0.2]

    def sway(column: Array, beam: Array, length: Array) -> Array:
        return (1.0 + 0.02 * length) ** 3 * (np.exp(-0.1 * column) + 0.5 * np.exp(-0.15 * beam))

    return given(
        f"frame, T = {level:g}", "frame", level, lambda *u: sum(loads) * sway(*u),
        lambda *u: [0.25 * load * sway(*u) for load in loads], known=[6, 7, 8], smooth=True,
    )  # fmt: skip


def panel(pf: float) -> Hard:
    """Eight inputs: utilisation of a panel, a product of powers of lognormal variables."""
    powers = np.array([1.0, -2.0, 1.5, 0.5, -1.0, 0.3, -0.2, 1.0])
    spreads = np.array([0.2, 0.05, 0.1, 0.1, 0.15, 0.2, 0.1, 0.05])
    return lognormal("panel", "panel", powers * spreads, pf, smooth=True)


def beam(level: float) -> Hard:
    """Ten inputs: a moment of seven loads against a resistance that is a product."""
    loads = np.linspace(0.4, 1.0, 7)

    def margin(a: Array, b: Array, c: Array) -> Array:
        return loads.sum() - 8.0 * np.exp(0.08 * a + 0.05 * b) * (1.0 + 0.04 * c)

    return given(
        f"beam, T = {level:g}", "frame", level, margin, 0.2 * loads, known=[7, 8, 9], smooth=True
    )


def resonance(level: float) -> Hard:
    """Steady amplitude of a damped oscillator near its resonance, seven inputs."""

    def gain(stiffness: Array, damping: Array) -> Array:
        ratio, share = 0.8 * np.exp(0.05 * stiffness), 0.1 * np.exp(0.2 * damping)
        return 1.0 / np.sqrt((1.0 - ratio**2) ** 2 + (2.0 * share * ratio) ** 2)

    return given(
        f"resonance, T = {level:g}", "oscillator", level, gain,
        lambda *u: [factor * gain(*u) for factor in (0.1, 0.08, 0.06, 0.04, 0.02)],
        known=[0, 1], smooth=True,
    )  # fmt: skip


def exchangeable(units: int, missions: int, shared: float, level: float) -> Hard:
    """Normal responses of several units and missions, correlated by a shared input."""
    return given(
        f"{units} units, {missions} missions, T = {level:g}", "system", level,
        lambda v: shared * v, [math.sqrt(1.0 - shared**2)], smooth=True, units=units,
        missions=missions, shared=1,
    )  # fmt: skip


def curved_units(level: float) -> Hard:
    """Four units, bent in the shared input."""
    return given(
        f"4 curved units, T = {level:g}", "system", level, lambda v: 0.4 * v**2 + 0.5 * v, [1.0],
        smooth=True, units=4, shared=1,
    )  # fmt: skip


REAL = [
    oscillator(0.6), resonance(4.0), frame(10.0), panel(1e-6), beam(0.0),
    exchangeable(4, 3, 0.8, 6.0), curved_units(0.5),
    given(
        "curved, nearly all fail", "pf near one", -1.5, lambda u: 0.3 * u**2, [1.0], known=[1],
        smooth=True,
    ),
]  # fmt: skip

# outliers, noise, failed and infinite runs, digits


def pseudo_random(u: Array) -> Array:
    """Return uniform values that look independent of u, and of everything smooth in it."""
    return np.modf(1e5 * special.ndtr(u))[0]


def noisy(x: Array) -> Array:
    """Return a linear response with noise of a size that another input sets."""
    noise = special.ndtri(np.clip(pseudo_random(x[:, 2]), 1e-12, 1.0 - 1e-12))
    return x[:, 0] + 0.3 * np.exp(0.3 * x[:, 1]) * noise


def now_and_then(name: str, kind: str, share: float, value: float) -> Hard:
    """A sum of two inputs, and for a share of the runs something else; T = 3."""
    regular = (1.0 - share) * tail(3.0 / ROOT_2)
    return Hard(
        name, kind, 3,
        lambda x: np.where(pseudo_random(x[:, 2]) < share, value, x[:, 0] + x[:, 1]), 3.0,
        # NaN, a failed run, is neither
        lambda: regular + (0.0 if value <= 3.0 else share),
        safe=lambda: regular + (share if value > 3.0 else 0.0),
    )  # fmt: skip


def past(edge: float, value: float) -> Callable[[Array], Array]:
    """Return the function that is its argument up to an edge, and a value beyond."""
    return lambda u: np.where(u > edge, value, u)


def infinite(edge: float, level: float, d: int) -> Hard:
    """+inf beyond an edge of one input, in and beside the failure region."""
    return given(
        f"+inf beyond {edge:g}, {d} inputs", "infinite runs", level,
        lambda u: np.where(u > edge, np.inf, 0.0), [1.0] * (d - 1), breaks=[edge],
    )  # fmt: skip


def broken(edge: float, level: float) -> Hard:
    """Runs fail beyond an edge."""
    name = f"failed runs beyond {edge:g}"
    return given(name, "failed runs", level, past(edge, np.nan), [1.0], breaks=[edge])


def offset(base: float, scale: float, beta: float) -> Hard:
    """A small change of a large number, as far as digits tell it."""
    unit = float(np.spacing(base))
    steps = round(beta * scale / unit)
    # y is a multiple of the unit; it exceeds base + steps units half a unit later
    edge = (steps + 0.5) * unit / scale
    return Hard(
        f"{base:g} + {scale:g} u", "digits", 1, lambda x: base + scale * x[:, 0],
        base + steps * unit, lambda: tail(edge),
    )  # fmt: skip


BAD = [
    now_and_then("1% of runs are -140, T = 3", "outliers", 0.01, -140.0),
    Hard(
        "1, but 0.01 of runs are -140", "outliers", 2,
        lambda x: np.where(pseudo_random(x[:, 1]) < 0.01, -140.0, 1.0), 0.0, lambda: 0.99,
    ),
    Hard(
        "noise that varies, T = 3", "noise", 3, noisy, 3.0,
        lambda: average(lambda b: special.ndtr(-3.0 / np.sqrt(1.0 + 0.09 * np.exp(0.6 * b)))),
    ),
    infinite(2.5, 4.0, 2),
    given(
        "1 / (3 - u), T = 1.5", "infinite runs", 1.5,
        lambda u: np.where(u >= 3.0, np.inf, 1.0 / np.maximum(3.0 - u, 1e-300)), [0.1],
        breaks=[3.0],
    ),
    given("-inf beyond 2", "infinite runs", 4.0, past(2.0, -np.inf), [1.0], breaks=[2.0]),
    broken(2.5, 4.0),
    now_and_then("2% of runs fail", "failed runs", 0.02, math.nan),
    offset(1e12, 1e-3, 3.0), offset(1e6, 1e-3, 4.0),
]  # fmt: skip

PROBLEMS = [*SMOOTH, *ROUGH, *SEVERAL, *SHAPED, *REAL, *BAD]
