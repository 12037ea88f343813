"""Random variables of SciPy's newer kind (`scipy.stats.Normal`) as distributions of its older one.

OpenTURNS wraps the older kind alone. What the newer one computes, in both tails, is handed on as it
is; transformed, truncated and mixed variables are among them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.stats import rv_continuous

_LEVELS = np.array([0.01, 0.3, 0.5, 0.9])


def is_variable(distribution: Any) -> bool:
    """Return whether an object of SciPy is a random variable of the newer kind."""
    return hasattr(distribution, "icdf") and hasattr(distribution, "ccdf")


def is_discrete(variable: Any) -> bool:
    """Return whether a random variable takes single values only."""
    return any(kind.__name__ == "DiscreteDistribution" for kind in type(variable).__mro__)


def frozen_variable(variable: Any) -> Any:
    """Return a random variable as a frozen distribution.

    Raises
    ------
    ValueError
        If it has arrays of parameters, or these make no distribution.
    """
    kind, median = f"scipy.stats.{type(variable).__name__}", variable.median()
    if np.ndim(median) > 0:
        raise ValueError(f"{kind} with arrays of parameters: give one each")
    if not np.isfinite(median):
        raise ValueError(f"{kind}: the parameters make no distribution")
    return ScipyVariable(variable)()


class ScipyVariable(rv_continuous):  # type: ignore[misc]
    """A random variable in the form of a distribution with location 0 and scale 1.

    Attributes
    ----------
    variable
        What SciPy made, such as ``scipy.stats.Normal(mu=1.0, sigma=2.0)``.
    solved
        Whether SciPy searches for its quantiles, which takes time.
    """

    def __init__(self, variable: Any) -> None:
        self.variable = variable
        low, high = variable.support()
        # SciPy solves for the quantiles of a mixture
        self.solved = type(variable).__name__ == "Mixture"
        text = " ".join(str(variable).split())
        super().__init__(a=float(low), b=float(high), name=f"scipy.stats.{text}")

    def __deepcopy__(self, _: Any) -> ScipyVariable:
        """Return itself: it never changes, and SciPy's copies lose parameters of a normal one."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Hand on the variable with some quantiles, since SciPy's own pickles may lose numbers."""
        return _unpickled, (self.variable, self.variable.icdf(_LEVELS).tolist())

    def _updated_ctor_param(self) -> dict[str, Any]:
        """Return the arguments of a copy, which SciPy makes whenever it freezes one."""
        return {"variable": self.variable}

    def _pdf(self, x: Any) -> Any:
        return self.variable.pdf(x)

    def _logpdf(self, x: Any) -> Any:
        return self.variable.logpdf(x)

    def _cdf(self, x: Any) -> Any:
        return self.variable.cdf(x)

    def _sf(self, x: Any) -> Any:
        return self.variable.ccdf(x)

    def _ppf(self, q: Any) -> Any:
        return self.variable.icdf(q)

    def _isf(self, q: Any) -> Any:
        return self.variable.iccdf(q)

    def _stats(self) -> tuple[Any, Any, None, None]:
        return self.variable.mean(), self.variable.variance(), None, None


def _unpickled(variable: Any, quantiles: list[float]) -> ScipyVariable:
    if not np.allclose(variable.icdf(_LEVELS), quantiles, rtol=1e-9, atol=0.0):
        raise ValueError(f"SciPy has not pickled {variable} rightly: make it where it is used")
    return ScipyVariable(variable)
