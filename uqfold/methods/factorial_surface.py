"""The polynomial through the responses of a full-factorial design, and runs that correct it.

Through the responses at the m_1 x ... x m_d nodes t of the design goes one polynomial of degree
m_i - 1 in each input,

    p(t) = sum_{j_1 ... j_d} y_{j_1 ... j_d} l_{j_1}(t_1) ... l_{j_d}(t_d)

with Lagrange's polynomials l. Further responses at m_i + 2 nodes on the line through the middle
node c along each input give a correction of each input alone,

    q(t) = p(t) + sum_i [p_i(t_i) - p(c_1, ..., t_i, ..., c_d)],

where p_i is the polynomial of degree m_i + 1 on that line: what m_i + 2 nodes would see of this
input beside the middle of the others, at m_i + 2 runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray


@dataclass(frozen=True, eq=False)
class FactorialSurface:
    """Responses on a product of nodes, and corrections along single inputs.

    Attributes
    ----------
    nodes
        Nodes (m_i,) of every input.
    table
        Responses (m_1, ..., m_d).
    lines
        For every input nodes (n_i,) on its line and what to add there (n_i,); may be empty.
    """

    nodes: tuple[FloatArray, ...]
    table: FloatArray
    lines: tuple[tuple[FloatArray, FloatArray], ...] = ()

    def on_grid(self, grid: Sequence[FloatArray]) -> FloatArray:
        """Return its values (g_1, ..., g_d) on the product of nodes (g_i,) of every input."""
        values = self.table
        for axis, (nodes, wanted) in enumerate(zip(self.nodes, grid, strict=True)):
            moved = np.tensordot(_lagrange(nodes, wanted), values, axes=(1, axis))
            values = np.moveaxis(moved, 0, axis)
        for axis, (nodes, added) in enumerate(self.lines):
            shape = [1] * len(grid)
            shape[axis] = -1
            values = values + (_lagrange(nodes, grid[axis]) @ added).reshape(shape)
        return values

    def at(self, points: FloatArray) -> FloatArray:
        """Return its values (n,) at a few points (n, d)."""
        return np.array([self.on_grid([*point[:, None]]).item() for point in points])

    @property
    def middle(self) -> FloatArray:
        """The middle node (d,)."""
        return np.array([nodes[nodes.size // 2] for nodes in self.nodes])


def _lagrange(nodes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return Lagrange's polynomials of some nodes (m,) at other places: (n, m)."""
    scale = np.ptp(nodes)
    x = (wanted[:, None] - nodes) / scale
    apart = (nodes[:, None] - nodes) / scale
    np.fill_diagonal(apart, 1.0)
    others = ~np.eye(nodes.size, dtype=bool)
    products = [x[:, others[j]].prod(axis=1) for j in range(nodes.size)]
    return np.asarray(np.stack(products, axis=1) / apart.prod(axis=1))
