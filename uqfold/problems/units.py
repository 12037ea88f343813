"""Units that differ from each other: in their model, their inputs, or by an offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from dataclasses import dataclass, replace
from itertools import zip_longest
from types import MethodType
from typing import Any

import numpy as np

from uqfold.checks import function, instance, keep, or_none, real, refused, several, text, whole
from uqfold.inputs import JointInputs
from uqfold.inputs.assembly import shared_inputs, with_other_inputs
from uqfold.inputs.sameness import same_distribution
from uqfold.problems.responses import numbers_in
from uqfold.typing import FloatArray, IntArray, Model


@dataclass(frozen=True, eq=False)
class Unit:
    """One unit that differs from the others.

    Attributes
    ----------
    model
        Its own response model, or None for the problem's.
    individual
        Its own distribution of the individual inputs, None for the problem's, or an empty list if
        it has the shared ones alone. Those must not depend on the problem's individual ones then.
    offset
        Added to its response, in the response's unit.
    name
        How reports, and a `Structure`, call it.
    low_fidelity
        A cheaper partner of its own model, or None for the problem's, which serves units without
        a model of their own.
    """

    model: Model | None = None
    individual: Any = None
    offset: float = 0.0
    name: str = ""
    low_fidelity: Model | None = None

    def __post_init__(self) -> None:
        keep(self, "model", or_none, function, "give a function of X (n, d)")
        keep(self, "offset", real)
        keep(self, "name", text, empty=True)
        keep(self, "low_fidelity", or_none, function, "give a function of X (n, d)")


def checked_units(units: Any) -> int | tuple[Unit, ...]:
    """Return a number of units, or the units themselves."""
    if isinstance(units, Sequence) and not isinstance(units, str | bytes | bytearray):
        if not units:
            raise refused("units", units, "give at least one Unit")
        return several("units", units, instance, Unit, "give a Unit")
    return whole("units", units, at_least=1, what="list of Unit or a whole number")


@dataclass(frozen=True, eq=False)
class UnitKinds:
    """What the units of a system have in common: each kind of them is one model and its inputs.

    Attributes
    ----------
    models, inputs
        Of each kind. The shared inputs are the same, and their columns the first ones, in all.
    of_units, offsets
        The kind of each unit (n,), and what is added to its response (n,); both None where only the
        number of units was given, which may be very large.
    partners
        The cheaper partner of each kind's model, or None.
    gradients
        The gradient of each kind's model, or None.
    """

    models: tuple[Model, ...]
    inputs: tuple[JointInputs, ...]
    of_units: IntArray | None = None
    offsets: FloatArray | None = None
    partners: tuple[Model | None, ...] = (None,)
    gradients: tuple[Model | None, ...] = (None,)

    @classmethod
    def of(
        cls,
        units: int | tuple[Unit, ...],
        model: Model,
        inputs: JointInputs,
        low_fidelity: Model | None = None,
        gradient: Model | None = None,
    ) -> UnitKinds:
        """Sort units into kinds.

        Parameters
        ----------
        units
            The units, or their number.
        model, inputs
            Those of units without their own.
        low_fidelity
            Cheaper partner of `model`, or None.
        gradient
            Gradient of `model`, or None.
        """
        if isinstance(units, int):
            return cls((model,), (inputs,), partners=(low_fidelity,), gradients=(gradient,))
        known: dict[int, JointInputs] = {}
        kinds: list[tuple[Model, JointInputs, Model | None]] = []
        of_units = []
        for unit in units:
            own = known.get(id(unit.individual))
            if own is None:
                own = inputs if unit.individual is None else _inputs_of(unit, inputs)
                own = next((one for one in known.values() if _alike(one, own, inputs)), own)
                known[id(unit.individual)] = own
            partner = unit.low_fidelity
            if partner is None and (unit.model is None or _is_same(unit.model, model)):
                partner = low_fidelity
            kind = unit.model or model, own, partner
            same = [
                i
                for i, one in enumerate(kinds)
                if one[1] is own and _is_same(one[0], kind[0]) and _is_same(one[2], partner)
            ]
            of_units.append(same[0] if same else len(kinds))
            kinds += [] if same else [kind]
        models, all_inputs, partners = zip(*kinds, strict=True)
        offsets = np.array([u.offset for u in units])
        gradients = tuple(gradient if _is_same(one, model) else None for one in models)
        return cls(models, all_inputs, np.array(of_units), offsets, partners, gradients)

    @property
    def column_names(self) -> list[str]:
        """What the columns of `rows` are called: inputs, and last the kind if there are several."""
        if len(self.models) == 1:
            return list(self.inputs[0].names)
        each = zip_longest(*(inputs.names for inputs in self.inputs))
        names = [" / ".join(dict.fromkeys(filter(None, column))) for column in each]
        return [*names, "kind of unit"]

    def said(self, kind: int, names: Sequence[str]) -> str:
        """Return which units are of a kind, as the beginning of a message; "" if all are."""
        if self.of_units is None or len(self.models) == 1:
            return ""
        own = [names[i] for i in np.flatnonzero(self.of_units == kind).tolist()]
        more = f" and {len(own) - 1} more" if len(own) > 1 else ""
        return f"{own[0]}{more}: "

    @property
    def equal(self) -> bool:
        """Whether all units are alike."""
        return len(self.models) == 1 and (self.offsets is None or not self.offsets.any())

    @property
    def with_atoms(self) -> tuple[str, ...]:
        """Names of the inputs of any kind that take single values with positive probability."""
        return tuple(dict.fromkeys(name for one in self.inputs for name in one.with_atoms))

    @property
    def with_steps(self) -> tuple[str, ...]:
        """Names of the inputs of any kind that jump from one value to another."""
        return tuple(dict.fromkeys(name for one in self.inputs for name in one.with_steps))

    @property
    def n_shared(self) -> int:
        """Number of shared inputs."""
        return self.inputs[0].n_shared

    @property
    def n_individual(self) -> int:
        """Most individual inputs that a unit has."""
        return max(one.n_individual for one in self.inputs)

    @property
    def dimension(self) -> int:
        """Standard-normal variables of one unit: those shared, and `n_individual` of its own."""
        return self.n_shared + self.n_individual

    @property
    def columns(self) -> int:
        """Columns of the rows that `model` takes."""
        return self.dimension + int(len(self.models) > 1)

    @property
    def model(self) -> Model:
        """The model of every unit: of the only kind, or one whose last column names the kind."""
        if len(self.models) == 1:
            return self.models[0]
        return ModelOfKinds(self.models, tuple(one.dimension for one in self.inputs))

    @property
    def partner(self) -> Model | None:
        """The cheaper partner of `model`; None unless every kind has one."""
        partners = [one for one in self.partners if one is not None]
        if len(partners) < len(self.models):
            return None
        return replace(self, models=tuple(partners)).model

    def rows(self, u: FloatArray) -> FloatArray:
        """Return the inputs (..., n, columns) of n units from their variables (..., n, dimension).

        Variables that a kind does not need are left out.
        """
        if len(self.models) == 1:
            return self.inputs[0].from_standard_normal(u.reshape(-1, u.shape[-1])).reshape(u.shape)
        x = np.zeros((*u.shape[:-1], self.columns))
        for kind, inputs in enumerate(self.inputs):
            own, d = self.of_units == kind, inputs.dimension
            mapped = inputs.from_standard_normal(u[..., own, :d].reshape(-1, d))
            x[..., own, :d] = mapped.reshape(*u.shape[:-2], -1, d)
            x[..., own, -1] = kind
        return x

    def rows_of(self, kind: int, x: FloatArray) -> FloatArray:
        """Return rows (n, columns) for `model` of inputs (n, d) of units of one kind."""
        if len(self.models) == 1:
            return x
        rows = np.zeros((len(x), self.columns))
        rows[:, : x.shape[1]] = x
        rows[:, -1] = kind
        return rows

    def with_moments(
        self,
        former: JointInputs,
        changed: JointInputs,
        means: Mapping[str, float],
        stds: Mapping[str, float],
    ) -> UnitKinds:
        """Return the kinds with the inputs `changed` where they had `former`.

        Individual inputs of a unit's own keep their moments.
        """

        def of_kind(inputs: JointInputs) -> JointInputs:
            if inputs is former:
                return changed
            names = inputs.shared_names
            concerned = [{k: v for k, v in one.items() if k in names} for one in (means, stds)]
            return inputs.with_moments(*concerned)

        return replace(self, inputs=tuple(map(of_kind, self.inputs)))


@dataclass(frozen=True)
class ModelOfKinds:
    """The models of all kinds of units as one, whose rows end with the number of a kind.

    Attributes
    ----------
    models
        Of each kind.
    dimensions
        How many columns each of them takes, from the left.
    """

    models: tuple[Model, ...]
    dimensions: tuple[int, ...]

    def __call__(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, d)."""
        y = np.empty(len(x))
        for kind, (model, d) in enumerate(zip(self.models, self.dimensions, strict=True)):
            own = x[:, -1] == kind
            if own.any():
                found = numbers_in(model(np.ascontiguousarray(x[own, :d])))
                if found.shape not in {(count := int(own.sum()),), (count, 1)}:
                    raise ValueError(f"it returned shape {found.shape} for {count} samples")
                y[own] = found.reshape(count)
        return y


def _is_same(one: Model | None, other: Model | None) -> bool:
    """Whether two models are one: a method of an object is another one whenever it is named."""
    return one is other or (isinstance(one, MethodType) and one == other)


def _alike(one: JointInputs, other: JointInputs, of_problem: JointInputs) -> bool:
    """Whether own inputs of two units are the same; the problem's may yet get other moments."""
    if one is of_problem or one.n_shared != other.n_shared:
        return False
    return same_distribution(one.distribution, other.distribution)


def _inputs_of(unit: Unit, inputs: JointInputs) -> JointInputs:
    """Return the inputs of a unit with individual ones of its own."""
    if isinstance(unit.individual, Sized) and len(unit.individual) == 0:
        return shared_inputs(inputs)
    joined = with_other_inputs(inputs, individual=unit.individual)
    names = (*inputs.shared_names, *joined.individual_names)
    if len(set(names)) < len(names):
        remedy = f"its inputs are called {', '.join(joined.individual_names)}, as shared ones are"
        raise refused("individual", unit.individual, remedy)
    return replace(joined, names=names)
