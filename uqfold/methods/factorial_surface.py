"""The polynomial through the responses of a design of Gauss nodes, and runs that correct it.

Through the responses at a product of m_1 x ... x m_d nodes t goes one polynomial of degree m_i - 1
in each input,

    p(t) = sum_{j_1 ... j_d} y_{j_1 ... j_d} l_{j_1}(t_1) ... l_{j_d}(t_d)

with Lagrange's polynomials l. A design may be several such products, each with a share: the sum of
shares times polynomials is then the surface. Further responses at n_i nodes on the line through the
middle c of the design along input i give a correction of this input alone,

    q(t) = p(t) + sum_i [p_i(t_i) - p(c_1, ..., t_i, ..., c_d)],

where p_i is the polynomial on that line: what n_i nodes would see of this input beside the middle
of the others, at n_i runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Patch:
    """Responses on one product of nodes.

    Attributes
    ----------
    share
        Factor of its polynomial in the surface; they sum to one.
    nodes
        Nodes (m_i,) of every input; one node alone leaves the input out.
    table
        Responses (m_1, ..., m_d).
    """

    share: float
    nodes: tuple[FloatArray, ...]
    table: FloatArray


@dataclass(frozen=True, eq=False)
class FactorialSurface:
    """Responses on products of nodes, and corrections along single inputs.

    Attributes
    ----------
    patches
        The products.
    middle
        A node (d,) that all of them have.
    lines
        Corrections: an input's position, nodes (n,) on its line, and what to add there (n,).
    """

    patches: tuple[Patch, ...]
    middle: FloatArray
    lines: tuple[tuple[int, FloatArray, FloatArray], ...] = ()

    @classmethod
    def of_product(cls, nodes: tuple[FloatArray, ...], table: FloatArray) -> FactorialSurface:
        """Build it from the responses on one product of nodes."""
        middle = np.array([places[places.size // 2] for places in nodes])
        return cls((Patch(1.0, nodes, table),), middle)

    def on_grid(self, grid: Sequence[FloatArray]) -> FloatArray:
        """Return its values (g_1, ..., g_d) on the product of nodes (g_i,) of every input."""
        total = np.zeros([places.size for places in grid])
        # beside one response, so that a constant stays what it is to the last bit
        origin = self.patches[0].table.flat[0]
        for patch in self.patches:
            values = patch.table - origin
            for axis, (nodes, wanted) in enumerate(zip(patch.nodes, grid, strict=True)):
                if nodes.size > 1:
                    moved = np.tensordot(_lagrange(nodes, wanted), values, axes=(1, axis))
                    values = np.moveaxis(moved, 0, axis)
            total += patch.share * values
        for axis, nodes, added in self.lines:
            shape = [1] * len(grid)
            shape[axis] = -1
            total += (_lagrange(nodes, grid[axis]) @ added).reshape(shape)
        return np.asarray(total + origin)

    def at(self, points: FloatArray) -> FloatArray:
        """Return its values (n,) at a few points (n, d)."""
        return np.array([self.on_grid([*point[:, None]]).item() for point in points])

    def on_lines(self, lines: Sequence[tuple[int, FloatArray]]) -> FloatArray:
        """Return points (n, d) on lines through the middle: inputs' positions and places there."""
        points = []
        for axis, places in lines:
            here = np.tile(self.middle, (places.size, 1))
            here[:, axis] = places
            points.append(here)
        return np.concatenate([np.empty((0, self.middle.size)), *points])

    def with_lines(
        self, lines: Sequence[tuple[int, FloatArray]], run: Callable[[FloatArray], FloatArray]
    ) -> FactorialSurface:
        """Correct it along single inputs.

        Parameters
        ----------
        lines
            Inputs' positions and places (n,) beside the middle.
        run
            Takes points (n, d), gives the responses (n,) there.
        """
        points = self.on_lines(lines)
        differences = run(points) - self.at(points)
        corrections = list(self.lines)
        start = 0
        for axis, places in lines:
            added = differences[start : start + places.size]
            start += places.size
            # the middle has been run: nothing is to be added there
            nodes = np.append(places, self.middle[axis])
            corrections.append((axis, nodes, np.append(added, 0.0)))
        return replace(self, lines=tuple(corrections))


def _lagrange(nodes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return Lagrange's polynomials of some nodes (m,) at other places: (n, m)."""
    scale = np.ptp(nodes)
    x = (wanted[:, None] - nodes) / scale
    apart = (nodes[:, None] - nodes) / scale
    np.fill_diagonal(apart, 1.0)
    others = ~np.eye(nodes.size, dtype=bool)
    products = [x[:, others[j]].prod(axis=1) for j in range(nodes.size)]
    return np.asarray(np.stack(products, axis=1) / apart.prod(axis=1))
