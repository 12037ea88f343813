"""Inputs that depend on each other, transformed together in the order of their columns."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from uqfold.inputs.engine import openturns
from uqfold.inputs.marginal import Marginal, OpenTURNSMarginal, WithoutCaches, called
from uqfold.inputs.sameness import same_distribution
from uqfold.typing import FloatArray

_FURTHEST = 38.0  # a normal probability of 1e-316: further out lies nothing
_SMALLEST, _LARGEST = 1e-300, 1.0 - 2.0**-53


@dataclass(frozen=True, eq=False)
class Part(WithoutCaches, ABC):
    """Inputs that depend on each other and on nothing else.

    Attributes
    ----------
    columns
        Which columns they are (k,), in the order of the transformation.
    """

    columns: tuple[int, ...]

    @abstractmethod
    def chosen(self, local: Sequence[int], columns: tuple[int, ...]) -> Part:
        """Return some of the inputs, at new columns; `local` counts within this part."""

    @abstractmethod
    def values(self, u: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """Map independent standard-normal rows (n, k) to inputs (n, k)."""

    @abstractmethod
    def normals(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """Map inputs (n, k) to independent standard-normal rows."""

    @abstractmethod
    def log_density(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """Log-density (n,) of as many first inputs as `x` (n, <= k) has columns."""

    @abstractmethod
    def copula(self) -> Any:
        """Return the copula in OpenTURNS form."""


@dataclass(frozen=True, eq=False)
class NormalPart(Part):
    """Inputs that a normal copula links, of which we know the transformation ourselves.

    Attributes
    ----------
    columns
        See `Part`.
    correlation
        Correlation (k, k) of the normal scores.
    """

    correlation: FloatArray

    @cached_property
    def root(self) -> FloatArray:
        """Cholesky factor (k, k) of the correlation."""
        return np.asarray(np.linalg.cholesky(self.correlation), dtype=np.float64)

    def chosen(self, local: Sequence[int], columns: tuple[int, ...]) -> NormalPart:
        """See `Part`."""
        return NormalPart(columns, self.correlation[np.ix_(local, local)])

    def values(self, u: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        # not by BLAS, so that a row's values do not depend on how many rows there are
        z = np.einsum("nj,ij->ni", u, self.root)
        return _columns(m.from_normal(z[:, i]) for i, m in enumerate(marginals))

    def normals(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        return self._freed(_columns(m.to_normal(x[:, i]) for i, m in enumerate(marginals)))

    def log_density(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        k = x.shape[1]
        some = marginals[:k]
        z = _columns(m.to_normal(x[:, i]) for i, m in enumerate(some))
        z = np.clip(z, -_FURTHEST, _FURTHEST)
        u = self._freed(z)
        link = 0.5 * ((z * z).sum(axis=1) - (u * u).sum(axis=1))
        link -= np.log(np.diag(self.root)[:k]).sum()
        return np.asarray(link + _log_pdfs(x, some))

    def _freed(self, z: FloatArray) -> FloatArray:
        from scipy.linalg import solve_triangular

        k = z.shape[1]
        z = np.clip(z, -_FURTHEST, _FURTHEST)
        u = solve_triangular(self.root[:k, :k], z.T, lower=True).T
        return np.asarray(u, dtype=np.float64)

    def copula(self) -> Any:
        """See `Part`."""
        ot = openturns()
        return ot.NormalCopula(ot.CorrelationMatrix(self.correlation.tolist()))


@dataclass(frozen=True, eq=False)
class _ByOpenTURNS(Part):
    """A part whose transformation OpenTURNS computes.

    Attributes
    ----------
    columns
        See `Part`.
    own
        OpenTURNS distribution or copula of dimension k.
    """

    own: Any

    @cached_property
    def _inverse(self) -> Any:
        ot = openturns()
        return ot.Function(ot.InverseRosenblattEvaluation(self.own))

    @cached_property
    def _forward(self) -> Any:
        ot = openturns()
        return ot.Function(ot.RosenblattEvaluation(self.own))

    def _own_log_density(self, rows: FloatArray) -> FloatArray:
        k = rows.shape[1]
        own = self.own if k == len(self.columns) else self.own.getMarginal(list(range(k)))
        return called(own.computeLogPDF, rows).ravel()


class CopulaPart(_ByOpenTURNS):
    """Inputs that any other copula links."""

    def chosen(self, local: Sequence[int], columns: tuple[int, ...]) -> CopulaPart:
        """See `Part`."""
        return CopulaPart(columns, _marginal(self.own, local))

    def values(self, u: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        from scipy.special import ndtri

        p = called(self._inverse, u)
        # a level of 1 is one rounded up: no value is infinitely far out
        z = ndtri(np.clip(p, _SMALLEST, _LARGEST))
        z[:, 0] = u[:, 0]
        return _columns(m.from_normal(z[:, i]) for i, m in enumerate(marginals))

    def normals(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        return called(self._forward, self._levels(x, marginals))

    def log_density(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        some = marginals[: x.shape[1]]
        alone = _log_pdfs(x, some)
        if x.shape[1] == 1:
            return alone
        return np.asarray(alone + self._own_log_density(self._levels(x, some)))

    def _levels(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        return _columns(m.cdf(x[:, i]) for i, m in enumerate(marginals))

    def copula(self) -> Any:
        """See `Part`."""
        return self.own


class JointPart(_ByOpenTURNS):
    """Inputs of one joint distribution that is not made of marginals and a copula.

    Its own marginals may be exchanged for others, one by one; then its copula is what is kept.
    """

    @cached_property
    def base(self) -> tuple[OpenTURNSMarginal, ...]:
        """Its own marginals."""
        return tuple(OpenTURNSMarginal(self.own.getMarginal(i)) for i in range(len(self.columns)))

    def chosen(self, local: Sequence[int], columns: tuple[int, ...]) -> JointPart:
        """See `Part`."""
        return JointPart(columns, _marginal(self.own, local))

    def values(self, u: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        x = called(self._inverse, u)
        for i, (base, new) in enumerate(zip(self.base, marginals, strict=True)):
            if not same_distribution(base.distribution, new.distribution):
                x[:, i] = new.from_normal(base.to_normal(x[:, i]))
        return x

    def normals(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        return called(self._forward, self._at_base(x, marginals)[0])

    def log_density(self, x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
        """See `Part`."""
        at, change = self._at_base(x, marginals)
        return np.asarray(self._own_log_density(at) + change)

    def _at_base(
        self, x: FloatArray, marginals: Sequence[Marginal]
    ) -> tuple[FloatArray, FloatArray]:
        """Values under its own marginals, and what the change adds to the log-density."""
        at, change = x.copy(), np.zeros(len(x))
        for i in range(x.shape[1]):
            base, new = self.base[i], marginals[i]
            if not same_distribution(base.distribution, new.distribution):
                z = np.clip(new.to_normal(x[:, i]), -_FURTHEST, _FURTHEST)
                at[:, i] = base.from_normal(z)
                change += new.log_pdf(x[:, i]) - base.log_pdf(at[:, i])
        return at, change

    def copula(self) -> Any:
        """See `Part`."""
        return self.own if self.own.isCopula() else self.own.getCopula()


def _marginal(own: Any, local: Sequence[int]) -> Any:
    whole = list(local) == list(range(own.getDimension()))
    return own if whole else own.getMarginal(list(local))


def _columns(parts: Any) -> FloatArray:
    return np.column_stack(list(parts))


def _log_pdfs(x: FloatArray, marginals: Sequence[Marginal]) -> FloatArray:
    total = np.zeros(len(x))
    for i, marginal in enumerate(marginals):
        total = total + marginal.log_pdf(x[:, i])
    return total
