"""Inputs that are bounded, heavy-tailed or dependent, and responses as engineers have them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import openturns as ot
from scipy import stats

from validation.no_false_confidence import truths
from validation.no_false_confidence.hard import Array, Hard, given
from validation.no_false_confidence.smooth import lognormal
from validation.no_false_confidence.truths import average, tail


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
