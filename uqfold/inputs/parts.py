"""A joint distribution taken apart into its marginals and the parts that depend on each other.

A normal copula stays its Cholesky factor, and two inputs stay two, in whatever order the columns
are asked for and in however large a joint they stand. OpenTURNS itself would integrate numerically
where the order changes, for minutes a row.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.inputs.behind import family_of
from uqfold.inputs.dependence import CopulaPart, JointPart, NormalPart, Part
from uqfold.inputs.engine import openturns
from uqfold.inputs.laws import ClosedMarginal
from uqfold.inputs.marginal import Marginal, OpenTURNSMarginal
from uqfold.typing import FloatArray

_TOO_DEAR, _DEAR = 0.5, 0.01
"""Seconds that one row may take, and from which on a warning says so."""
_PROBE = (-0.7, 0.4, 1.1)
_RETURN = 1e-3
"""Largest distance between standard-normal values and what comes back from their inputs."""


@dataclass(frozen=True, eq=False)
class Parts:
    """A joint distribution taken apart.

    Attributes
    ----------
    marginals
        OpenTURNS marginals (d,).
    dependent
        Parts of two inputs or more; all other columns are independent.
    """

    marginals: tuple[Any, ...]
    dependent: tuple[Part, ...]

    def chosen(self, order: Sequence[int]) -> Parts:
        """Return some of the columns, in another order."""
        return Parts(tuple(self.marginals[i] for i in order), _chosen(self.dependent, order))

    def followed_by(self, other: Parts) -> Parts:
        """Return these columns and then those of another distribution, independent of these."""
        ahead = len(self.marginals)
        return Parts(
            self.marginals + other.marginals, self.dependent + _shifted(other.dependent, ahead)
        )

    def joined(self) -> Any:
        """Return the joint distribution in OpenTURNS form, columns in this order."""
        ot = openturns()
        marginals = list(self.marginals)
        if not self.dependent:
            return ot.JointDistribution(marginals)
        if all(isinstance(part, NormalPart) for part in self.dependent):
            whole = np.eye(len(marginals))
            for part in self.dependent:
                assert isinstance(part, NormalPart)
                whole[np.ix_(part.columns, part.columns)] = part.correlation
            return ot.JointDistribution(
                marginals, NormalPart(tuple(range(len(marginals))), whole).copula()
            )
        linked = [column for part in self.dependent for column in part.columns]
        free = [i for i in range(len(marginals)) if i not in linked]
        blocks = [part.copula() for part in self.dependent]
        blocks += [ot.IndependentCopula(len(free))] if free else []
        stored = [*linked, *free]
        copula = blocks[0] if len(blocks) == 1 else ot.BlockIndependentCopula(blocks)
        joint = ot.JointDistribution([marginals[i] for i in stored], copula)
        back = [stored.index(i) for i in range(len(marginals))]
        return joint if back == sorted(back) else joint.getMarginal(back)


def taken_apart(distribution: Any) -> Parts:
    """Take an OpenTURNS distribution apart."""
    d = distribution.getDimension()
    marginals = tuple(distribution.getMarginal(i) for i in range(d))
    if d == 1 or distribution.hasIndependentCopula():
        return Parts(marginals, ())
    own, family = family_of(distribution)
    columns = tuple(range(d))
    if family == "Normal":
        return Parts(marginals, _normal_parts(np.array(own.getCorrelation())))
    if family == "JointDistribution" and own.getCore().isCopula():
        return Parts(marginals, _parts_of_copula(own.getCore()))
    if family == "BlockIndependentDistribution":
        parts = Parts((), ())
        for block in own.getDistributionCollection():
            parts = parts.followed_by(taken_apart(block))
        return parts
    if family == "MarginalDistribution":
        return taken_apart(own.getDistribution()).chosen([int(i) for i in own.getIndices()])
    if distribution.isCopula():
        return Parts(marginals, _parts_of_copula(distribution))
    return Parts(marginals, (JointPart(columns, distribution),))


def _parts_of_copula(copula: Any) -> tuple[Part, ...]:
    d = copula.getDimension()
    if d == 1 or copula.hasIndependentCopula():
        return ()
    own, family = family_of(copula)
    if family == "NormalCopula":
        return _normal_parts(np.array(own.getShapeMatrix()))
    if family == "BlockIndependentCopula":
        parts: tuple[Part, ...] = ()
        ahead = 0
        for block in own.getCopulaCollection():
            parts += _shifted(_parts_of_copula(block), ahead)
            ahead += block.getDimension()
        return parts
    if family == "MarginalDistribution":
        base = own.getDistribution()
        parts = _parts_of_copula(base) if base.isCopula() else taken_apart(base).dependent
        return _chosen(parts, [int(i) for i in own.getIndices()])
    if family == "SklarCopula":
        return taken_apart(own.getDistribution()).dependent
    return (CopulaPart(tuple(range(d)), copula),)


def _normal_parts(correlation: FloatArray) -> tuple[Part, ...]:
    """Parts that no correlation links."""
    from scipy.sparse.csgraph import connected_components

    count, label = connected_components(correlation != 0.0, directed=False)
    members = [np.flatnonzero(label == k) for k in range(count)]
    return tuple(
        NormalPart(tuple(int(i) for i in own), correlation[np.ix_(own, own)])
        for own in members
        if own.size > 1
    )


def _chosen(parts: Sequence[Part], order: Sequence[int]) -> tuple[Part, ...]:
    chosen = []
    for part in parts:
        at = [
            (new, part.columns.index(old)) for new, old in enumerate(order) if old in part.columns
        ]
        if len(at) > 1:
            chosen.append(part.chosen([local for _, local in at], tuple(new for new, _ in at)))
    return tuple(chosen)


def _shifted(parts: Sequence[Part], ahead: int) -> tuple[Part, ...]:
    return tuple(
        part.chosen(range(len(part.columns)), tuple(i + ahead for i in part.columns))
        for part in parts
    )


def check_part(part: Part, marginals: Sequence[Marginal], names: Sequence[str]) -> None:
    """Check that a dependent part leads there and back, and what one row of it costs.

    Raises
    ------
    ValueError
        If it does not, or if one row takes more than half a second.

    Warns
    -----
    RuntimeWarning
        If one row takes more than a hundredth of a second.
    """
    called = f"the dependence of {', '.join(names)}"
    if isinstance(part, NormalPart):
        try:
            part.root  # noqa: B018
        except np.linalg.LinAlgError:
            raise ValueError(
                f"{called}: the correlation is not positive definite; drop an input that the "
                "others determine"
            ) from None
        return
    remedy = (
        "describe it by a NormalCopula, or by independent pairs (BlockIndependentCopula), or "
        "give the distribution with the shared inputs first"
    )
    if isinstance(part, JointPart):
        for name, marginal in zip(names, marginals, strict=True):
            if marginal.atoms[0].size:
                raise ValueError(
                    f"{called}: {name} = {marginal} takes single values; give the joint "
                    "distribution as marginals and a copula, or let one discrete input choose "
                    "among rows that the model knows"
                )
        own = {
            name: marginal
            for name, marginal in zip(names, marginals, strict=True)
            if not isinstance(marginal, OpenTURNSMarginal)
        }
        for name, marginal in own.items():
            raise ValueError(
                f"{called}: OpenTURNS does not compute {name} = {marginal} rightly; give the "
                "joint distribution as marginals and a copula"
            )
    k = len(part.columns)
    if k > 2 and family_of(part.own)[1] == "MarginalDistribution":  # type: ignore[attr-defined]
        raise ValueError(f"{called} is known in this order only by integration: {remedy}")
    # steps lead to no single place back, and have nothing to do with the copula
    even = ClosedMarginal(openturns().Uniform(0.0, 1.0))
    marginals = [even if marginal.atoms[0].size else marginal for marginal in marginals]
    u = np.array([[level * (-1.0) ** i for i in range(k)] for level in _PROBE])
    try:
        spent = []
        for row in (u[:1], u[:1]):
            started = time.perf_counter()
            part.values(row, marginals)
            spent.append(time.perf_counter() - started)
            if spent[0] > 10.0 * _TOO_DEAR:
                break
        seconds = min(spent)
        if seconds > _TOO_DEAR:
            raise ValueError(f"{called} takes {seconds:.2g} s for one row: {remedy}")
        back = part.normals(part.values(u, marginals), marginals)
    except (RuntimeError, TypeError) as error:
        raise ValueError(f"{called} cannot be transformed ({error}): {remedy}") from error
    if not np.abs(back - u).max() <= _RETURN:
        raise ValueError(
            f"{called} does not lead back from inputs to where they came from: {remedy}"
        )
    if seconds > _DEAR:
        warnings.warn(
            f"{called} takes {seconds:.2g} s for one row, {1e4 * seconds / 60.0:.2g} minutes for "
            f"10,000: {remedy}",
            RuntimeWarning,
            stacklevel=2,
        )
