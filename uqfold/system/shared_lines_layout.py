"""Where surfaces of several kinds are evaluated if some units share all of their variables.

Lines in the space of the shared variables (`uqfold.system.shared_lines`) cross the limits of all
units that have no others. Over one shared variable there is one line; over two, they lie in equal
steps; over more, they are spread where a rough look finds that the system fails.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.system.cross_rules import LADDER, ladder_rule, quasi_random_rule
from uqfold.system.lines import LineRule
from uqfold.system.places import Places, failure_places
from uqfold.system.refinement import Compared, gradients_of, principal, shared_axes
from uqfold.system.shared_lines import Certain, Chances, SharedLines, along_lines
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem
from uqfold.system.surface_plan import plan_surface
from uqfold.system.surface_rule import Surface, SurfaceRule, joined
from uqfold.typing import FloatArray

# Stations along the only line, along each of several, and along those that tell changes.
_ALONE, _EACH, _COARSE = 65, 33, 17
# Lines over two shared variables, spread over more of them, and of both that tell changes.
_IN_STEPS, _SPREAD, _FEW_IN_STEPS, _FEW_SPREAD = 129, 512, 17, 32
# The same where no unit has variables of its own, so that each station is a single point.
_IN_STEPS_ALONE, _SPREAD_ALONE = 513, 2048
# A rough look: stations, places of the other variables, criteria.
_LOOKED, _OTHERS, _CRITERIA = 9, 9, 3
# Directions tried, beside those that the surfaces suggest; and how many of these are combined.
_TRIED, _COMBINED = 64, 6


def laid_out_on_shared_lines(
    surfaces: Sequence[Surface],
    dimensions: Sequence[int],
    n_shared: int,
    units: SystemUnits,
    criteria: Sequence[Criterion],
    asked: Sequence[FloatArray],
    max_points: int,
) -> SurfaceSystem:
    """Lay out the points for surfaces some of which, or all, have shared variables alone.

    Parameters
    ----------
    surfaces, dimensions
        Of each kind of units, and its number of variables.
    n_shared
        How many of them (the first ones) are shared.
    units
        The units and their structure.
    criteria
        The questions, none of them with tau.
    asked
        Thresholds of each kind that tables are to hold exactly.
    max_points
        Most points at which the surfaces are to be evaluated for an answer.
    """
    axes = _axes(surfaces, dimensions, n_shared)
    share = max_points // max(1, sum(size > n_shared for size in dimensions))
    plans = [
        plan_surface(
            surface, size, n_shared, compared=Compared(own), max_points=share, shared=axes
        )
        if size > n_shared
        else None
        for surface, size, own in zip(surfaces, dimensions, asked, strict=True)
    ]  # fmt: skip
    lines = _lines(axes, surfaces, dimensions, units, criteria)

    def rules(shared: SharedLines, *, coarse: bool) -> tuple[SurfaceRule, ...]:
        nodes = shared.nodes, shared.node_weights
        return tuple(
            SurfaceRule(*nodes, LineRule.point(), 0.0, shared_lines=shared)
            if plan is None
            else plan.on_shared_lines(shared, share, own, coarse=coarse)
            for plan, own in zip(plans, asked, strict=True)
        )

    many, few = lines
    return SurfaceSystem(rules(many, coarse=False), rules(few, coarse=True), units, together=False)


def _axes(surfaces: Sequence[Surface], dimensions: Sequence[int], n_shared: int) -> FloatArray:
    """Directions (s, s) of the shared variables; the first crosses the limits of all units.

    That is, of those without other variables: the one along which the flattest of them, relative to
    its own gradients, is steepest.
    """
    every = shared_axes(surfaces, dimensions, n_shared)
    if n_shared == 1:
        return every
    alone = []
    for surface, size in zip(surfaces, dimensions, strict=True):
        if size == n_shared:
            gradients = gradients_of(surface, size)
            scale = np.sqrt(np.mean(np.sum(gradients**2, axis=1)))
            alone.append(gradients / (scale if scale > 0.0 else 1.0))
    main = np.array([principal(one)[:, 0] for one in alone[:_COMBINED]])
    signs = np.array(list(itertools.product((1.0, -1.0), repeat=len(main))))
    drawn = np.random.default_rng(0).standard_normal((_TRIED, n_shared))
    tried = np.concatenate([signs @ main, main, drawn])
    length = np.linalg.norm(tried, axis=1)
    tried = tried[length > 1e-6] / length[length > 1e-6, None]
    steep = np.array([np.sqrt(np.mean((one @ tried.T) ** 2, axis=0)) for one in alone])
    first = tried[int(np.argmax(np.round(steep.min(axis=0), 6)))]
    return np.asarray(np.linalg.qr(np.column_stack([first, every]))[0][:, :n_shared])


def _lines(
    axes: FloatArray,
    surfaces: Sequence[Surface],
    dimensions: Sequence[int],
    units: SystemUnits,
    criteria: Sequence[Criterion],
) -> tuple[SharedLines, SharedLines]:
    """Lines for answers, and fewer for changes of answers."""
    across = axes.shape[0] - 1
    alone = max(dimensions) == axes.shape[0]
    if across == 0:
        only = np.zeros((1, 0)), np.ones(1)
        return SharedLines.at(axes, *only, _ALONE), SharedLines.at(axes, *only, _EACH)
    if across == 1:
        in_steps = _IN_STEPS_ALONE if alone else _IN_STEPS
        many, few = (ladder_rule(LADDER.index(size)) for size in (in_steps, _FEW_IN_STEPS))
        return (
            SharedLines.at(axes, many[0][:, None], many[1], _EACH),
            SharedLines.at(axes, few[0][:, None], few[1], _COARSE),
        )
    places = _places(axes, surfaces, dimensions, units, criteria)

    def spread(size: int, stations: int) -> SharedLines:
        starts = places.spread(size)
        weights = np.exp(-places.log_density(starts)) / size
        return SharedLines.at(axes, starts, weights, stations, sampled=True)

    return spread(_SPREAD_ALONE if alone else _SPREAD, _EACH), spread(_FEW_SPREAD, _COARSE)


def _places(
    axes: FloatArray,
    surfaces: Sequence[Surface],
    dimensions: Sequence[int],
    units: SystemUnits,
    criteria: Sequence[Criterion],
) -> Places:
    """Find where lines lead to failure, or to success where this is rarer.

    Units with variables of their own are looked at roughly: their responses count as normal.
    """
    ordered = sorted(criteria, key=lambda one: one.threshold)
    picked = np.linspace(0, len(ordered) - 1, min(len(ordered), _CRITERIA)).round()
    some = [ordered[int(i)] for i in picked]
    asked = units.thresholds([one.threshold for one in some])
    n_shared = axes.shape[0]
    sides: list[int] = []

    def failing(starts: FloatArray) -> FloatArray:
        lines = SharedLines.at(axes, starts, np.ones(len(starts)), _LOOKED)
        nodes, shape = lines.nodes, lines.shape
        scores = np.zeros((*asked.shape, *shape))
        certain = {}
        for kind, (surface, size) in enumerate(zip(surfaces, dimensions, strict=True)):
            if size == n_shared:
                certain[kind] = Certain(surface(nodes).reshape(shape))
                continue
            others = quasi_random_rule(size - n_shared, _OTHERS)[0]
            values = surface(joined(nodes, others)).reshape(*shape, -1)
            std = np.maximum(values.std(axis=2), 1e-12 * np.abs(values).max())
            for sort in np.flatnonzero(units.of_kinds == kind):
                scores[sort] = (values.mean(axis=2) - asked[sort][:, None, None]) / std
        from scipy.special import ndtr

        chances = Chances(ndtr(scores), ndtr(-scores))
        found = along_lines(lines.stations, chances, certain, units, some)
        if not sides:
            sides.extend(np.argmin(found.mean(axis=2), axis=0).tolist())
        return np.array([found[side, row] for row, side in enumerate(sides)])

    return failure_places(failing, n_shared - 1, np.random.default_rng(2))
