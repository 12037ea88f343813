"""Joint inputs made of distributions of any origin: converted, named, checked one by one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from uqfold.checks import choice, real, refused, shown
from uqfold.checks import names as checked_names
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.engine import openturns
from uqfold.inputs.joint import JointInputs
from uqfold.inputs.parts import Parts, check_part, taken_apart
from uqfold.typing import FloatArray


def normal(mean: float, std: float) -> Any:
    """Return a normal marginal distribution.

    Raises
    ------
    ValueError, TypeError
        If `std` is not positive or a value is not a finite number.
    """
    mean, std = real("mean", mean), real("std", std, above=0.0)
    ot = openturns()
    return ot.Normal(mean, std)


def normal_copula(marginals: Mapping[str, Any], correlation: FloatArray) -> Any:
    """Return a joint distribution of named marginals that depend by a normal copula.

    Parameters
    ----------
    marginals
        Name -> its distribution, in any form `as_openturns` takes.
    correlation
        Correlations (d, d) of the normal variables behind them.
    """
    ot = openturns()
    parts = [as_openturns(marginal) for marginal in marginals.values()]
    copula = ot.NormalCopula(ot.CorrelationMatrix(np.asarray(correlation).tolist()))
    joint = ot.JointDistribution(parts, copula)
    joint.setDescription(list(marginals))
    return joint


def correlated(
    marginals: Mapping[str, Any], pairs: Mapping[tuple[str, str], tuple[str, float]]
) -> Any:
    """Return named marginals, joined by a normal copula where some of them are correlated.

    Parameters
    ----------
    marginals
        Name -> its distribution, in any form `as_openturns` takes.
    pairs
        Two names -> ``normal``, the correlation of the normal variables behind them, or
        ``spearman``, that of their ranks; and its value.

    Raises
    ------
    ValueError, TypeError
        If a name is none of the inputs, a value is not between -1 and 1, or no distribution has
        all these correlations.
    """
    if not pairs:
        return dict(marginals)
    names = list(marginals)
    matrix = np.eye(len(names))
    for pair, (kind, value) in pairs.items():
        row, column = (names.index(choice("between", name, names)) for name in pair)
        if row == column:
            raise refused("between", pair, "give two different inputs")
        given = real(kind, value, above=-1.0, below=1.0)
        behind = given if kind == "normal" else 2.0 * math.sin(math.pi * given / 6.0)
        matrix[row, column] = matrix[column, row] = behind
    if np.linalg.eigvalsh(matrix)[0] <= 0.0:
        raise ValueError(
            "these correlations contradict each other: no distribution has all of them"
        )
    return normal_copula(marginals, matrix)


def product_inputs(
    shared: Any | None, individual: Any | None, names: Sequence[str] | None = None
) -> JointInputs:
    """Join shared and individual inputs that are independent of each other.

    Parameters
    ----------
    shared, individual
        Distributions in any form `as_openturns` takes, or some of another problem's inputs; at
        least one of them is not None.
    names
        Names of all inputs, shared first; by default those of the distributions.

    Raises
    ------
    ValueError
        If there is no input at all, a name occurs twice, or an input cannot be computed.
    """
    named = (("shared", shared), ("individual", individual))
    if shared is None and individual is None:
        raise ValueError("no inputs: give shared=, individual= or inputs=, not None for all")
    blocks = [_block(name, part) for name, part in named if part is not None]
    parts = Parts((), ())
    for block, _ in blocks:
        parts = parts.followed_by(block)
    n_shared = len(blocks[0][0].marginals) if shared is not None else 0
    return _assembled(parts, _resolved(names, [own for _, own in blocks]), n_shared)


def with_other_inputs(
    inputs: JointInputs,
    shared: Any | None = None,
    individual: Any | None = None,
    names: Sequence[str] | None = None,
) -> JointInputs:
    """Return inputs with other shared or individual ones, or both.

    Parameters are those of `product_inputs`, None standing for those of `inputs`.

    Raises
    ------
    ValueError
        If shared and individual ones depend on each other.
    """
    n = inputs.n_shared
    _refuse_tied(inputs)
    if shared is None and n > 0:
        shared = inputs.in_order(range(n))
    if individual is None and n < inputs.dimension:
        individual = inputs.in_order(range(n, inputs.dimension))
    return product_inputs(shared, individual, names)


def shared_inputs(inputs: JointInputs) -> JointInputs:
    """Return the shared ones of some inputs alone.

    Raises
    ------
    ValueError
        If there are none, or individual ones depend on them.
    """
    _refuse_tied(inputs)
    if inputs.n_shared == 0:
        raise refused("inputs", inputs, "none of them is shared, so that nothing would be left")
    return product_inputs(inputs.in_order(range(inputs.n_shared)), None, inputs.shared_names)


def _refuse_tied(inputs: JointInputs) -> None:
    """Refuse inputs of which shared and individual ones depend on each other."""
    n = inputs.n_shared
    if any(min(part.columns) < n <= max(part.columns) for part in inputs.parts.dependent):
        remedy = "shared and individual inputs depend on each other: give all of them as inputs="
        raise refused("inputs", inputs, remedy)


def joint_inputs(
    inputs: Any, shared: Sequence[str] = (), names: Sequence[str] | None = None
) -> JointInputs:
    """Order one joint distribution so that the named shared inputs come first.

    Parameters
    ----------
    inputs
        Joint distribution in any form `as_openturns` takes, with any copula; or the inputs of
        another problem, taken as they are.
    shared
        Names of the shared inputs; of another problem's inputs, those that are shared there.
    names
        Names of the columns of `inputs`; by default those of the distribution.

    Raises
    ------
    ValueError
        If a shared name is not among the inputs, a name occurs twice, or an input or the
        dependence cannot be computed.
    """
    if isinstance(inputs, JointInputs):
        own = inputs.names if names is None else checked_names("names", names)
        if len(own) != inputs.dimension or tuple(shared) not in ((), own[: inputs.n_shared]):
            raise refused("inputs", inputs, "it says itself how many there are, and what is shared")
        return inputs if own == inputs.names else replace(inputs, names=own)
    distribution = _distribution("inputs", inputs)
    given = _resolved(names, [_Names.of(inputs, distribution)])
    shared = checked_names("shared", shared)
    unknown = [name for name in shared if name not in given]
    if unknown:
        raise ValueError(f"shared input {unknown[0]!r} is not one of the inputs {list(given)}")
    order = [given.index(name) for name in shared]
    order += [i for i, name in enumerate(given) if name not in shared]
    parts = taken_apart(distribution)
    if order != sorted(order):
        parts = parts.chosen(order)
    return _assembled(parts, tuple(given[i] for i in order), len(shared))


def _distribution(name: str, given: Any) -> Any:
    """Return the OpenTURNS form of an argument, which errors name."""
    try:
        return as_openturns(given)
    except (TypeError, ValueError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        several = isinstance(given, Mapping | Sequence) and not isinstance(given, str | bytes)
        # the message says itself which input it is, or shows the value
        bare = several or type(given).__module__.startswith("scipy.")
        raise kind(f"{name if bare else f'{name} = {shown(given)}'}: {error}") from error


def _block(name: str, given: Any) -> tuple[Parts, _Names]:
    """Return the parts and the names of an argument, which errors name."""
    if isinstance(given, JointInputs):
        return given.parts, _Names(given.names, not _are_default(given.names))
    distribution = _distribution(name, given)
    return taken_apart(distribution), _Names.of(given, distribution)


def _assembled(parts: Parts, names: tuple[str, ...], n_shared: int) -> JointInputs:
    """Let the inputs in, one by one and then what depends on each other."""
    names = checked_names("names of inputs", names)
    columns = tuple(
        checked_marginal(marginal, name)
        for marginal, name in zip(parts.marginals, names, strict=True)
    )
    for part in parts.dependent:
        own = part.columns
        check_part(part, [columns[i] for i in own], [names[i] for i in own])
    return JointInputs(parts, columns, names, n_shared)


@dataclass(frozen=True)
class _Names:
    """Names that one distribution carries, and whether somebody gave them."""

    own: tuple[str, ...]
    by_hand: bool

    @classmethod
    def of(cls, given: Any, distribution: Any) -> _Names:
        """Names of a distribution; those of a mapping, or off their default places, are given."""
        own = tuple(str(name) for name in distribution.getDescription())
        return cls(own, isinstance(given, Mapping) or not _are_default(own))


def _are_default(names: Sequence[str]) -> bool:
    return all(name == f"X{i}" for i, name in enumerate(names))


def _resolved(given: Sequence[str] | None, blocks: Sequence[_Names]) -> tuple[str, ...]:
    own = [name for block in blocks for name in block.own]
    if given is not None:
        wanted = checked_names("names", given)
        if len(wanted) != len(own):
            raise ValueError(f"{len(wanted)} names for {len(own)} inputs: {list(wanted)}")
        return wanted
    twice = next((name for i, name in enumerate(own) if name in own[:i]), None)
    if twice is None:
        return tuple(own)
    if any(block.by_hand for block in blocks if twice in block.own):
        raise ValueError(f"input {twice!r} is named twice: {own}; give each another, or names=")
    return tuple(f"x{i + 1}" for i in range(len(own)))
