"""Outliers, noise, failed and infinite runs, and digits that are lost."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import special

from validation.no_false_confidence.hard import ROOT_2, Array, Hard, given
from validation.no_false_confidence.truths import average, tail


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
