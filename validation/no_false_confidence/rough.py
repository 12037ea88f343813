"""Responses with sharp features, kinks, steps, plateaus, bands, and several failure regions."""

from __future__ import annotations

import math

import numpy as np
from scipy import optimize, special, stats

from validation.no_false_confidence import truths
from validation.no_false_confidence.hard import ROOT_2, Array, Hard, given
from validation.no_false_confidence.truths import average, tail


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


def ball(radius: float, distance: float, level: float, d: int) -> Hard:
    """A half-space, and on the other side a ball that holds far more."""

    def response(x: Array) -> Array:
        away = x + distance * np.eye(d)[0]
        return np.maximum(x[:, 0] - level, radius - np.sqrt((away**2).sum(axis=1)))

    return Hard(
        f"half-space, and a ball of {radius:g} at {distance:g}, {d} inputs", "hidden region", d,
        response, 0.0,
        lambda: tail(level) + float(stats.ncx2.cdf(radius**2, d, distance**2)),
    )  # fmt: skip


def ring(radius: float, half: float) -> Hard:
    """A thin ring."""
    return Hard(
        f"ring {2.0 * half:g} wide at {radius:g}", "thin band", 2,
        lambda x: half - np.abs(np.hypot(x[:, 0], x[:, 1]) - radius), 0.0,
        lambda: math.exp(-0.5 * (radius - half) ** 2) - math.exp(-0.5 * (radius + half) ** 2),
    )  # fmt: skip


def ridge(width: float) -> Hard:
    """A ridge that brings a limit state nearer along a strip."""
    return given(
        f"ridge {width:g} wide", "sharp", 3.2,
        lambda u: 2.0 * np.exp(-(((u - 2.0) / width) ** 2)), [1.0],
    )  # fmt: skip


def slanted_ridge() -> Hard:
    """The ridge 0.1 wide, along no input."""
    ahead, aside = np.ones(3) / math.sqrt(3.0), np.array([1.0, -1.0, 0.0]) / ROOT_2

    def height(u: Array) -> Array:
        return np.asarray(2.0 * np.exp(-(((u - 2.0) / 0.1) ** 2)))

    return Hard(
        "ridge 0.1 wide, slanted", "sharp", 3, lambda x: x @ ahead + height(x @ aside), 3.2,
        lambda: average(lambda u: special.ndtr(height(u) - 3.2), breaks=[1.5, 2.0, 2.5]),
    )  # fmt: skip


def bump_before() -> Hard:
    """A bump between the origin and the design point, to which slopes lead past it."""
    level = 3.5333

    def height(a: Array) -> Array:
        return np.asarray(a + 1.7 * np.exp(-((1.7 * (a - 1.82)) ** 2)))

    def exact() -> float:
        begins, ends, again = (
            optimize.brentq(lambda a: float(height(a)) - level, *between)
            for between in ((1.5, 1.99), (1.99, 2.5), (2.5, 4.0))
        )
        return tail(begins) - tail(ends) + tail(again)

    return Hard(
        "a bump before the limit", "hidden region", 5, lambda x: height(x[:, 1]), level, exact
    )  # fmt: skip


def gap_beyond() -> Hard:
    """A narrow gap among the failures, straight behind where they begin."""
    return Hard(
        "a gap of 0.2 beyond the limit", "thin band", 2,
        lambda x: np.where(np.abs(x[:, 0] - 3.2) < 0.1, -1.0, x[:, 0]), 3.0,
        lambda: tail(3.0) - tail(3.1) + tail(3.3),
    )  # fmt: skip


def slab(half: float, distance: float, level: float) -> Hard:
    """A half-space, and a thin slab of another input."""
    share = tail(distance - half) - tail(distance + half)
    return Hard(
        f"half-space, and a slab {2.0 * half:g} wide at {distance:g}", "thin band", 3,
        lambda x: np.maximum(x[:, 0] - level, half - np.abs(x[:, 1] - distance)), 0.0,
        lambda: truths.either(tail(level), share),
    )  # fmt: skip


THIN = [
    ball(0.5, 2.5, 3.2, 3), ball(1.2, 3.0, 4.0, 6), ball(0.3, 1.5, 3.0, 2), ring(3.5, 0.1),
    ridge(0.1), ridge(0.5), slab(0.05, 2.5, 3.0), slab(0.05, 4.0, 3.5),
    slanted_ridge(), bump_before(), gap_beyond(),
    given("a sine of 8 u", "sharp", 3.2, lambda u: np.sin(8.0 * u), [1.0]),
    Hard(
        "stairs that stop at the limit", "steps", 2,
        lambda x: np.floor(2.0 * x[:, 0] + x[:, 1]) / 2.0, 3.0, lambda: tail(7.0 / math.sqrt(5.0)),
    ),
    given("two crests, T = 4.5", "two regions", 4.5, lambda u: -0.6 * (np.abs(u) - 2.0) ** 2 + 2.0,
          [1.0], breaks=[0.0]),
]  # fmt: skip


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
