"""Distributions by the names of their family and of its parameters, as files have them."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any, TypeAlias

from uqfold.checks import choice, instance, one_line, real, refused
from uqfold.inputs.assembly import normal
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.data import from_data
from uqfold.inputs.engine import openturns
from uqfold.inputs.single_values import bernoulli, censored, discrete, poisson

Form: TypeAlias = tuple[tuple[str, ...], Callable[..., Any]]
"""Names of parameters, and what makes a distribution of OpenTURNS of them."""
OF = "of"
"""The parameter that is a distribution itself, a table of its own."""

_MOMENTS = ("mean", "std")
_FORMS: dict[str, tuple[Form, ...]] = {
    "lognormal": (
        (_MOMENTS, lambda ot, mean, std: ot.LogNormalMuSigma(mean, std, 0.0).getDistribution()),
        (("mean_log", "std_log"), lambda ot, mean, std: ot.LogNormal(mean, std)),
    ),
    "uniform": ((("low", "high"), lambda ot, low, high: ot.Uniform(low, high)),),
    "exponential": ((("mean",), lambda ot, mean: ot.Exponential(1.0 / mean)),),
    "gumbel": (
        (_MOMENTS, lambda ot, mean, std: ot.GumbelMuSigma(mean, std).getDistribution()),
        (("location", "scale"), lambda ot, location, scale: ot.Gumbel(scale, location)),
    ),
    "weibull": (
        (_MOMENTS, lambda ot, mean, std: ot.WeibullMinMuSigma(mean, std, 0.0).getDistribution()),
        (("scale", "shape"), lambda ot, scale, shape: ot.WeibullMin(scale, shape)),
    ),
    "gamma": (
        (_MOMENTS, lambda ot, mean, std: ot.GammaMuSigma(mean, std, 0.0).getDistribution()),
        (("shape", "scale"), lambda ot, shape, scale: ot.Gamma(shape, 1.0 / scale)),
    ),
    "beta": (
        (
            (*_MOMENTS, "low", "high"),
            lambda ot, mean, std, low, high: ot.BetaMuSigma(mean, std, low, high).getDistribution(),
        ),
        (
            ("a", "b", "low", "high"),
            lambda ot, a, b, low, high: ot.Beta(a, b, low, high),
        ),
    ),
    "triangular": (
        (("low", "mode", "high"), lambda ot, low, mode, high: ot.Triangular(low, mode, high)),
    ),
    "logistic": (
        (
            _MOMENTS,
            lambda ot, mean, std: ot.Logistic(mean, std * math.sqrt(3.0) / math.pi),
        ),
    ),
}
_OWN: dict[str, Callable[..., Any]] = {
    one.__name__: one for one in (normal, bernoulli, poisson, discrete, censored, from_data)
}


def families() -> tuple[str, ...]:
    """Return the names that `by_name` knows."""
    return (*_OWN, "truncated", *_FORMS)


def by_name(family: str, parameters: Mapping[str, Any]) -> Any:
    """Return a distribution by its family and parameters.

    Parameters
    ----------
    family
        ``normal``, ``bernoulli``, ``poisson``, ``discrete``, ``censored`` and ``from_data`` with
        the parameters of the functions of `uqfold.inputs`, where ``of`` is the distribution that
        is cut off; ``truncated`` (of, low, high: X given that it lies between them); ``lognormal``,
        ``gumbel`` (of maxima), ``weibull`` (of minima), ``gamma`` and ``logistic`` with mean and
        std; ``beta`` with mean, std, low and high; ``uniform``, ``exponential``, ``triangular``.
        Some take other parameters instead: ``lognormal`` mean_log and std_log, ``gumbel``
        location and scale, ``weibull`` and ``gamma`` shape and scale, ``beta`` a, b, low and high.
        Either case will do.
    parameters
        Its parameters by their names; a distribution among them is a dict that names its own
        family as ``distribution``.

    Raises
    ------
    ValueError, TypeError
        If the family is unknown, a parameter is, one is missing, or no such distribution exists.
    """
    written = family.lower() if isinstance(family, str) else family
    known = choice("distribution", written if written in families() else family, families())
    if known in _OWN:
        return _own(known, dict(parameters))
    if known == "truncated":
        return _truncated(dict(parameters))
    forms = _FORMS[known]
    names, build = max(forms, key=lambda form: len(set(form[0]) & set(parameters)))
    _check_names(known, parameters, names, names, [form[0] for form in forms])
    values = [real(name, parameters[name]) for name in names]
    for name, value in zip(names, values, strict=True):
        if name in ("std", "std_log", "scale", "shape", "a", "b"):
            real(name, value, above=0.0)
    try:
        return build(openturns(), *values)
    except (TypeError, ValueError, RuntimeError, ArithmeticError) as error:
        said = one_line(str(error)).rpartition(" : ")[2]
        stated = ", ".join(f"{name} = {value:g}" for name, value in zip(names, values, strict=True))
        raise ValueError(f"there is no {known} distribution with {stated} ({said})") from None


def _own(family: str, parameters: dict[str, Any]) -> Any:
    """Call a function of `uqfold.inputs`."""
    build = _OWN[family]
    takes = inspect.signature(build).parameters
    said = {OF if name == "distribution" else name: name for name in takes}
    needed = [one for one, name in said.items() if takes[name].default is inspect.Parameter.empty]
    _check_names(family, parameters, tuple(said), needed)
    return build(**{said[one]: _value(one, value) for one, value in parameters.items()})


def _truncated(parameters: dict[str, Any]) -> Any:
    """Return X given that it lies between two bounds, one of which may be left out."""
    _check_names("truncated", parameters, (OF, "low", "high"), (OF,))
    low = real("low", parameters.get("low", -math.inf), finite=False)
    high = real("high", parameters.get("high", math.inf), finite=False)
    if not low < high or (math.isinf(low) and math.isinf(high)):
        raise refused("low", low, f"give one below high = {high:g}, and a finite bound at least")
    whole = as_openturns(_value(OF, parameters[OF]))
    ot = openturns()
    between = ot.Interval([low], [high], [math.isfinite(low)], [math.isfinite(high)])
    if not whole.computeProbability(between) > 0.0:
        raise refused("low", low, f"nothing of it lies between {low:g} and {high:g}")
    return ot.TruncatedDistribution(whole, between)


def _value(name: str, value: Any) -> Any:
    if name != OF:
        return value
    nested = dict(
        instance(OF, value, (Mapping,), 'give a table, as {distribution = "normal", ...}')
    )
    return by_name(nested.pop("distribution", None), nested)


def _check_names(
    family: str,
    given: Mapping[str, Any],
    known: tuple[str, ...],
    needed: Any,
    forms: Any = (),
) -> None:
    """Refuse a parameter that a family does not have, and the lack of one that it needs."""
    ways = " or ".join(", ".join(form) for form in forms or [known])
    for name in given:
        if name not in known:
            meant = get_close_matches(name, known, n=1)
            hint = f"did you mean {meant[0]!r}? " if meant else ""
            raise ValueError(f"{name!r} is no parameter of {family}: {hint}it takes {ways}")
    for name in needed:
        if name not in given:
            raise ValueError(f"{family} lacks its parameter {name!r}: it takes {ways}")
