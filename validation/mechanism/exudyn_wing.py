"""The folding wing built from the objects of exudyn, a general multibody code.

Three planar rigid bodies with three coordinates each, a revolute joint at A, a prismatic joint for
the slider; the forces of `bodies.py` are a user force on all nine coordinates. Exudyn brings
equations of motion, constraints and time integration.

Exudyn's steps are not cut at events. The onset velocity of a contact is interpolated between the
steps before and after the onset, the lock on the cubic through the ends of its step.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import exudyn
from exudyn import itemInterface
from scipy.interpolate import CubicHermiteSpline

from uqfold.mechanism import WingParameters
from validation.mechanism.bodies import Bodies


class ExudynWing:
    """One wing as a system of exudyn."""

    def __init__(self, p: WingParameters) -> None:
        self.p = p
        self.bodies = Bodies(p)
        self.reference = self.bodies.start()
        self.onset: list[float | None] = [None, None]
        # time, penetration and rate of both joints, place and speed of the slider
        self.before: tuple[float, list[tuple[float, float]], float, float] = (0.0, [], 0.0, 0.0)
        self.time = math.inf
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self._build()

    def _build(self) -> None:
        p, system = self.p, self.system
        ground = system.AddObject(itemInterface.ObjectGround())
        nodes, bodies = [], []
        for i, mass in enumerate(self.bodies.mass):
            pose, inertia = self.reference[3 * i : 3 * i + 3], self.bodies.inertia[i]
            nodes.append(system.AddNode(itemInterface.NodeRigidBody2D(referenceCoordinates=pose)))
            body = itemInterface.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=nodes[-1])
            bodies.append(system.AddObject(body))

        def marker(kind: Any, body: Any, x: float, y: float) -> Any:
            return system.AddMarker(kind(bodyNumber=body, localPosition=[x, y, 0.0]))

        point, frame = itemInterface.MarkerBodyPosition, itemInterface.MarkerBodyRigid
        A = [marker(point, ground, 0.0, 0.0), marker(point, bodies[0], -0.5 * p.l_1, 0.0)]
        system.AddObject(itemInterface.ObjectJointRevolute2D(markerNumbers=A))
        guide = [marker(frame, ground, 0.0, -p.c), marker(frame, bodies[2], 0.0, 0.0)]
        axes = {"axisMarker0": [1.0, 0.0, 0.0], "normalMarker1": [0.0, 1.0, 0.0]}
        system.AddObject(itemInterface.ObjectJointPrismatic2D(markerNumbers=guide, **axes))
        force = itemInterface.ObjectGenericODE2(nodeNumbers=nodes, forceUserFunction=self._force)
        system.AddObject(force)
        system.SetPreStepUserFunction(self._before_step)
        system.Assemble()

    def _pose(self, change: Any) -> list[float]:
        return [a + b for a, b in zip(self.reference, change, strict=True)]

    def _force(self, _: Any, t: float, __: int, change: Any, v: Any) -> list[float]:
        """Return the forces on the bodies."""
        q, v = self._pose(change), list(v)
        # within the step of the onset the velocity is still that of the onset
        onset = [
            started or max(self.bodies.penetration(q, v, which)[1], self.p.onset_velocity_floor)
            for which, started in enumerate(self.onset)
        ]
        return self.bodies.forces(t, q, v, onset)

    def _before_step(self, system: Any, _: float) -> bool:
        """Keep the onset velocities and watch the lock; False ends the simulation."""
        data = system.systemData
        # the clock already stands at the end of the step
        start = exudyn.ConfigurationType.StartOfStep
        t = data.GetTime(start)
        q, v = self._pose(data.GetODE2Coordinates(start)), list(data.GetODE2Coordinates_t(start))
        now = [self.bodies.penetration(q, v, which) for which in (0, 1)]
        for which, (depth, speed) in enumerate(now):
            if depth <= 0.0:
                self.onset[which] = None
            elif self.onset[which] is None:
                earlier, earlier_speed = self.before[1][which]
                # with a constant acceleration in between, speed^2 is linear in the distance
                share = earlier / (earlier - depth)
                square = earlier_speed**2 + share * (speed**2 - earlier_speed**2)
                self.onset[which] = max(math.sqrt(square), self.p.onset_velocity_floor)
        if q[6] >= self.p.x_lock:
            began, _, x, x_rate = self.before
            cubic = CubicHermiteSpline([began, t], [x, q[6]], [x_rate, v[6]])
            self.time = float(cubic.solve(self.p.x_lock, extrapolate=False)[0])
            return False
        self.before = (t, now, q[6], v[6])
        return True

    def deploy(self, h: float, t_max: float) -> float:
        """Deployment time (s) with steps of `h` (s), inf if `t_max` (s) comes first."""
        settings = exudyn.SimulationSettings()
        steps = settings.timeIntegration
        steps.numberOfSteps = math.ceil(t_max / h)
        steps.endTime = steps.numberOfSteps * h
        steps.adaptiveStep = False
        steps.newton.useModifiedNewton = True
        steps.verboseMode = 0
        with warnings.catch_warnings():
            # the setting has another name from exudyn 1.13 on
            warnings.simplefilter("ignore", DeprecationWarning)
            settings.solutionSettings.writeSolutionToFile = False
            solver = exudyn.DynamicSolverType.TrapezoidalIndex2
            self.system.SolveDynamic(settings, solverType=solver)
        return self.time
