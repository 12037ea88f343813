"""Problems on which a method may be wrong without knowing, each with its exact answer.

Most are functions of independent standard normal variables. `PROBLEMS` is the list; each entry
says what kind of trouble it holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import special, stats

import uqfold
from uqfold.problems.criterion import Criterion
from validation.no_false_confidence import truths
from validation.no_false_confidence.truths import average, pieces, tail

Array = Any
TRUTH = 1e-3
"""Relative error that no truth exceeds."""


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
            return uqfold.Problem(
                self.response, inputs=self.inputs(), units=self.units, name=self.name
            )
        marginals = [stats.norm() for _ in range(self.d)]
        return uqfold.Problem(
            self.response,
            shared=marginals[: self.shared] or None,
            individual=marginals[self.shared :],
            units=self.units,
            name=self.name,
            names=[f"u{i}" for i in range(self.d)],
        )


def pseudo_random(u: Array) -> Array:
    """Return uniform values that look independent of u, and of everything smooth in it."""
    return np.modf(1e5 * special.ndtr(u))[0]


# ---------------------------------------------------------------------------------------------
# linear, and bent a little
# ---------------------------------------------------------------------------------------------


def linear(d: int, pf: float) -> Hard:
    """A weighted sum; its reliability index is the threshold."""
    weights = np.arange(1.0, d + 1.0) ** -0.5
    weights /= math.sqrt(float(weights @ weights))
    beta = float(-special.ndtri(pf))
    return Hard(
        f"linear, {d} inputs, {pf:g}", "linear", d, lambda x: x @ weights, beta,
        lambda: tail(beta), smooth=d <= 10,
    )  # fmt: skip


def mild(d: int, threshold: float, curvature: float) -> Hard:
    """All inputs matter alike, each bent a little."""
    slope = 1.0 / math.sqrt(d)
    return Hard(
        f"mildly curved, {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: slope * x.sum(axis=1) + curvature * (x**2).sum(axis=1), threshold,
        lambda: truths.curved_sum(threshold, d, slope, curvature), smooth=d <= 10,
    )  # fmt: skip


def bent(d: int, directions: int, threshold: float, curvature: float) -> Hard:
    """Linear in the first input, curved in some of the others, without the rest."""
    return Hard(
        f"curved in {directions} of {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: x[:, 0] + curvature * (x[:, 1 : directions + 1] ** 2).sum(axis=1), threshold,
        lambda: truths.bent(threshold, curvature, directions), smooth=d <= 10,
    )  # fmt: skip


def sphere(d: int, pf: float) -> Hard:
    """Failure all around."""
    return Hard(
        f"|x|^2, {d} inputs, {pf:g}", "failure all around", d, lambda x: (x**2).sum(axis=1),
        truths.chi_square_level(pf, d), lambda: pf, smooth=d <= 10,
    )  # fmt: skip


def exponentials(d: int, sigma: float, threshold: float) -> Hard:
    """A sum of exponentials of normal variables: one large term is enough."""
    return Hard(
        f"{d} exponentials, sigma = {sigma:g}", "heavy tails", d,
        lambda x: np.exp(sigma * x).sum(axis=1), threshold,
        lambda: truths.sum_of_exponentials(threshold, d, sigma), smooth=d <= 10,
    )  # fmt: skip


def waiting(d: int, pf: float) -> Hard:
    """A sum of exponential variables."""
    return Hard(
        f"{d} exponential variables, {pf:g}", "skewed inputs", d, lambda x: x.sum(axis=1),
        float(stats.gamma.isf(pf, d)), lambda: pf, smooth=d <= 10,
        inputs=lambda: [stats.expon() for _ in range(d)],
    )  # fmt: skip


def scaled(sigma: float, pf: float) -> Hard:
    """A response that spans many powers of ten."""
    beta = float(-special.ndtri(pf))
    return Hard(
        f"exp({sigma:g} u), {pf:g}", "scales", 3,
        lambda x: np.exp(sigma * x @ np.array([0.6, 0.64, 0.48])), math.exp(sigma * beta),
        lambda: pf, smooth=False,
    )  # fmt: skip


SMOOTH = [
    linear(1, 0.9), linear(2, 1e-8), linear(5, 1e-4), linear(10, 1e-6), linear(20, 1e-3),
    linear(50, 1e-4), linear(100, 1e-6),
    mild(2, 3.5, 0.1), mild(6, 4.0, 0.05), mild(10, 4.0, 0.03), mild(30, 4.5, 0.02),
    mild(49, 5.0, 0.02), mild(100, 6.5, 0.02),
    bent(2, 1, 3.0, 0.2), bent(5, 4, 6.0, 0.2), bent(8, 3, 5.0, -0.1), bent(100, 5, 5.5, 0.1),
    sphere(2, 1e-4), sphere(4, 1e-3), sphere(8, 1e-4), sphere(10, 1e-2), sphere(20, 1e-3),
    exponentials(2, 1.0, 22.0), exponentials(5, 0.5, 15.0), exponentials(20, 0.5, 35.0),
    exponentials(100, 0.5, 148.0),
    waiting(2, 1e-5), waiting(20, 1e-3), waiting(100, 1e-7),
    scaled(3.0, 1e-4), scaled(8.0, 1e-3),
]  # fmt: skip

# ---------------------------------------------------------------------------------------------
# sharp features, kinks, steps, plateaus, bands
# ---------------------------------------------------------------------------------------------


def sharp(power: int, factor: float, level: float, inert: int = 0) -> Hard:
    """A narrow valley of the limit state: safe only near u1 = 0."""
    return Hard(
        f"x2 - {factor:g} x1^{power}{f', {inert} inert' if inert else ''}", "sharp", 2 + inert,
        lambda x: x[:, 1] - factor * x[:, 0] ** power, level,
        lambda: average(lambda u: special.ndtr(-level - factor * u**power), step=1e-3),
    )  # fmt: skip


def kink(level: float) -> Hard:
    """|a| + b."""
    root = level / math.sqrt(2.0)
    return Hard(
        f"|a| + b, T = {level:g}", "kink", 2, lambda x: np.abs(x[:, 0]) + x[:, 1], level,
        lambda: 2.0 * pieces(lambda a: tail(level - a) if a > 0.0 else 0.0, 0.0, root),
    )  # fmt: skip


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


def rounded(level: float) -> Hard:
    """round(2 (x + y)) / 2, that is steps of one half."""
    cut = level + 0.25
    return Hard(
        f"round(2 (x + y)) / 2, T = {level:g}", "steps", 2,
        lambda x: np.round(2.0 * x.sum(axis=1)) / 2.0, level, lambda: tail(cut / math.sqrt(2.0)),
    )  # fmt: skip


def step(at: float, height: float, level: float, d: int) -> Hard:
    """A step at one input, beyond which the response is higher."""
    root = math.sqrt(d - 1.0)

    def pf() -> float:
        low, high = tail(level / root), tail((level - height) / root)
        return tail(at) * high + tail(-at) * low

    return Hard(
        f"step of {height:g} at {at:g}, {d} inputs", "steps", d,
        lambda x: x[:, 1:].sum(axis=1) + height * (x[:, 0] > at), level, pf,
    )  # fmt: skip


def plateau(top: float, level: float) -> Hard:
    """A response that saturates above the threshold and below it."""
    return Hard(
        f"clipped at {top:g}, T = {level:g}", "plateau", 2,
        lambda x: np.clip(x.sum(axis=1), -top, top), level,
        lambda: tail(level / math.sqrt(2.0)) if level < top else 0.0,
    )  # fmt: skip


def indicator(beta: float) -> Hard:
    """0 or 1, and nothing else."""
    return Hard(
        f"0 or 1 at {beta:g}", "plateau", 2, lambda x: (x[:, 0] > beta).astype(float), 0.5,
        lambda: tail(beta),
    )  # fmt: skip


def regimes(level: float) -> Hard:
    """Another law where one input is large: steeper, and the other way round."""

    def pf() -> float:
        return tail(-1.0) * tail(level) + tail(1.0) * tail((level - 1.0) / 2.0)

    return Hard(
        f"two regimes, T = {level:g}", "regimes", 2,
        lambda x: np.where(x[:, 0] < 1.0, x[:, 1], 1.0 - 2.0 * x[:, 1]), level, pf,
    )  # fmt: skip


def switched(level: float) -> Hard:
    """Three regimes by one input, continuous in the other ones."""

    def pf() -> float:
        first, last = tail(0.5), tail(0.5)
        middle = 1.0 - first - last
        return (
            first * tail(level / math.sqrt(3.0))
            + middle * tail((level - 0.5) / math.sqrt(2.0))
            + last * tail((level + 1.0) / math.sqrt(1.0))
        )

    def response(x: Array) -> Array:
        a, b, c, d = x.T
        return np.select([a < -0.5, a < 0.5], [b + c + d, 0.5 + b - c], d - 1.0)

    return Hard(f"three regimes, T = {level:g}", "regimes", 4, response, level, pf)


def band(centre: float, pf: float, d: int) -> Hard:
    """A bump that exceeds T only in a thin band of one input."""
    density = math.exp(-0.5 * centre**2) / math.sqrt(2.0 * math.pi)
    half = 0.5 * pf / density
    width = half / math.sqrt(math.log(2.0))
    return Hard(
        f"band at {centre:g}, {pf:g}, {d} inputs", "thin band", d,
        lambda x: np.exp(-(((x[:, 0] - centre) / width) ** 2)), 0.5,
        lambda: tail(centre - half) - tail(centre + half),
    )  # fmt: skip


def band_beside(pf: float) -> Hard:
    """A thin band beside a smooth response that never comes near T."""
    half = 0.5 * pf * math.sqrt(2.0 * math.pi) * math.exp(0.5 * 1.5**2)
    return Hard(
        f"tanh and a band, {pf:g}", "thin band", 2,
        lambda x: np.tanh(x[:, 1]) + 5.0 * (np.abs(x[:, 0] - 1.5) < half), 2.0,
        lambda: (tail(1.5 - half) - tail(1.5 + half)) * tail(-10.0),
    )  # fmt: skip


ROUGH = [
    sharp(4, 100.0, 2.5), sharp(6, 30.0, 3.0), sharp(4, 100.0, 2.5, inert=3),
    kink(3.0), kink(5.0), largest(2, 3.0), largest(10, 4.0), hockey(6.0),
    hockey(20.0),
    rounded(3.0), step(2.0, 3.0, 4.0, 2), step(3.5, 6.0, 5.0, 4), step(0.5, 1.0, 3.0, 6),
    plateau(1.0, 0.5), plateau(4.0, 3.9), plateau(2.0, 2.5), indicator(1.5),
    regimes(3.0), switched(4.0),
    band(2.5, 4e-5, 1), band(1.0, 1e-3, 3), band_beside(1e-4),
]  # fmt: skip


# ---------------------------------------------------------------------------------------------
# several failure regions
# ---------------------------------------------------------------------------------------------


def square(level: float, d: int) -> Hard:
    """Two regions, one on either side."""
    return Hard(
        f"u^2 + 0.1 u, {d} inputs, T = {level:g}", "two regions", d,
        lambda x: x[:, 0] ** 2 + 0.1 * x[:, 0], level,
        lambda: tail(-0.05 + math.sqrt(level + 0.0025)) + tail(0.05 + math.sqrt(level + 0.0025)),
        smooth=True,
    )  # fmt: skip


def four(level: float) -> Hard:
    """Four regions, one on either side of two inputs."""
    inside = 1.0 - 2.0 * tail(level)
    return Hard(
        f"max(|a|, |b|), T = {level:g}", "four regions", 2,
        lambda x: np.abs(x).max(axis=1), level, lambda: 2.0 * tail(level) * (1.0 + inside),
    )  # fmt: skip


def two_sides(near: float, far: float, d: int) -> Hard:
    """One region near, and one of another input a little further, at an angle."""
    return Hard(
        f"regions at {near:g} and {far:g}, {d} inputs", "two regions", d,
        lambda x: np.maximum(x[:, 0] - near, (x[:, 1:].sum(axis=1)) / math.sqrt(d - 1.0) - far),
        0.0, lambda: tail(near) + tail(far) - tail(near) * tail(far),
    )  # fmt: skip


def bent_kink() -> Hard:
    """Two regions whose borders bend towards each other, and meet."""
    end = math.sqrt(12.0)
    return Hard(
        "|b| + a^2 / 4", "two regions", 2,
        lambda x: np.abs(x[:, 1]) + 0.25 * x[:, 0] ** 2, 3.0,
        lambda: pieces(lambda a: min(1.0, 2.0 * tail(3.0 - 0.25 * a * a)), -end, end),
    )  # fmt: skip


def soft_four(level: float) -> Hard:
    """A smooth response with four regions: sums of cosh."""

    def pf() -> float:
        def beyond(a: Any) -> Any:
            rest = level - np.cosh(a)
            edge = np.arccosh(np.maximum(rest, 1.0))
            return np.where(rest <= 1.0, 1.0, 2.0 * special.ndtr(-edge))

        end = math.acosh(level - 1.0)
        return pieces(lambda a: float(beyond(a)), -end, end)

    return Hard(
        f"cosh a + cosh b, T = {level:g}", "four regions", 2,
        lambda x: np.cosh(x).sum(axis=1), level, pf, smooth=True,
    )  # fmt: skip


def rare_second(d: int) -> Hard:
    """A cliff of an input that matters nowhere else holds most of the failures."""
    return Hard(
        f"hidden second region, {d} inputs", "hidden region", d,
        lambda x: np.maximum(x[:, 0] / 4.0, 4.0 * (x[:, 1] - 2.75)), 1.0,
        lambda: tail(4.0) + tail(3.0) - tail(4.0) * tail(3.0),
    )  # fmt: skip


SEVERAL = [
    square(9.0, 1), square(16.0, 4), four(3.0), four(4.5), two_sides(3.0, 3.2, 2),
    two_sides(3.5, 3.0, 6), bent_kink(), soft_four(16.0), rare_second(2), rare_second(5),
]  # fmt: skip


# ---------------------------------------------------------------------------------------------
# bounded, heavy-tailed and dependent inputs
# ---------------------------------------------------------------------------------------------


def uniforms(d: int, level: float) -> Hard:
    """A sum of uniform variables, near its upper end or beyond."""
    return Hard(
        f"{d} uniform variables, T = {level:g}", "bounded inputs", d, lambda x: x.sum(axis=1),
        level, lambda: truths.sum_of_uniforms(level, d), smooth=level < d,
        inputs=lambda: [stats.uniform() for _ in range(d)],
    )  # fmt: skip


def student(df: float, level: float) -> Hard:
    """A sum of two Student variables."""
    law = stats.t(df)

    def pf() -> float:
        x = np.sinh(np.linspace(-30.0, 30.0, 600_001))
        value = law.pdf(x) * law.sf(level - x)
        return float(np.trapezoid(value, x))

    return Hard(
        f"two Student variables of {df:g}", "heavy tails", 2, lambda x: x.sum(axis=1), level, pf,
        inputs=lambda: [stats.t(df), stats.t(df)],
    )  # fmt: skip


def pareto(level: float) -> Hard:
    """A normal variable and one with a power tail."""
    law = stats.pareto(4.0)
    return Hard(
        f"Pareto and normal, T = {level:g}", "heavy tails", 2, lambda x: x.sum(axis=1), level,
        lambda: pieces(lambda u: float(law.sf(level - u)), level - 1.0),
        inputs=lambda: [stats.pareto(4.0), stats.norm()],
    )  # fmt: skip


def beta_product() -> Hard:
    """A product of bounded variables: sqrt(U) of two uniform ones."""

    def pf() -> float:
        # P(sqrt(U) sqrt(V) > t) = 1 - t^2 (1 - log t^2)
        s = 0.98**2
        return 1.0 - s * (1.0 - math.log(s))

    return Hard(
        "product of beta variables", "bounded inputs", 2, lambda x: x.prod(axis=1), 0.98, pf,
        inputs=lambda: [stats.beta(2.0, 1.0), stats.beta(2.0, 1.0)], smooth=True,
    )  # fmt: skip


def joined(marginals: list[Any], copula: Any) -> Any:
    """Return a joint distribution of OpenTURNS."""
    import openturns as ot

    return ot.JointDistribution([ot.Distribution(one) for one in marginals], copula)


def correlated(rho: float, level: float) -> Hard:
    """A sum of two correlated normal variables."""

    def inputs() -> Any:
        import openturns as ot

        return ot.Normal([0.0, 0.0], [1.0, 1.0], ot.CorrelationMatrix(2, [1.0, rho, rho, 1.0]))

    return Hard(
        f"correlated normals, T = {level:g}", "dependent inputs", 2, lambda x: x.sum(axis=1), level,
        lambda: tail(level / math.sqrt(2.0 + 2.0 * rho)), inputs=inputs, smooth=True,
    )  # fmt: skip


def correlated_product(rho: float, beta: float) -> Hard:
    """A product of two correlated lognormal variables."""

    def inputs() -> Any:
        import openturns as ot

        matrix = ot.CorrelationMatrix(2, [1.0, rho, rho, 1.0])
        return joined([ot.LogNormal(0.0, 0.3)] * 2, ot.NormalCopula(matrix))

    return Hard(
        "product of correlated lognormals", "dependent inputs", 2, lambda x: x.prod(axis=1),
        math.exp(0.3 * math.sqrt(2.0 + 2.0 * rho) * beta), lambda: tail(beta), inputs=inputs,
        smooth=True,
    )  # fmt: skip


def clayton_inputs() -> Any:
    """Return two standard normal variables joined by a Clayton copula."""
    import openturns as ot

    return joined([ot.Normal(), ot.Normal()], ot.ClaytonCopula(2.0))


SHAPED = [
    uniforms(2, 1.9), uniforms(3, 2.95), uniforms(6, 5.0), student(3.0, 20.0),
    student(5.0, 8.0), pareto(9.0), beta_product(), correlated(0.7, 6.0),
    correlated_product(0.5, 4.0),
    Hard(
        "sum under a Clayton copula", "dependent inputs", 2, lambda x: x.sum(axis=1), 4.0,
        lambda: truths.clayton_sum(4.0, 2.0), inputs=clayton_inputs, smooth=True,
    ),
    Hard(
        "smaller under a Clayton copula", "dependent inputs", 2, lambda x: -x.max(axis=1), 2.0,
        lambda: truths.clayton(tail(2.0), tail(2.0), 2.0), inputs=clayton_inputs,
    ),
]  # fmt: skip


# ---------------------------------------------------------------------------------------------
# oscillators, frames, panels, systems
# ---------------------------------------------------------------------------------------------


def oscillator(level: float) -> Hard:
    """Six inputs: displacement of an oscillator under a pulse, against its yield point."""

    def factor(c: Any, m: Any, t: Any) -> Any:
        stiffness, mass, time = 1.1 * (1.0 + 0.05 * c), 1.0 + 0.05 * m, 1.0 + 0.2 * t
        frequency = np.sqrt(stiffness / mass)
        return 2.0 / stiffness * np.abs(np.sin(0.5 * frequency * time))

    def response(x: Array) -> Array:
        c, m, t, force, yielding, damping = x.T
        reduced = 1.0 - 0.01 * damping
        return factor(c, m, t) * (1.0 + 0.2 * force) * 1.0 * reduced - 3.0 * (0.5 + 0.05 * yielding)

    def conditional(c: Any, m: Any, t: Any) -> Any:
        # force and damping enter as a product: the small one by a Gauss rule
        nodes, weights = np.polynomial.hermite_e.hermegauss(7)
        weights = weights / weights.sum()
        total = 0.0
        for node, weight in zip(nodes, weights, strict=True):
            a = factor(c, m, t) * (1.0 - 0.01 * node)
            mean, std = a - 1.5, np.sqrt((0.2 * a) ** 2 + 0.15**2)
            total = total + weight * special.ndtr((mean - level) / std)
        return total

    return Hard(
        f"oscillator, T = {level:g}", "oscillator", 6, response, level,
        lambda: average(conditional, 3, 0.25), smooth=True,
    )  # fmt: skip


def frame(level: float) -> Hard:
    """Nine inputs: sway of a frame, six loads over two stiffnesses and a length."""
    loads = np.array([1.0, 0.8, 0.6, 0.5, 0.3, 0.2])

    def response(x: Array) -> Array:
        force = (loads * (1.0 + 0.25 * x[:, :6])).sum(axis=1)
        return force * _frame(x[:, 6], x[:, 7], x[:, 8])

    def conditional(a: Any, b: Any, c: Any) -> Any:
        spread = 0.25 * math.sqrt(float(loads @ loads))
        return special.ndtr((loads.sum() - level / _frame(a, b, c)) / spread)

    return Hard(
        f"frame, T = {level:g}", "frame", 9, response, level,
        lambda: average(conditional, 3, 0.25), smooth=True,
    )  # fmt: skip


def _frame(column: Any, beam: Any, length: Any) -> Any:
    """Sway of the frame under a unit load."""
    return (1.0 + 0.02 * length) ** 3 * (np.exp(-0.1 * column) + 0.5 * np.exp(-0.15 * beam))


def panel(pf: float) -> Hard:
    """Eight inputs: utilisation of a panel, a product of powers of lognormal variables."""
    powers = np.array([1.0, -2.0, 1.5, 0.5, -1.0, 0.3, -0.2, 1.0])
    spreads = np.array([0.2, 0.05, 0.1, 0.1, 0.15, 0.2, 0.1, 0.05])
    slope = powers * spreads
    length = math.sqrt(float(slope @ slope))
    beta = float(-special.ndtri(pf))
    return Hard(
        f"panel, {pf:g}", "panel", 8, lambda x: np.exp(x @ slope), math.exp(length * beta),
        lambda: pf, smooth=True,
    )  # fmt: skip


def beam(level: float) -> Hard:
    """Ten inputs: a moment of seven loads against a resistance that is a product."""
    loads = np.linspace(0.4, 1.0, 7)

    def resistance(a: Any, b: Any, c: Any) -> Any:
        return 8.0 * np.exp(0.08 * a + 0.05 * b) * (1.0 + 0.04 * c)

    def response(x: Array) -> Array:
        return (loads * (1.0 + 0.2 * x[:, :7])).sum(axis=1) - resistance(*x[:, 7:].T)

    def conditional(a: Any, b: Any, c: Any) -> Any:
        spread = 0.2 * math.sqrt(float(loads @ loads))
        return special.ndtr((loads.sum() - resistance(a, b, c) - level) / spread)

    return Hard(
        f"beam, T = {level:g}", "frame", 10, response, level,
        lambda: average(conditional, 3, 0.25), smooth=True,
    )  # fmt: skip


def resonance(level: float) -> Hard:
    """Steady amplitude of a damped oscillator near its resonance, seven inputs."""

    def gain(stiffness: Any, damping: Any) -> Any:
        ratio = 0.8 * np.exp(0.05 * stiffness)
        share = 0.1 * np.exp(0.2 * damping)
        return 1.0 / np.sqrt((1.0 - ratio**2) ** 2 + (2.0 * share * ratio) ** 2)

    weights = np.array([1.0, 0.8, 0.6, 0.4, 0.2])

    def response(x: Array) -> Array:
        return gain(x[:, 0], x[:, 1]) * (1.0 + 0.1 * x[:, 2:] @ weights)

    def conditional(a: Any, b: Any) -> Any:
        spread = 0.1 * math.sqrt(float(weights @ weights))
        return special.ndtr((1.0 - level / gain(a, b)) / spread)

    return Hard(
        f"resonance, T = {level:g}", "oscillator", 7, response, level,
        lambda: average(conditional, 2, 0.05), smooth=True,
    )  # fmt: skip


def exchangeable(units: int, missions: int, shared: float, level: float) -> Hard:
    """Normal responses of several units and missions, correlated by a shared input."""
    own = math.sqrt(1.0 - shared**2)
    return Hard(
        f"{units} units, {missions} missions, T = {level:g}", "system", 2,
        lambda x: shared * x[:, 0] + own * x[:, 1], level,
        lambda: truths.normal_of_exchangeable(level, units, shared, missions), smooth=True,
        units=units, missions=missions, shared=1,
    )  # fmt: skip


def curved_units(level: float) -> Hard:
    """Four units, bent in the shared input; nearly all systems fail."""

    def conditional(v: Any) -> Any:
        works = special.log_ndtr(level - 0.4 * v**2 - 0.5 * v)
        return -np.expm1(4.0 * works)

    return Hard(
        f"4 curved units, T = {level:g}", "system", 2,
        lambda x: x[:, 1] + 0.4 * x[:, 0] ** 2 + 0.5 * x[:, 0], level,
        lambda: average(conditional), smooth=True, units=4, shared=1,
    )  # fmt: skip


REAL = [
    oscillator(0.0), oscillator(0.6), resonance(4.0), frame(8.5), frame(10.0), panel(1e-3),
    panel(1e-6), beam(0.0), beam(-1.0), exchangeable(4, 1, 0.6, 3.5), exchangeable(4, 3, 0.8, 6.0),
    curved_units(0.5), curved_units(4.0),
    Hard(
        "curved, nearly all fail", "pf near one", 2, lambda x: x[:, 0] + 0.3 * x[:, 1] ** 2, -1.5,
        lambda: average(lambda u: special.ndtr(1.5 + 0.3 * u**2)), smooth=True,
    ),
]  # fmt: skip


# ---------------------------------------------------------------------------------------------
# outliers, noise, failed and infinite runs, digits
# ---------------------------------------------------------------------------------------------


def outliers(share: float, value: float, level: float) -> Hard:
    """A sum of two inputs, and now and then something else."""

    def response(x: Array) -> Array:
        return np.where(pseudo_random(x[:, 2]) < share, value, x[:, 0] + x[:, 1])

    def pf() -> float:
        return share * float(value > level) + (1.0 - share) * tail(level / math.sqrt(2.0))

    return Hard(
        f"{share:.0%} of runs are {value:g}, T = {level:g}", "outliers", 3, response, level, pf
    )


def constant_but(share: float, value: float) -> Hard:
    """1 everywhere, but for a few runs; T = 0."""
    return Hard(
        f"1, but {share:g} of runs are {value:g}", "outliers", 2,
        lambda x: np.where(pseudo_random(x[:, 1]) < share, value, 1.0), 0.0, lambda: 1.0 - share,
    )  # fmt: skip


def noisy(level: float) -> Hard:
    """A linear response with noise that grows with the response."""

    def response(x: Array) -> Array:
        noise = special.ndtri(np.clip(pseudo_random(x[:, 2]), 1e-12, 1.0 - 1e-12))
        return x[:, 0] + 0.3 * np.exp(0.3 * x[:, 1]) * noise

    def pf() -> float:
        return average(lambda b: special.ndtr(-level / np.sqrt(1.0 + 0.09 * np.exp(0.6 * b))))

    return Hard(f"noise that varies, T = {level:g}", "noise", 3, response, level, pf)


def infinite(edge: float, level: float, d: int) -> Hard:
    """+inf beyond an edge of one input, in and beside the failure region."""
    root = math.sqrt(d - 1.0)
    return Hard(
        f"+inf beyond {edge:g}, {d} inputs", "infinite runs", d,
        lambda x: np.where(x[:, 0] > edge, np.inf, x[:, 1:].sum(axis=1)), level,
        lambda: tail(edge) + tail(-edge) * tail(level / root),
    )  # fmt: skip


def pole(level: float) -> Hard:
    """A response that goes to infinity at an edge, beyond which it is +inf."""
    return Hard(
        f"1 / (3 - u), T = {level:g}", "infinite runs", 2,
        lambda x: np.where(
            x[:, 0] >= 3.0, np.inf, 1.0 / np.maximum(3.0 - x[:, 0], 1e-300) + 0.1 * x[:, 1]
        ),
        level, lambda: pieces(
            lambda b: tail(3.0 - 1.0 / (level - 0.1 * b)) if level > 0.1 * b else 1.0
        ),
    )  # fmt: skip


def never(edge: float, level: float) -> Hard:
    """-inf, which works, where failure would be expected."""

    def pf() -> float:
        return pieces(lambda a: tail(level - a) if a < edge else 0.0, edge)

    return Hard(
        f"-inf beyond {edge:g}", "infinite runs", 2,
        lambda x: np.where(x[:, 0] > edge, -np.inf, x[:, 0] + x[:, 1]), level, pf,
    )  # fmt: skip


def broken(edge: float, level: float) -> Hard:
    """Runs fail beyond an edge."""

    def safe() -> float:
        return pieces(lambda a: tail(level - a) if a < edge else 0.0, edge)

    return Hard(
        f"failed runs beyond {edge:g}", "failed runs", 2,
        lambda x: np.where(x[:, 0] > edge, np.nan, x[:, 0] + x[:, 1]), level,
        lambda: tail(edge) + safe(), safe=safe,
    )  # fmt: skip


def now_and_then(share: float, level: float) -> Hard:
    """Runs fail now and then, wherever they are."""
    regular = tail(level / math.sqrt(2.0))
    return Hard(
        f"{share:.0%} of runs fail", "failed runs", 3,
        lambda x: np.where(pseudo_random(x[:, 2]) < share, np.nan, x[:, 0] + x[:, 1]), level,
        lambda: share + (1.0 - share) * regular, safe=lambda: (1.0 - share) * regular,
    )  # fmt: skip


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
    outliers(0.01, -140.0, 3.0), outliers(0.01, 140.0, 3.0), constant_but(0.01, -140.0),
    noisy(3.0), infinite(2.5, 4.0, 2), infinite(3.5, 3.0, 4), pole(1.5), never(2.0, 4.0),
    broken(2.5, 4.0), broken(4.0, 5.0), now_and_then(0.02, 3.0), offset(1e12, 1e-3, 3.0),
    offset(1e9, 1e-3, 3.0), offset(1e6, 1e-3, 4.0),
]  # fmt: skip

PROBLEMS = [*SMOOTH, *ROUGH, *SEVERAL, *SHAPED, *REAL, *BAD]
