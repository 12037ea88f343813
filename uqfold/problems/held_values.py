"""A problem with some of its discrete inputs held at one value each.

The failure probability is the mean, over the values of a shared input, of that given the value: an
exact sum. An individual input is drawn anew for every unit and mission, so that it can be held only
where there is one of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, Model

_NEGLECTED = 1e-12
"""Probability of the values of one input that are left out, at most."""


@dataclass(frozen=True, eq=False)
class HeldValues:
    """Values of discrete inputs, one row for each combination.

    Attributes
    ----------
    names
        The j inputs.
    values, probabilities
        Combinations (k, j) and their probabilities (k,), the least likely first.
    neglected
        Probability of all values that are left out.
    """

    names: tuple[str, ...]
    values: FloatArray
    probabilities: FloatArray
    neglected: float

    def said(self, row: int) -> str:
        """Return a combination as text."""
        pairs = zip(self.names, self.values[row].tolist(), strict=True)
        return ", ".join(f"{name} = {value:g}" for name, value in pairs)


def held_values(problem: Problem, criteria: Sequence[Criterion], most: int) -> HeldValues | str:
    """Return all combinations of the values of discrete inputs, or why these cannot be held.

    Parameters
    ----------
    problem
        A problem some inputs of which have steps.
    criteria
        What will be asked.
    most
        Combinations at most.
    """
    inputs, name = problem.inputs, problem.kinds.with_steps[0]
    if len(problem.kinds.models) > 1:
        return f"{name} is discrete, in units with models or inputs of their own"
    columns = [i for i, one in enumerate(inputs.columns) if one.steps]
    if len(columns) == inputs.dimension:
        return f"{name} is discrete, and so are all others"
    linked = {column for part in inputs.parts.dependent for column in part.columns}
    alone = problem.n_units == 1 and all(one.missions == 1 for one in criteria)
    tables, neglected = [], 0.0
    for i in columns:
        values, p = inputs.columns[i].atoms
        order = np.argsort(p, kind="stable")
        order = order[np.cumsum(p[order]) > _NEGLECTED]
        if i in linked:
            return f"{inputs.names[i]} is discrete and depends on others"
        if i >= inputs.n_shared and not alone:
            return f"{inputs.names[i]} is discrete, and drawn anew for every unit and mission"
        if len(values) > len(order) > most or abs(float(p.sum()) - 1.0) > _NEGLECTED:
            return f"{inputs.names[i]} takes more than {most} values"
        neglected += float(p.sum() - p[order].sum())
        tables.append((values[order], p[order]))
    count = int(np.prod([len(values) for values, _ in tables]))
    if count > most:
        named = ", ".join(inputs.names[i] for i in columns)
        return f"{named} take {count} values together, {most} are the most"
    rows = np.array(list(product(*(values for values, _ in tables))))
    p = np.array([np.prod(one) for one in product(*(p for _, p in tables))])
    likely = np.argsort(p, kind="stable")
    names = tuple(inputs.names[i] for i in columns)
    return HeldValues(names, rows[likely], p[likely], neglected)


def with_values(problem: Problem, held: HeldValues, row: int) -> Problem:
    """Return the problem of the other inputs, with those held at one combination."""
    inputs = problem.inputs
    at = tuple(inputs.names.index(name) for name in held.names)
    rest = [i for i in range(inputs.dimension) if i not in at]
    n_shared = sum(i < inputs.n_shared for i in rest)
    place = Place(at, tuple(held.values[row].tolist()), inputs.dimension)
    units = problem.units
    if not isinstance(units, int):
        own: dict[str, Any] = {"model": None, "individual": None, "low_fidelity": None}
        units = tuple(replace(unit, **own) for unit in units)
    partner, gradient = problem.low_fidelity, problem.gradient
    return replace(
        problem,
        model=HeldModel(problem.model, place),
        inputs=replace(inputs.in_order(rest), n_shared=n_shared),
        units=units,
        low_fidelity=None if partner is None else HeldModel(partner, place),
        gradient=None if gradient is None else HeldGradient(gradient, place),
        version=None,
        input_units=tuple(problem.input_units[i] for i in rest),
        references=None,
    )


@dataclass(frozen=True)
class Place:
    """Where values are held among the columns of a model.

    Attributes
    ----------
    at, values
        The columns, and their values.
    dimension
        Columns of the model.
    """

    at: tuple[int, ...]
    values: tuple[float, ...]
    dimension: int

    def rows(self, x: FloatArray) -> FloatArray:
        """Return rows for the model (n, dimension) of those without what is held (n, rest)."""
        whole = np.empty((len(x), self.dimension))
        whole[:, list(self.at)] = self.values
        whole[:, [i for i in range(self.dimension) if i not in self.at]] = x
        return whole


@dataclass(frozen=True)
class HeldModel:
    """A model of the inputs that are not held."""

    model: Model
    place: Place

    def __call__(self, x: FloatArray) -> Any:
        """Return responses (n,) to X (n, rest)."""
        return self.model(self.place.rows(x))


@dataclass(frozen=True)
class HeldGradient:
    """A gradient by the inputs that are not held."""

    gradient: Model
    place: Place

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return derivatives (n, rest) at X (n, rest)."""
        return np.delete(np.asarray(self.gradient(self.place.rows(x))), list(self.place.at), axis=1)
