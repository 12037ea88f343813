"""Points where a surface crosses the thresholds that decide the answers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from uqfold.methods.active_question import Answers
from uqfold.surrogates.importance_cloud import ImportanceCloud, importance_cloud
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray

_LAYERS = (1500, 1000, 1000)
# Half the thickness with which limits are seen, in standard deviations of the inputs: while they
# are sought, and in the end, then as a share of the distance over which the tail falls by a factor
# e. Steep and flat parts of a limit are seen alike.
_WIDE, _THIN = 0.3, 0.25
_STEP = 0.05
# Least thickness, as a share of the scatter of responses.
_LEAST = 1e-4


def limit_cloud(
    surface: Surface,
    std: Surface | None,
    scatter: float,
    answers: Answers,
    rng: np.random.Generator,
) -> tuple[ImportanceCloud, FloatArray]:
    """Draw a cloud that follows the influence of a surface on answers; and this influence (C, N).

    Parameters
    ----------
    surface
        Values (m,) at points (m, d).
    std
        Their standard deviations (m,); None: they are known.
    scatter
        Standard deviation of the responses.
    answers
        What hangs on the surface.
    rng
        Source of randomness.
    """
    d = answers.dimension
    least = max(_LEAST * scatter, 1e-300)
    centre = float(surface(np.zeros((1, d)))[0])
    across = rng.standard_normal(d)

    def known(u: FloatArray, half: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, ...]:
        """Values, their standard deviations, and half the thickness in the unit of these."""
        values, length = surface(u), np.sqrt((u**2).sum(axis=1))
        outwards = u / np.maximum(length, 1e-300)[:, None]
        # another direction, since a limit may lie along the first one
        sideways = across - (outwards @ across)[:, None] * outwards
        sideways /= np.maximum(np.sqrt((sideways**2).sum(axis=1)), 1e-300)[:, None]
        slopes = [(surface(u + _STEP * way) - values) / _STEP for way in (outwards, sideways)]
        slope = np.sqrt(slopes[0] ** 2 + (d - 1) * slopes[1] ** 2)
        error = np.full(u.shape[0], least) if std is None else np.maximum(std(u), least)
        return values, error, np.maximum(half(length) * slope, least)

    def wide(length: FloatArray) -> FloatArray:
        return np.full(length.shape, _WIDE)

    def thin(length: FloatArray) -> FloatArray:
        return _THIN / np.maximum(length, 1.0)

    def wanted(u: FloatArray) -> FloatArray:
        return answers.influence_at(u, *known(u, wide))

    def beyond(u: FloatArray) -> FloatArray:
        values, error, _ = known(u, wide)
        return answers.beyond(u, values, error, centre)

    # a steep limit is met by few points of a wide layer, what lies beyond it by many
    cloud = importance_cloud(wanted, d, rng, _LAYERS, beyond)
    return cloud, answers.influence_at(cloud.u, *known(cloud.u, thin))
