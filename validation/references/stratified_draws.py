"""Standard-normal inputs of one block: shared draws, and units stratified along one direction.

The response of a unit changes mostly along one direction of its individual inputs. The
standard-normal coordinate in that direction is cut into strata, far into both tails. A replicate
is one response out of each stratum, weighted with the stratum's probability: its weighted shares
estimate the distribution of one unit without bias, wherever the direction points and however the
model behaves. The direction, taken from the low-fidelity partner, only says where errors get small.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri
from scipy.stats.qmc import Sobol

from uqfold.inputs import JointInputs
from uqfold.typing import FloatArray, Model


@dataclass(frozen=True)
class Strata:
    """Strata of a standard-normal variable.

    Attributes
    ----------
    edges
        Edges between them, ascending.
    """

    edges: tuple[float, ...]

    @property
    def count(self) -> int:
        """Number of strata L."""
        return len(self.edges) + 1

    @property
    def probabilities(self) -> FloatArray:
        """Their probabilities (L,), each from its nearer tail, so that small ones are exact."""
        low, high = self._ends
        upper = low >= 0.0
        found: FloatArray = np.where(upper, ndtr(-low) - ndtr(-high), ndtr(high) - ndtr(low))
        return found

    def draw(self, rng: np.random.Generator, size: int) -> FloatArray:
        """Draw one value from each stratum, `size` times over: (size, L)."""
        low, high = self._ends
        sign = np.where(low >= 0.0, -1.0, 1.0)  # the upper tail by its mirror image
        near, far = ndtr(sign * low), ndtr(sign * high)
        level = near + (far - near) * (1.0 - rng.random((size, self.count)))
        # the first stratum begins at probability 0, which rounding may reach
        value: FloatArray = sign * ndtri(np.maximum(level, np.finfo(np.float64).tiny))
        return value

    @property
    def _ends(self) -> tuple[FloatArray, FloatArray]:
        return np.array([-np.inf, *self.edges]), np.array([*self.edges, np.inf])


def steepest_direction(model: Model, inputs: JointInputs) -> FloatArray:
    """Direction (n_individual,) in which the response rises most, at the medians of the inputs.

    Raises
    ------
    ValueError
        If the response does not change there.
    """
    step = 0.01
    here = np.zeros((2 * inputs.n_individual, inputs.dimension))
    here[:, inputs.n_shared :] = np.repeat(step * np.eye(inputs.n_individual), 2, axis=0)
    here[1::2] *= -1.0
    y = model(inputs.from_standard_normal(here))
    gradient = y[::2] - y[1::2]
    length = float(np.linalg.norm(gradient))
    if not 0.0 < length < np.inf:
        raise ValueError(f"the response has the gradient {gradient} at the medians: no direction")
    direction: FloatArray = gradient / length
    return direction


def block_inputs(
    inputs: JointInputs,
    direction: FloatArray,
    strata: Strata,
    rng: np.random.Generator,
    draws: int,
    replicates: int,
) -> FloatArray:
    """Draw the inputs of one block.

    The shared draws are a scrambled Sobol sequence, each of them uniform, so that the mean over a
    block has no bias.

    Parameters
    ----------
    inputs
        Shared and individual inputs.
    direction
        Unit vector (n_individual,).
    strata
        Strata along it.
    rng
        Stream of this block.
    draws, replicates
        Shared draws (a power of 2), and replicates of each.

    Returns
    -------
    FloatArray
        X (draws * replicates * L, d), the strata running fastest.
    """
    per_draw = replicates * strata.count
    level = Sobol(inputs.n_shared, scramble=True, rng=rng).random(draws)
    shared = ndtri(np.maximum(level, np.finfo(np.float64).tiny))
    along = strata.draw(rng, draws * replicates).reshape(-1, 1)
    own = rng.standard_normal((draws * per_draw, inputs.n_individual))
    own += (along - own @ direction[:, None]) * direction
    return inputs.from_standard_normal(np.column_stack([np.repeat(shared, per_draw, axis=0), own]))
