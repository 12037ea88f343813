"""The joint distribution of a problem's inputs, shared inputs first.

All sampling and all quadrature pass through the standard-normal space of the Rosenblatt
transformation in this column order, so that the first `n_shared` standard-normal variables alone
determine the shared inputs, and the remaining ones the individual inputs given the shared.

References
----------
Rosenblatt M. Remarks on a multivariate transformation. Ann. Math. Statist. 23 (1952) 470-472.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from uqfold.inputs.convert import as_openturns
from uqfold.inputs.gauss import gauss_rule
from uqfold.inputs.moments import moments, with_moments
from uqfold.typing import FloatArray

_DEFAULT_NAME = re.compile(r"X\d+")
"""What OpenTURNS calls the components of a distribution that nobody named."""


def normal(mean: float, std: float) -> Any:
    """Give a normal marginal distribution.

    Raises
    ------
    ValueError
        If `std` is not positive or a value is not finite.
    """
    if not (np.isfinite(mean) and np.isfinite(std) and std > 0):
        raise ValueError(f"normal({mean}, {std}): the mean must be finite and std > 0")
    import openturns as ot

    return ot.Normal(float(mean), float(std))


@dataclass(frozen=True, eq=False)
class JointInputs:
    """Ordered joint distribution of the shared inputs, then the individual ones.

    Attributes
    ----------
    distribution
        OpenTURNS distribution of dimension d, columns in that order.
    names
        The d input names, all different.
    n_shared
        How many of the columns, counted from the left, are shared.
    """

    distribution: Any
    names: tuple[str, ...]
    n_shared: int

    def __post_init__(self) -> None:
        if len(set(self.names)) != len(self.names):
            raise ValueError(f"input names {list(self.names)} are not all different")

    @property
    def dimension(self) -> int:
        """Number of inputs d of one unit, shared and individual."""
        return len(self.names)

    @property
    def n_individual(self) -> int:
        """Number of individual inputs."""
        return self.dimension - self.n_shared

    @property
    def shared_names(self) -> tuple[str, ...]:
        """Names of the shared inputs."""
        return self.names[: self.n_shared]

    @property
    def individual_names(self) -> tuple[str, ...]:
        """Names of the individual inputs."""
        return self.names[self.n_shared :]

    @cached_property
    def independent(self) -> bool:
        """Whether all inputs are mutually independent."""
        return bool(self.distribution.hasIndependentCopula())

    @cached_property
    def marginals(self) -> tuple[Any, ...]:
        """The d OpenTURNS marginal distributions."""
        return tuple(self.distribution.getMarginal(i) for i in range(self.dimension))

    @cached_property
    def _from_normal(self) -> Any:
        import openturns as ot

        if self.independent:
            standard = [ot.Normal(0.0, 1.0)] * self.dimension
            return ot.Function(ot.MarginalTransformationEvaluation(standard, list(self.marginals)))
        return ot.Function(ot.InverseRosenblattEvaluation(self.distribution))

    @cached_property
    def _to_normal(self) -> Any:
        import openturns as ot

        if self.independent:
            standard = [ot.Normal(0.0, 1.0)] * self.dimension
            return ot.Function(ot.MarginalTransformationEvaluation(list(self.marginals), standard))
        return ot.Function(ot.RosenblattEvaluation(self.distribution))

    @cached_property
    def means(self) -> FloatArray:
        """Means (d,) of the inputs, in their own units."""
        return np.array([moments(marginal)[0] for marginal in self.marginals])

    @cached_property
    def standard_deviations(self) -> FloatArray:
        """Standard deviations (d,) of the inputs, in their own units."""
        return np.array([moments(marginal)[1] for marginal in self.marginals])

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds of the inputs, each (d,); infinite where there is none."""
        ranges = [marginal.getRange() for marginal in self.marginals]
        return (
            np.array(
                [r.getLowerBound()[0] if r.getFiniteLowerBound()[0] else -np.inf for r in ranges]
            ),
            np.array(
                [r.getUpperBound()[0] if r.getFiniteUpperBound()[0] else np.inf for r in ranges]
            ),
        )

    def from_standard_normal(self, u: FloatArray) -> FloatArray:
        """Map standard-normal rows to inputs (inverse Rosenblatt transformation).

        Parameters
        ----------
        u
            Standard-normal variables (n, d), shared inputs first.

        Returns
        -------
        FloatArray
            Inputs X (n, d).

        Raises
        ------
        ValueError
            If `u` has another number of columns.
        """
        return self._mapped("u", u, self._from_normal)

    def to_standard_normal(self, x: FloatArray) -> FloatArray:
        """Map inputs to standard-normal rows (Rosenblatt transformation).

        Parameters
        ----------
        x
            Inputs X (n, d).

        Returns
        -------
        FloatArray
            Standard-normal variables (n, d), shared inputs first; infinite where a value lies
            beyond a bound of its distribution.

        Raises
        ------
        ValueError
            If `x` has another number of columns.
        """
        u = self._mapped("x", x, self._to_normal)
        low, high = self.bounds
        u[x < low] = -np.inf
        u[x > high] = np.inf
        return u

    def _mapped(self, name: str, rows: FloatArray, function: Any) -> FloatArray:
        rows = np.asarray(rows, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != self.dimension:
            raise ValueError(f"{name} has shape {rows.shape}, expected (n, {self.dimension})")
        if rows.shape[0] == 0:
            return np.empty((0, self.dimension))
        import openturns as ot

        return np.array(function(ot.Sample(rows)), dtype=np.float64)

    def with_moments(
        self,
        means: Mapping[str, float] | None = None,
        standard_deviations: Mapping[str, float] | None = None,
    ) -> JointInputs:
        """Give the same inputs with other means or standard deviations; the copula stays.

        A normal, lognormal, gamma, Weibull or beta marginal keeps its family and bounds; any
        other one is shifted and stretched.

        Parameters
        ----------
        means, standard_deviations
            Name of an input -> its new value, in the input's unit; the others keep theirs.

        Raises
        ------
        ValueError
            If a name is not one of the inputs, or a distribution cannot have these moments.
        """
        import openturns as ot

        means, stds = dict(means or {}), dict(standard_deviations or {})
        unknown = [name for name in (*means, *stds) if name not in self.names]
        if unknown:
            raise ValueError(f"{unknown[0]!r} is not one of the inputs {list(self.names)}")
        marginals = list(self.marginals)
        for column, name in enumerate(self.names):
            if name in means or name in stds:
                mean, std = moments(marginals[column])
                marginals[column] = with_moments(
                    marginals[column], means.get(name, mean), stds.get(name, std)
                )
        if self.independent:
            joint = ot.JointDistribution(marginals)
        else:
            joint = ot.JointDistribution(marginals, self.distribution.getCopula())
        return JointInputs(joint, self.names, self.n_shared)

    def sample(self, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw `size` independent rows X (size, d)."""
        return self.from_standard_normal(rng.standard_normal((size, self.dimension)))

    def gauss_rule(self, column: int, n: int) -> tuple[FloatArray, FloatArray]:
        """Gauss quadrature rule of one marginal: exact for polynomials of degree 2 n - 1.

        Parameters
        ----------
        column
            Which input.
        n
            Number of nodes, 1 to 64.

        Returns
        -------
        tuple[FloatArray, FloatArray]
            Nodes (n,) in the input's own unit and weights (n,) that sum to one.

        Raises
        ------
        ValueError
            If `n` is out of range, or the marginal has no such rule (moments missing, or beyond
            double precision).
        """
        return gauss_rule(self.marginals[column], n)

    def __repr__(self) -> str:
        shared = ", ".join(self.shared_names) or "none"
        return f"JointInputs(shared: {shared}; individual: {', '.join(self.individual_names)})"


def product_inputs(
    shared: Any | None, individual: Any | None, names: Sequence[str] | None = None
) -> JointInputs:
    """Join shared and individual inputs that are independent of each other.

    Parameters
    ----------
    shared, individual
        Distributions in any form `as_openturns` takes; at least one of them is not None.
    names
        Names of all inputs, shared first; by default those of the distributions.

    Raises
    ------
    ValueError
        If there is no input at all, or a name occurs twice.
    """
    import openturns as ot

    blocks = [as_openturns(part) for part in (shared, individual) if part is not None]
    if not blocks:
        raise ValueError("no inputs: give shared=, individual= or inputs=")
    n_shared = blocks[0].getDimension() if shared is not None else 0
    marginals = [b.getMarginal(i) for b in blocks for i in range(b.getDimension())]
    own_names = [str(name) for b in blocks for name in b.getDescription()]
    if all(block.hasIndependentCopula() for block in blocks):
        joint = ot.JointDistribution(marginals)
    else:
        copula = ot.BlockIndependentCopula([block.getCopula() for block in blocks])
        joint = ot.JointDistribution(marginals, copula)
    return JointInputs(joint, _resolve_names(names, own_names), n_shared)


def joint_inputs(
    inputs: Any, shared: Sequence[str] = (), names: Sequence[str] | None = None
) -> JointInputs:
    """Order one joint distribution so that the named shared inputs come first.

    Parameters
    ----------
    inputs
        Joint distribution in any form `as_openturns` takes, with any copula.
    shared
        Names of the shared inputs.
    names
        Names of the columns of `inputs`; by default those of the distribution.

    Raises
    ------
    ValueError
        If a shared name is not among the inputs, or a name occurs twice.
    """
    distribution = as_openturns(inputs)
    given = _resolve_names(names, [str(name) for name in distribution.getDescription()])
    unknown = [name for name in shared if name not in given]
    if unknown:
        raise ValueError(f"shared input {unknown[0]!r} is not one of the inputs {list(given)}")
    if len(set(shared)) != len(shared):
        raise ValueError(f"shared inputs {list(shared)} are named twice")
    order = [given.index(name) for name in shared]
    order += [i for i, name in enumerate(given) if name not in shared]
    if order != sorted(order):
        distribution = distribution.getMarginal(order)
    return JointInputs(distribution, tuple(given[i] for i in order), len(shared))


def _resolve_names(given: Sequence[str] | None, own: list[str]) -> tuple[str, ...]:
    if given is not None:
        if len(given) != len(own):
            raise ValueError(f"{len(given)} names for {len(own)} inputs: {list(given)}")
        return tuple(given)
    twice = [name for name in own if own.count(name) > 1]
    if not twice:
        return tuple(own)
    given_by_hand = [name for name in twice if not _DEFAULT_NAME.fullmatch(name)]
    if given_by_hand:
        raise ValueError(f"input {given_by_hand[0]!r} is named twice: {own}")
    return tuple(f"x{i + 1}" for i in range(len(own)))
