"""The folding wing built from the objects of exudyn, a general multibody code.

Three planar rigid bodies with three coordinates each, a revolute joint at A, a prismatic joint for
the slider, gravity as a load; the contacts in B and C, drag and drive are a user force on all nine
coordinates. Exudyn brings equations of motion, constraints and time integration.

Exudyn's steps are not cut at events. The onset velocity of a contact is interpolated between the
steps before and after the onset, the lock on the cubic through the ends of its step.
"""

from __future__ import annotations

import math
import warnings
from typing import Any, NamedTuple

import exudyn
from exudyn import itemInterface

from uqfold.mechanism import WingParameters

Point = tuple[float, float]


class Joint(NamedTuple):
    """A joint with clearance as it stands."""

    e: Point
    """Eccentricity, journal minus bearing (m)."""
    e_rate: Point
    bearing_turn: float
    """Angular velocity of the bearing's body (rad/s)."""
    to_bearing: Point
    """From the centroid of the bearing's body to the bearing's centre (m)."""
    to_journal: Point

    @property
    def penetration(self) -> float:
        """Distance of the centres (m); the clearance is to be taken off."""
        return math.hypot(*self.e)


class ExudynWing:
    """One wing as a system of exudyn."""

    def __init__(self, p: WingParameters) -> None:
        self.p = p
        self.onset: list[float | None] = [None, None]
        self.before: tuple[float, list[Point], float, float] = (0.0, [], 0.0, 0.0)
        self.time = math.inf
        root = math.sqrt(p.R_b * (p.R_b - p.C_r) / (2.0 * p.R_b - p.C_r))
        h_1, h_2 = (1.0 - p.nu_1**2) / p.E_1, (1.0 - p.nu_2**2) / p.E_2
        self.K = (4.0 / (3.0 * (h_1 + h_1)) * root, 4.0 / (3.0 * (h_1 + h_2)) * root)
        self.drag = [0.5 * p.rho_a * p.C_0 * p.b * length * p.V_q**2 for length in (p.l_1, p.l_2)]
        self.reference = self._pose()
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self._build()

    def _pose(self) -> list[float]:
        """Coordinates before deployment: x, y, angle of crank, rod and slider."""
        p, theta = self.p, self.p.theta_1_initial
        B = (p.l_1 * math.cos(theta), p.l_1 * math.sin(theta))
        rise = B[1] + p.c
        run = math.sqrt(p.l_2**2 - rise**2)
        rod = [B[0] - 0.5 * run, B[1] - 0.5 * rise, math.atan2(rise, run)]
        return [0.5 * B[0], 0.5 * B[1], theta, *rod, B[0] - run, -p.c, 0.0]

    def _build(self) -> None:
        p, system = self.p, self.system
        masses = (p.rho_1 * p.l_1 * p.w_1 * p.b, p.rho_2 * p.l_2 * p.w_2 * p.b, p.rho_3 * p.V_3)
        sides = ((p.l_1, p.w_1), (p.l_2, p.w_2), (1.0, 1.0))  # the slider does not turn
        ground = system.AddObject(itemInterface.ObjectGround())
        nodes, bodies = [], []
        for i, (mass, side) in enumerate(zip(masses, sides, strict=True)):
            pose = self.reference[3 * i : 3 * i + 3]
            nodes.append(system.AddNode(itemInterface.NodeRigidBody2D(referenceCoordinates=pose)))
            inertia = mass * (side[0] ** 2 + side[1] ** 2) / 12.0
            body = itemInterface.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=nodes[-1])
            bodies.append(system.AddObject(body))
            centre = system.AddMarker(itemInterface.MarkerBodyMass(bodyNumber=bodies[-1]))
            weight = [p.g * math.sin(p.delta), 0.0, 0.0]
            system.AddLoad(
                itemInterface.LoadMassProportional(markerNumber=centre, loadVector=weight)
            )
        A = [
            system.AddMarker(
                itemInterface.MarkerBodyPosition(bodyNumber=body, localPosition=[x, 0.0, 0.0])
            )
            for body, x in ((ground, 0.0), (bodies[0], -0.5 * p.l_1))
        ]
        system.AddObject(itemInterface.ObjectJointRevolute2D(markerNumbers=A))
        guide = [
            system.AddMarker(
                itemInterface.MarkerBodyRigid(bodyNumber=body, localPosition=[0.0, y, 0.0])
            )
            for body, y in ((ground, -p.c), (bodies[2], 0.0))
        ]
        system.AddObject(
            itemInterface.ObjectJointPrismatic2D(
                markerNumbers=guide, axisMarker0=[1.0, 0.0, 0.0], normalMarker1=[0.0, 1.0, 0.0]
            )
        )
        force = itemInterface.ObjectGenericODE2(nodeNumbers=nodes, forceUserFunction=self._force)
        system.AddObject(force)
        system.SetPreStepUserFunction(self._before_step)
        system.Assemble()

    def _joints(self, q: list[float], v: list[float]) -> tuple[Joint, Joint]:
        l_1, l_2 = 0.5 * self.p.l_1, 0.5 * self.p.l_2
        crank = (l_1 * math.cos(q[2]), l_1 * math.sin(q[2]))
        rod = (l_2 * math.cos(q[5]), l_2 * math.sin(q[5]))
        B = Joint(
            (q[3] + rod[0] - q[0] - crank[0], q[4] + rod[1] - q[1] - crank[1]),
            (
                v[3] - rod[1] * v[5] - v[0] + crank[1] * v[2],
                v[4] + rod[0] * v[5] - v[1] - crank[0] * v[2],
            ),
            v[2],
            crank,
            rod,
        )
        C = Joint(
            (q[3] - rod[0] - q[6], q[4] - rod[1] - q[7]),
            (v[3] + rod[1] * v[5] - v[6], v[4] - rod[0] * v[5] - v[7]),
            v[8],
            (0.0, 0.0),
            (-rod[0], -rod[1]),
        )
        return B, C

    def _force(self, _: Any, t: float, __: int, change: Any, v: Any) -> list[float]:
        """Generalised forces of drag, drive and contacts."""
        p = self.p
        q = [a + b for a, b in zip(self.reference, change, strict=True)]
        F = [0.0] * 9
        F[0] = self.drag[0] * abs(math.sin(q[2]))
        F[3] = self.drag[1] * abs(math.sin(q[5]))
        F[6] = p.k_d * max(0.0, min(100.0 * t, 1.0, 62.0 - 100.0 * t))
        for which, joint in enumerate(self._joints(q, v)):
            distance = joint.penetration
            depth = distance - p.C_r
            if depth <= 0.0:
                continue
            n_x, n_y = joint.e[0] / distance, joint.e[1] / distance
            rate = joint.e_rate[0] * n_x + joint.e_rate[1] * n_y
            across = joint.e_rate[1] * n_x - joint.e_rate[0] * n_y
            R_j = p.R_b - p.C_r
            if p.tangential_velocity == "geometric":
                slip = across - p.C_r * across / distance
            else:
                slip = across + R_j * v[5] - p.R_b * joint.bearing_turn
            # within the step of the onset the velocity is still that of the onset
            onset = self.onset[which] or max(rate, p.onset_velocity_floor)
            hysteresis = 1.0 + 0.75 * (1.0 - p.C_e**2) * rate / onset
            normal = max(0.0, self.K[which] * depth * math.sqrt(depth) * hysteresis)
            ramp = (abs(slip) - p.friction_v_0) / (p.friction_v_1 - p.friction_v_0)
            tangential = math.copysign(p.C_f * min(max(ramp, 0.0), 1.0) * normal, slip)
            x, y = normal * n_x - tangential * n_y, normal * n_y + tangential * n_x
            arm = (joint.to_bearing[0] + p.R_b * n_x, joint.to_bearing[1] + p.R_b * n_y)
            first = (0, 6)[which]
            F[first] += x
            F[first + 1] += y
            F[first + 2] += arm[0] * y - arm[1] * x
            arm = (joint.to_journal[0] + R_j * n_x, joint.to_journal[1] + R_j * n_y)
            F[3] -= x
            F[4] -= y
            F[5] -= arm[0] * y - arm[1] * x
        return F

    def _before_step(self, system: Any, _: float) -> bool:
        """Keep the onset velocities and watch the lock; False ends the simulation."""
        data = system.systemData
        # the clock already stands at the end of the step
        start = exudyn.ConfigurationType.StartOfStep
        t = data.GetTime(start)
        change, v = data.GetODE2Coordinates(start), list(data.GetODE2Coordinates_t(start))
        q = [a + b for a, b in zip(self.reference, change, strict=True)]
        now: list[Point] = []
        for which, joint in enumerate(self._joints(q, v)):
            distance = joint.penetration
            rate = joint.e[0] * joint.e_rate[0] + joint.e[1] * joint.e_rate[1]
            now.append((distance - self.p.C_r, rate / max(distance, 1e-99)))
            depth, speed = now[which]
            if depth <= 0.0:
                self.onset[which] = None
            elif self.onset[which] is None:
                earlier, earlier_speed = self.before[1][which]
                # with a constant acceleration in between, speed^2 is linear in the distance
                share = earlier / (earlier - depth)
                square = earlier_speed**2 + share * (speed**2 - earlier_speed**2)
                self.onset[which] = max(math.sqrt(square), self.p.onset_velocity_floor)
        if q[6] >= self.p.x_lock:
            self.time = self._lock_time(t, q[6], v[6])
            return False
        self.before = (t, now, q[6], v[6])
        return True

    def _lock_time(self, t: float, x: float, speed: float) -> float:
        """Time at which the cubic through both ends of the step reaches the lock."""
        start, _, x_0, speed_0 = self.before
        h = t - start
        low, high = 0.0, 1.0
        for _ in range(60):
            s = 0.5 * (low + high)
            ends = (1 + 2 * s) * (1 - s) ** 2 * x_0 + s * s * (3 - 2 * s) * x
            slopes = s * (1 - s) ** 2 * speed_0 - s * s * (1 - s) * speed
            if ends + h * slopes < self.p.x_lock:
                low = s
            else:
                high = s
        return start + high * h

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
