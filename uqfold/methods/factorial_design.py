"""Full-factorial numerical integration (FFNI): the design, and what its responses say.

The nodes are the product of one Gauss rule per input, Eq. (31). At each shared node the responses
over the individual nodes give the first four moments of the conditional response, Eqs. (33) and
(41), from which a method builds the conditional distribution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from uqfold.checks import check_scatter, refused, several, whole
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import JointInputs, normal
from uqfold.inputs.gauss import MAX_GAUSS_NODES, gauss_rule
from uqfold.methods.task import Task
from uqfold.moments.conditional import ConditionalDistribution
from uqfold.moments.cumulants import Moments, moments_from_rule
from uqfold.moments.families import Fit
from uqfold.moments.quadrature import tensor_grid
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.time_limit import check_time
from uqfold.typing import BoolArray, FloatArray

Nodes: TypeAlias = int | tuple[int, ...]
MAX_NUMBERS = 100_000_000
"""Coordinates of all nodes of a design together: 0.8 GB, as many again while they are laid out."""


@dataclass(frozen=True)
class FactorialDesign:
    """Nodes and weights of a full-factorial rule.

    Attributes
    ----------
    x
        Inputs (K * Q, d): K shared nodes, each with Q individual nodes running fastest.
    shared_weights
        Weights (K,) of the shared nodes.
    individual_weights
        Weights (Q,) of the individual nodes.
    shared_nodes
        The shared inputs (K, d_shared) themselves.
    """

    x: FloatArray
    shared_weights: FloatArray
    individual_weights: FloatArray
    shared_nodes: FloatArray


@dataclass(frozen=True)
class FFNIDetails:
    """Moments of the conditional response at every shared node.

    Attributes
    ----------
    shared_nodes, weights
        Shared inputs (K, d_shared) and their quadrature weights (K,).
    moments
        Mean, standard deviation, skewness and kurtosis (K,) over the finite responses.
    distributions
        The conditional distribution fitted at each node, or None where no response is finite.
    p_never, p_always, p_missing
        Quadrature mass (K,) of +inf responses, of -inf responses and of failed runs at each node.
    of_other_kinds
        The same of other kinds of units, in the order in which they occur.
    """

    shared_nodes: FloatArray
    weights: FloatArray
    moments: Moments
    distributions: tuple[ConditionalDistribution | None, ...]
    p_never: FloatArray
    p_always: FloatArray
    p_missing: FloatArray
    of_other_kinds: tuple[FFNIDetails, ...] = ()

    @property
    def infinite(self) -> float:
        """Weight of the nodes at which the response is infinite, of either sign."""
        return float(self.weights @ (self.p_never + self.p_always))

    @property
    def complete(self) -> BoolArray:
        """Shared nodes (K,) at which no run failed."""
        return np.asarray(self.p_missing == 0.0, dtype=bool)

    @property
    def responses(self) -> list[ConditionalResponse]:
        """The conditional response at every shared node."""
        masses = zip(self.p_never, self.p_always, self.p_missing, strict=True)
        return [
            ConditionalResponse(distribution, float(never), float(always), float(missing))
            for distribution, (never, always, missing) in zip(
                self.distributions, masses, strict=True
            )
        ]


def checked_nodes(name: str, nodes: Any) -> Nodes:
    """Return a setting of node counts: one for all inputs, or a tuple with one for each.

    Raises
    ------
    ValueError, TypeError
        If a count is not a whole number from 2 to 64, or there is none; one node alone would say
        nothing about its input.
    """
    if isinstance(nodes, Sequence) and not isinstance(nodes, str | bytes | bytearray):
        counts = several(name, nodes, whole, at_least=2, at_most=MAX_GAUSS_NODES)
        if not counts:
            raise refused(name, nodes, "give a count for each input, or one for all of them")
        return counts
    return whole(name, nodes, at_least=2, at_most=MAX_GAUSS_NODES)


def design_size(inputs: JointInputs, shared: Nodes, individual: Nodes) -> int:
    """Count the nodes of the design, that is its evaluations."""
    return math.prod(counts_per_input(inputs, shared, individual))


def counts_per_input(inputs: JointInputs, shared: Nodes, individual: Nodes) -> list[int]:
    """Return the number of nodes of every input, shared inputs first.

    Raises
    ------
    ValueError
        If the settings do not fit the inputs.
    """
    return [
        *_per_variable("nodes_shared", shared, inputs.n_shared),
        *_per_variable("nodes_individual", individual, inputs.n_individual),
    ]


def factorial_design(inputs: JointInputs, shared: Nodes, individual: Nodes) -> FactorialDesign:
    """Build the full-factorial design.

    Independent inputs take the Gauss rule of each marginal. Dependent inputs take Gauss-Hermite
    rules in the standard-normal space of the Rosenblatt transformation, shared inputs first, so
    that the individual nodes are those of the conditional distribution at each shared node.

    Raises
    ------
    ValueError
        If the node counts do not fit the inputs, or a marginal has no Gauss rule.
    """
    counts = counts_per_input(inputs, shared, individual)
    if inputs.independent:
        rules = [inputs.gauss_rule(i, n) for i, n in enumerate(counts)]
    else:
        standard = normal(0.0, 1.0)
        rules = [gauss_rule(standard, n) for n in counts]
    v, shared_weights = tensor_grid(rules[: inputs.n_shared])
    u, individual_weights = tensor_grid(rules[inputs.n_shared :])
    nodes = np.hstack([np.repeat(v, len(u), axis=0), np.tile(u, (len(v), 1))])
    x = nodes if inputs.independent else inputs.from_standard_normal(nodes)
    return FactorialDesign(
        x=x,
        shared_weights=shared_weights,
        individual_weights=individual_weights,
        shared_nodes=x[:: len(u), : inputs.n_shared],
    )


def conditional_responses(
    design: FactorialDesign, y: FloatArray, fit: Fit
) -> tuple[list[ConditionalResponse], FFNIDetails]:
    """Turn the responses at the nodes into one conditional response per shared node.

    Parameters
    ----------
    design
        The design.
    y
        Responses (K * Q,); +-inf become atoms, NaN (failed runs) missing mass.
    fit
        Builds the distribution of the finite responses from their moments.

    Returns
    -------
    tuple[list[ConditionalResponse], FFNIDetails]
    """
    w = design.individual_weights
    table = y.reshape(len(design.shared_weights), len(w))
    finite = np.isfinite(table)
    never = (np.isposinf(table) * w).sum(axis=1)
    always = (np.isneginf(table) * w).sum(axis=1)
    missing = (np.isnan(table) * w).sum(axis=1)
    moments = moments_from_rule(table, w, finite)
    distributions: list[ConditionalDistribution | None] = []
    for k, some in enumerate(np.asarray(finite.any(axis=1))):
        check_time()
        distributions.append(fit(moments.of(k)) if some else None)
    details = FFNIDetails(
        shared_nodes=design.shared_nodes,
        weights=design.shared_weights,
        moments=moments,
        distributions=tuple(distributions),
        p_never=never,
        p_always=always,
        p_missing=missing,
    )
    return details.responses, details


def _per_variable(name: str, nodes: Nodes, n_variables: int) -> Sequence[int]:
    if isinstance(nodes, int):
        return [nodes] * n_variables
    if len(nodes) != n_variables:
        raise ValueError(f"{name} = {nodes} names {len(nodes)} counts for {n_variables} inputs")
    return nodes


def affordable_design(task: Task, shared: Nodes, individual: Nodes) -> FactorialDesign:
    """Build the design of units of one kind if the budget allows it; see `affordable_designs`."""
    return affordable_designs(task, shared, individual)[0]


def affordable_designs(task: Task, shared: Nodes, individual: Nodes) -> list[FactorialDesign]:
    """Build the design of each kind of units, over the same shared nodes, if the budget allows it.

    Raises
    ------
    BudgetExceededError
        If it does not; the message names the settings to change. Nothing is spent then.
    """
    kinds = task.problem.kinds
    size = sum(design_size(inputs, shared, individual) for inputs in kinds.inputs)
    most = MAX_NUMBERS // kinds.dimension
    if size > min(task.session.remaining, most):
        limit = (
            f"at most {most} fit into memory"
            if size > most
            else f"max_evals = {task.session.max_evals}"
        )
        raise BudgetExceededError(
            f"the design has {size} nodes, {limit}: lower nodes_shared = {shared} or "
            f"nodes_individual = {individual}, or raise the budget"
        )
    task.session.expect(size)
    return [factorial_design(inputs, shared, individual) for inputs in kinds.inputs]


def details_of_kinds(
    task: Task, designs: Sequence[FactorialDesign], fit: Fit
) -> tuple[list[FFNIDetails], list[FloatArray]]:
    """Run the designs of all kinds of units, and return what their responses say, and these."""
    kinds = task.problem.kinds
    rows = [kinds.rows_of(kind, design.x) for kind, design in enumerate(designs)]
    found = task.session.evaluate(np.concatenate(rows))
    check_scatter(found)
    y = np.split(found, np.cumsum([len(one) for one in rows])[:-1])
    pairs = list(zip(designs, y, strict=True))
    details = task.summed_up(lambda _: [conditional_responses(*one, fit)[1] for one in pairs])
    return details, y


def joined_details(details: Sequence[FFNIDetails]) -> FFNIDetails:
    """Return those of the first kind, which hold those of the others."""
    return replace(details[0], of_other_kinds=tuple(details[1:]))
