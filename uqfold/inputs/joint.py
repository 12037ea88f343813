"""The joint distribution of a problem's inputs, shared inputs first.

All sampling and all quadrature pass through the standard-normal space of the Rosenblatt
transformation in this column order, so that the first `n_shared` standard-normal variables alone
determine the shared inputs, and the remaining ones the individual inputs given the shared.

References
----------
Rosenblatt M. Remarks on a multivariate transformation. Ann. Math. Statist. 23 (1952) 470-472.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from uqfold.checks import array, instance, real, refused, several, whole
from uqfold.inputs.behind import family_of
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.gauss import gauss_rule
from uqfold.inputs.marginal import Marginal, WithoutCaches, beyond
from uqfold.inputs.parts import Parts, check_part
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

_FIRST_ROWS, _MOST_ROWS = 64, 1 << 16
_BLOCK_SECONDS = 0.25
"""Rows are mapped in blocks of about so many seconds, between which a time limit is looked at."""


@dataclass(frozen=True, eq=False)
class JointInputs(WithoutCaches):
    """Ordered joint distribution of the shared inputs, then the individual ones.

    Attributes
    ----------
    parts
        The marginals and what depends on each other, columns in that order.
    columns
        The d inputs one by one, checked.
    names
        The d input names, all different.
    n_shared
        How many of the columns, counted from the left, are shared.
    """

    parts: Parts
    columns: tuple[Marginal, ...]
    names: tuple[str, ...]
    n_shared: int

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

    @property
    def independent(self) -> bool:
        """Whether all inputs are mutually independent."""
        return not self.parts.dependent

    @property
    def with_atoms(self) -> tuple[str, ...]:
        """Names of the inputs that take single values with positive probability."""
        pairs = zip(self.names, self.columns, strict=True)
        return tuple(name for name, column in pairs if column.atoms[0].size)

    @property
    def with_steps(self) -> tuple[str, ...]:
        """Names of the inputs that jump from one value to another, with none between them."""
        pairs = zip(self.names, self.columns, strict=True)
        return tuple(name for name, column in pairs if column.steps)

    @property
    def dependence(self) -> str:
        """``independent``, or the name of the copula that joins the inputs."""
        return "independent" if self.independent else str(self.distribution.getCopula().getName())

    @property
    def families(self) -> tuple[str, ...]:
        """Names of the d marginal families, as OpenTURNS calls them."""
        return tuple(family_of(marginal)[1] for marginal in self.marginals)

    @property
    def marginals(self) -> tuple[Any, ...]:
        """The d marginal distributions in OpenTURNS form; `columns` computes them rightly."""
        return self.parts.marginals

    @cached_property
    def distribution(self) -> Any:
        """OpenTURNS distribution of dimension d, columns in this order."""
        return self.parts.joined()

    @property
    def fingerprint(self) -> str:
        """Digest of the joint distribution: where it maps a few points of standard-normal space."""
        probe = np.sin(np.arange(1.0, 4 * self.dimension + 1.0)).reshape(4, self.dimension)
        mapped = self.from_standard_normal(probe).ravel()
        # nine digits: the last ones may differ between machines
        text = " ".join(f"{value:.9e}" for value in mapped)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def shared_are_a_group(self) -> bool:
        """Whether several inputs are shared, and others are not."""
        return 1 < self.n_shared < self.dimension

    def in_order(self, order: Sequence[int]) -> JointInputs:
        """Return the inputs with their columns in another order, none of them called shared.

        Raises
        ------
        ValueError
            If the dependence cannot be computed in that order.
        """
        last = self.dimension - 1
        order = several("order", order, whole, at_least=0, at_most=last)
        if len(set(order)) != len(order):
            raise refused("order", order, "give each column once")
        parts = self.parts.chosen(order)
        columns = tuple(self.columns[i] for i in order)
        names = tuple(self.names[i] for i in order)
        for part in parts.dependent:
            check_part(part, [columns[i] for i in part.columns], [names[i] for i in part.columns])
        return JointInputs(parts, columns, names, 0)

    @property
    def conditioning(self) -> tuple[tuple[str, ...], ...]:
        """For each input the names of those before it that it depends on (Rosenblatt order)."""
        found: list[tuple[str, ...]] = [()] * self.dimension
        for part in self.parts.dependent:
            for i, column in enumerate(part.columns):
                found[column] = tuple(self.names[before] for before in part.columns[:i])
        return tuple(found)

    @cached_property
    def _free(self) -> list[int]:
        """Columns that depend on nothing."""
        linked = {column for part in self.parts.dependent for column in part.columns}
        return [i for i in range(self.dimension) if i not in linked]

    @cached_property
    def means(self) -> FloatArray:
        """Means (d,) of the inputs, in their own units."""
        return np.array([column.moments[0] for column in self.columns])

    @cached_property
    def standard_deviations(self) -> FloatArray:
        """Standard deviations (d,) of the inputs, in their own units."""
        return np.array([column.moments[1] for column in self.columns])

    @cached_property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds of the inputs, each (d,); infinite where there is none."""
        both = np.array([column.bounds for column in self.columns], dtype=np.float64)
        return both[:, 0], both[:, 1]

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
        uqfold.evaluation.TimeLimitError
            If the time of the estimate under way is over.
        """
        return self._mapped("u", u, self._block_from_normal)

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
            beyond a bound of its distribution. An atom comes from an interval, of which this is the
            middle: it leads back to X where the inputs are independent.

        Raises
        ------
        ValueError
            If `x` has another number of columns.
        uqfold.evaluation.TimeLimitError
            If the time of the estimate under way is over.
        """
        return self._mapped("x", x, self._block_to_normal)

    def _block_from_normal(self, u: FloatArray) -> FloatArray:
        x = np.empty(u.shape)
        for i in self._free:
            x[:, i] = self.columns[i].from_normal(u[:, i])
        for part in self.parts.dependent:
            own = list(part.columns)
            x[:, own] = part.values(u[:, own], [self.columns[i] for i in own])
        return x

    def _block_to_normal(self, x: FloatArray) -> FloatArray:
        u = np.empty(x.shape)
        for i in self._free:
            u[:, i] = self.columns[i].to_normal(x[:, i])
        for part in self.parts.dependent:
            own = list(part.columns)
            u[:, own] = part.normals(x[:, own], [self.columns[i] for i in own])
        for i, column in enumerate(self.columns):
            u[:, i] = beyond(column.bounds, x[:, i], u[:, i])
        return u

    def _mapped(
        self, name: str, rows: FloatArray, block: Callable[[FloatArray], FloatArray]
    ) -> FloatArray:
        rows = array(name, rows, ("n", self.dimension), finite=False)
        mapped = np.empty(rows.shape)
        start, size = 0, _FIRST_ROWS
        while start < len(rows):
            check_time()
            began = time.perf_counter()
            mapped[start : start + size] = block(rows[start : start + size])
            spent = time.perf_counter() - began
            start += size
            share = _BLOCK_SECONDS / max(spent, 1e-9)
            size = int(np.clip(size * min(share, 8.0), 1, _MOST_ROWS))
        return mapped

    def log_density(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Logarithm of the density at rows X.

        Parameters
        ----------
        x
            Inputs X (n, d).

        Returns
        -------
        of_shared, of_individual
            Each (n,): of the shared inputs, and of the individual ones given these; of an atom its
            probability.

        Raises
        ------
        ValueError
            If an input with atoms depends on others.
        """
        x = array("x", x, ("n", self.dimension), finite=False)
        shared, all_of_them = np.zeros(len(x)), np.zeros(len(x))
        for i in self._free:
            alone = self.columns[i].log_pdf(x[:, i])
            all_of_them += alone
            if i < self.n_shared:
                shared += alone
        for part in self.parts.dependent:
            own = list(part.columns)
            if steps := [self.names[i] for i in own if self.columns[i].atoms[0].size]:
                raise ValueError(f"no joint density with {steps[0]}, which takes single values")
            columns = [self.columns[i] for i in own]
            all_of_them += part.log_density(x[:, own], columns)
            first = [i for i in own if i < self.n_shared]
            if first:
                shared += part.log_density(x[:, first], columns)
        return shared, all_of_them - shared

    def with_moments(
        self,
        means: Mapping[str, float] | None = None,
        standard_deviations: Mapping[str, float] | None = None,
    ) -> JointInputs:
        """Return the same inputs with other means or standard deviations; the copula stays.

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
        means = _changes("means", means, self.names)
        stds = _changes("standard_deviations", standard_deviations, self.names)
        columns = list(self.columns)
        for i, name in enumerate(self.names):
            if name in means or name in stds:
                mean, std = columns[i].moments
                moved = columns[i].with_moments(means.get(name, mean), stds.get(name, std))
                columns[i] = checked_marginal(moved, name)
        marginals = tuple(column.distribution for column in columns)
        parts = Parts(marginals, self.parts.dependent)
        return JointInputs(parts, tuple(columns), self.names, self.n_shared)

    def sample(self, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw `size` independent rows X (size, d)."""
        instance("rng", rng, np.random.Generator, "give a numpy.random.Generator")
        size = whole("size", size, at_least=0)
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
        column = whole("column", column, at_least=0, at_most=self.dimension - 1)
        return gauss_rule(self.columns[column], n)

    def __repr__(self) -> str:
        shared = ", ".join(self.shared_names) or "none"
        return f"JointInputs(shared: {shared}; individual: {', '.join(self.individual_names)})"


def _changes(
    argument: str, given: Mapping[str, float] | None, names: tuple[str, ...]
) -> dict[str, float]:
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise refused(argument, given, "give a mapping from names to values", TypeError)
    for name in given:
        if name not in names:
            raise refused(argument, given, f"{name!r} is not one of the inputs {list(names)}")
    return {name: real(f"{argument}[{name!r}]", value) for name, value in given.items()}
