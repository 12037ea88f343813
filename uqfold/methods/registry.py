"""Names of methods: the built-in ones and those that other packages register."""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

from uqfold.checks import choice
from uqfold.methods.base import ReliabilityMethod

ENTRY_POINT_GROUP = "uqfold.methods"

_BUILT_IN: dict[str, str] = {
    "ffni-spa": "uqfold.methods.ffni_saddlepoint:FFNISaddlepoint",
    "ffni-pearson": "uqfold.methods.ffni_pearson:FFNIPearson",
    "kriging": "uqfold.methods.kriging:Kriging",
    "pce": "uqfold.methods.polynomial_chaos:PolynomialChaos",
    "ak-mcs": "uqfold.methods.active_kriging:ActiveKriging",
    "mc": "uqfold.methods.monte_carlo:MonteCarlo",
    "conditional-mc": "uqfold.methods.conditional_monte_carlo:ConditionalMonteCarlo",
    "openturns-form": "uqfold.methods.openturns_form:OpenTURNSFORM",
    "openturns-mc": "uqfold.methods.openturns_monte_carlo:OpenTURNSMonteCarlo",
}


@cache
def available() -> dict[str, type[ReliabilityMethod]]:
    """Map every method's name to its class; each can be built without arguments.

    Built-in methods come first. A package adds its own through the entry-point group
    ``uqfold.methods``: the entry's name is the method's name, its value the class.

    Raises
    ------
    TypeError
        If an entry point gives something that is not a `ReliabilityMethod` class.
    ValueError
        If two methods claim the same name.
    """
    found = {name: _load(path) for name, path in _BUILT_IN.items()}
    for entry in entry_points(group=ENTRY_POINT_GROUP):
        if entry.name in found:
            raise ValueError(f"two methods are named {entry.name!r}: {entry.value} is one of them")
        loaded = entry.load()
        if not (isinstance(loaded, type) and issubclass(loaded, ReliabilityMethod)):
            raise TypeError(f"entry point {entry.name!r} = {entry.value} is no ReliabilityMethod")
        found[entry.name] = loaded
    return found


def build(name: str) -> ReliabilityMethod:
    """Build the named method with its default settings.

    Raises
    ------
    ValueError
        If no method has that name; the message lists those that exist.
    """
    methods = available()
    return methods[choice("name", name, methods)]()


def _load(path: str) -> type[ReliabilityMethod]:
    module, _, attribute = path.partition(":")
    method: type[ReliabilityMethod] = getattr(import_module(module), attribute)
    return method
