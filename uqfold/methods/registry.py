"""Names of methods: the built-in ones and those that other packages register."""

from __future__ import annotations

import warnings
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING

from uqfold.checks import choice, raised, shown
from uqfold.lazy import warn_caller

if TYPE_CHECKING:
    from uqfold.methods.base import ReliabilityMethod

ENTRY_POINT_GROUP = "uqfold.methods"

_BUILT_IN: dict[str, str] = {
    "ffni-spa": "uqfold.methods.ffni_saddlepoint:FFNISaddlepoint",
    "ffni-pearson": "uqfold.methods.ffni_pearson:FFNIPearson",
    "ffni": "uqfold.methods.ffni:FFNI",
    "kriging": "uqfold.methods.kriging:Kriging",
    "pce": "uqfold.methods.polynomial_chaos:PolynomialChaos",
    "active-kriging": "uqfold.methods.active_kriging:ActiveKriging",
    "mc": "uqfold.methods.monte_carlo:MonteCarlo",
    "qmc": "uqfold.methods.quasi_monte_carlo:QuasiMonteCarlo",
    "conditional-mc": "uqfold.methods.conditional_monte_carlo:ConditionalMonteCarlo",
    "multifidelity-mc": "uqfold.methods.multifidelity_monte_carlo:MultifidelityMonteCarlo",
    "subset-simulation": "uqfold.methods.subset_simulation:SubsetSimulation",
    "importance-sampling": "uqfold.methods.importance_sampling:ImportanceSampling",
    "line-sampling": "uqfold.methods.line_sampling:LineSampling",
    "directional-sampling": "uqfold.methods.directional_sampling:DirectionalSampling",
    "openturns-form": "uqfold.methods.openturns_form:OpenTURNSFORM",
    "sorm": "uqfold.methods.sorm:SORM",
    "openturns-mc": "uqfold.methods.openturns_monte_carlo:OpenTURNSMonteCarlo",
    "openturns-nais": "uqfold.methods.openturns_nais:OpenTURNSNAIS",
    "auto": "uqfold.methods.automatic:Automatic",
}


FORMER = {"ak-mcs": "active-kriging"}
"""Former name -> name; a former one is understood, with a warning, for one release."""


def built_in() -> list[str]:
    """Return the names of the built-in methods, without loading any."""
    return list(_BUILT_IN)


def available() -> dict[str, type[ReliabilityMethod]]:
    """Map every method's name to its class; each can be built without arguments.

    Built-in methods come first. A package adds its own through the entry-point group
    ``uqfold.methods``: the entry's name is the method's name, its value the class. An entry that
    cannot be loaded, gives something else, or has the name of another method, is left out with a
    warning that names it.
    """
    return _found()[0]


def build(name: str) -> ReliabilityMethod:
    """Build the named method with its default settings.

    Raises
    ------
    ValueError
        If no method has that name; the message lists those that exist, or says why an installed
        one was left out.
    """
    return named("name", name)


def named(argument: str, name: object) -> ReliabilityMethod:
    """Build the method that an argument names; raise as `build` does, naming the argument."""
    methods, left_out = _found()
    if isinstance(name, str) and name in FORMER:
        called = FORMER[name]
        warn_caller(f"the method {name!r} is called {called!r} now", FutureWarning)
        name = called
    if isinstance(name, str) and name in left_out and name not in methods:
        raise ValueError(f"the method {name!r} is not available: {left_out[name]}")
    method = methods[choice(argument, name, methods)]
    try:
        return method()
    except Exception as error:
        if name in _BUILT_IN:
            raise
        made_in = method.__module__
        raise ValueError(
            f"{argument} = {shown(name)}: {method.__name__} of {made_in} raised {raised(error)}; "
            f"update or remove the package that brings {made_in}"
        ) from error


@cache
def _found() -> tuple[dict[str, type[ReliabilityMethod]], dict[str, str]]:
    """Return the methods, and why entries of other packages were left out."""
    methods = {name: _load(path) for name, path in _BUILT_IN.items()}
    left_out: dict[str, str] = {}
    for entry in entry_points(group=ENTRY_POINT_GROUP):
        loaded = _loaded(entry)
        if not isinstance(loaded, str) and entry.name in methods:
            loaded = f"{entry.value} has the name of another method"
        if isinstance(loaded, str):
            package = "its package" if entry.dist is None else f"the package {entry.dist.name}"
            loaded = f"{loaded}. Update or remove {package}"
            left_out[entry.name] = loaded
            warnings.warn(f"the method {entry.name!r} is left out: {loaded}", stacklevel=4)
        else:
            methods[entry.name] = loaded
    return methods, left_out


def _loaded(entry: EntryPoint) -> type[ReliabilityMethod] | str:
    """Return the method of an entry point, or what is wrong with it."""
    from uqfold.methods.base import ReliabilityMethod

    try:
        if entry.pattern.match(entry.value) is None:
            return f"{entry.value} is not module:class"
        loaded = entry.load()
        if not (isinstance(loaded, type) and issubclass(loaded, ReliabilityMethod)):
            return f"{entry.value} is not a ReliabilityMethod"
        if not (isinstance(loaded.title, str) and isinstance(loaded(), ReliabilityMethod)):
            return f"{entry.value} has no title"
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        # other people's code may raise anything, sys.exit() included, and takes nobody down
        return f"{entry.value} raised {raised(error)}"
    return loaded


def _load(path: str) -> type[ReliabilityMethod]:
    module, _, attribute = path.partition(":")
    method: type[ReliabilityMethod] = getattr(import_module(module), attribute)
    return method
