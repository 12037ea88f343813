"""Families of distributions mapped from and to standard-normal values in closed form.

Probabilities p are carried as the logarithms of the smaller ones, so that both tails keep their
digits to probabilities of 1e-300 and beyond: -log(1 - p) is a standard exponential variable, from
which most families follow by an elementary function.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from scipy import special

from uqfold.typing import FloatArray

Map: TypeAlias = Callable[[FloatArray], FloatArray]
Maps: TypeAlias = tuple[Map, Map]
"""From standard-normal values (n,), and back."""

_DEEP = 1e-10
"""Probabilities below which SciPy's quantiles of beta distributions are not relied on."""


def normal_of(below: FloatArray, above: FloatArray) -> FloatArray:
    """Standard-normal values of logarithms of lower and of upper probabilities."""
    smaller = special.ndtri_exp(np.minimum(below, above))
    return np.asarray(np.where(below < above, smaller, -smaller))


def _upper(u: FloatArray) -> FloatArray:
    """Return -log of the upper probability: standard exponential."""
    return np.asarray(-special.log_ndtr(-u))


def _of_upper(h: FloatArray) -> FloatArray:
    return np.asarray(-special.ndtri_exp(-h))


def _lower(u: FloatArray) -> FloatArray:
    """Return -log of the lower probability."""
    return np.asarray(-special.log_ndtr(u))


def _of_lower(h: FloatArray) -> FloatArray:
    return np.asarray(special.ndtri_exp(-h))


def _located(origin: float, scale: float, from_normal: Map, to_normal: Map) -> Maps:
    """Shift and stretch the standard form of a family."""
    return (
        lambda u: origin + scale * from_normal(u),
        lambda x: to_normal((x - origin) / scale),
    )


def _by_tails(lower: Map, upper: Map, below: Map, above: Map) -> Maps:
    """Maps from quantiles of lower and of upper probabilities, and from both probabilities."""

    def from_normal(u: FloatArray) -> FloatArray:
        low = u <= 0.0
        x = np.empty(u.shape)
        x[low] = lower(special.ndtr(u[low]))
        x[~low] = upper(special.ndtr(-u[~low]))
        return x

    def to_normal(x: FloatArray) -> FloatArray:
        p, q = below(x), above(x)
        u = special.ndtri(np.minimum(p, q))
        return np.asarray(np.where(p < q, u, -u))

    return from_normal, to_normal


def _normal(d: Any) -> Maps:
    mean, std = d.getParameter()
    return _located(mean, std, np.asarray, np.asarray)


def _lognormal(d: Any) -> Maps:
    origin, mu, sigma = d.getGamma(), d.getMuLog(), d.getSigmaLog()
    return (
        lambda u: origin + np.exp(mu + sigma * u),
        lambda x: (np.log(x - origin) - mu) / sigma,
    )


def _uniform(d: Any) -> Maps:
    low, high = d.getA(), d.getB()
    width = high - low
    return _by_tails(
        lambda p: low + width * p,
        lambda q: high - width * q,
        lambda x: (x - low) / width,
        lambda x: (high - x) / width,
    )


def _exponential(d: Any) -> Maps:
    return _located(d.getGamma(), 1.0 / d.getLambda(), _upper, _of_upper)


def _weibull_min(d: Any) -> Maps:
    k = d.getAlpha()
    return _located(
        d.getGamma(), d.getBeta(), lambda u: _upper(u) ** (1.0 / k), lambda z: _of_upper(z**k)
    )


def _weibull_max(d: Any) -> Maps:
    k = d.getAlpha()
    return _located(
        d.getGamma(), -d.getBeta(), lambda u: _lower(u) ** (1.0 / k), lambda z: _of_lower(z**k)
    )


def _rayleigh(d: Any) -> Maps:
    return _located(
        d.getGamma(),
        d.getBeta(),
        lambda u: np.sqrt(2.0 * _upper(u)),
        lambda z: _of_upper(0.5 * z * z),
    )


def _gumbel(d: Any) -> Maps:
    return _located(
        d.getGamma(),
        d.getBeta(),
        lambda u: -np.log(_lower(u)),
        lambda z: _of_lower(np.exp(-z)),
    )


def _frechet(d: Any) -> Maps:
    k = d.getAlpha()
    return _located(
        d.getGamma(), d.getBeta(), lambda u: _lower(u) ** (-1.0 / k), lambda z: _of_lower(z**-k)
    )


def _pareto(d: Any) -> Maps:
    k = d.getAlpha()
    return _located(
        d.getGamma(),
        d.getBeta(),
        lambda u: np.exp(_upper(u) / k),
        lambda z: _of_upper(k * np.log(z)),
    )


def _logistic(d: Any) -> Maps:
    return _located(
        d.getMu(),
        d.getBeta(),
        lambda u: _upper(u) - _lower(u),
        lambda z: normal_of(-np.logaddexp(0.0, -z), -np.logaddexp(0.0, z)),
    )


def _gamma(d: Any) -> Maps:
    k, origin, scale = d.getK(), d.getGamma(), 1.0 / d.getLambda()
    return _by_tails(
        lambda p: origin + scale * special.gammaincinv(k, p),
        lambda q: origin + scale * special.gammainccinv(k, q),
        lambda x: special.gammainc(k, (x - origin) / scale),
        lambda x: special.gammaincc(k, (x - origin) / scale),
    )


def _beta(d: Any) -> Maps:
    a, b, low, high = d.getAlpha(), d.getBeta(), d.getA(), d.getB()
    width = high - low
    return _by_tails(
        lambda p: low + width * _beta_quantile(a, b, p),
        lambda q: high - width * _beta_quantile(b, a, q),
        lambda x: special.betainc(a, b, (x - low) / width),
        lambda x: special.betainc(b, a, (high - x) / width),
    )


def _triangular(d: Any) -> Maps:
    low, high = d.getA(), d.getB()
    width = high - low
    mode = (d.getM() - low) / width

    def quantile(p: FloatArray, top: float) -> FloatArray:
        return np.where(p < top, np.sqrt(p * top), 1.0 - np.sqrt((1.0 - p) * (1.0 - top)))

    def below(z: FloatArray, top: float) -> FloatArray:
        return np.where(z < top, z * z / top, 1.0 - (1.0 - z) ** 2 / (1.0 - top))

    return _by_tails(
        lambda p: low + width * quantile(p, mode),
        lambda q: high - width * quantile(q, 1.0 - mode),
        lambda x: below((x - low) / width, mode),
        lambda x: below((high - x) / width, 1.0 - mode),
    )


def _laplace(d: Any) -> Maps:
    centre, scale = d.getMu(), 1.0 / d.getLambda()
    return _by_tails(
        lambda p: centre + scale * np.log(2.0 * p),
        lambda q: centre - scale * np.log(2.0 * q),
        lambda x: 0.5 * np.exp((x - centre) / scale),
        lambda x: 0.5 * np.exp((centre - x) / scale),
    )


def _student(d: Any) -> Maps:
    nu, centre, scale = d.getParameter()

    def quantile(p: FloatArray) -> FloatArray:
        tail = p < 0.25
        share = _beta_quantile(0.5 * nu, 0.5, 2.0 * p[tail])
        rest = _beta_quantile(0.5, 0.5 * nu, 1.0 - 2.0 * p[~tail])
        ratio = np.empty(p.shape)
        ratio[tail], ratio[~tail] = (1.0 - share) / share, rest / (1.0 - rest)
        return np.asarray(-np.sqrt(nu * ratio))

    def below(z: FloatArray) -> FloatArray:
        half = 0.5 * special.betainc(0.5 * nu, 0.5, nu / (nu + z * z))
        return np.asarray(np.where(z < 0.0, half, 1.0 - half))

    return _by_tails(
        lambda p: centre + scale * quantile(p),
        lambda q: centre - scale * quantile(q),
        lambda x: below((x - centre) / scale),
        lambda x: below((centre - x) / scale),
    )


def _beta_quantile(a: float, b: float, p: FloatArray) -> FloatArray:
    """Quantiles of a standard beta distribution; the library's search gives up far out."""
    z = np.asarray(special.betaincinv(a, b, p))
    deep = (p < _DEEP) & (p > 0.0)
    if deep.any():
        log_p, beta = np.log(p[deep]), special.betaln(a, b)
        found = z[deep] > 0.0
        log_z = np.where(found, np.log(z[deep]), (log_p + math.log(a) + beta) / a)
        for _ in range(8):  # Newton's method: the logarithms are almost proportional
            z[deep] = np.exp(log_z)
            reached = np.log(special.betainc(a, b, z[deep]))
            slope = np.exp(a * log_z + (b - 1.0) * np.log1p(-z[deep]) - beta - reached)
            log_z -= np.where(np.isfinite(reached), (reached - log_p) / slope, 0.0)
        z[deep] = np.exp(log_z)
    return z


FAMILIES: dict[str, Callable[[Any], Maps]] = {
    "Beta": _beta,
    "Exponential": _exponential,
    "Frechet": _frechet,
    "Gamma": _gamma,
    "Gumbel": _gumbel,
    "Laplace": _laplace,
    "LogNormal": _lognormal,
    "Logistic": _logistic,
    "Normal": _normal,
    "Pareto": _pareto,
    "Rayleigh": _rayleigh,
    "Student": _student,
    "Triangular": _triangular,
    "Uniform": _uniform,
    "WeibullMax": _weibull_max,
    "WeibullMin": _weibull_min,
}
"""Class of an OpenTURNS distribution -> its maps from and to standard-normal values."""
