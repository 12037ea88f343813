"""Parameters of one folding wing, in SI units, with the values of Table 1 as defaults."""

import math
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, Self, get_args

TangentialVelocity = Literal["geometric", "material"]

_POSITIVE = [
    "l_1",
    "w_1",
    "rho_1",
    "l_2",
    "w_2",
    "rho_2",
    "V_3",
    "rho_3",
    "b",
    "C_r",
    "R_b",
    "C_e",
    "E_1",
    "E_2",
    "g",
    "t_max",
    "onset_velocity_floor",
]
_NOT_NEGATIVE = ["V_q", "C_0", "rho_a", "C_f", "friction_v_0", "friction_v_1"]
_POISSON = ("nu_1", "nu_2")


@dataclass(frozen=True, slots=True, kw_only=True)
class WingParameters:
    """Geometry, masses, joints, loads and end of deployment of one folding wing.

    All values are in SI units, angles in radians. Body 1 is the crank (the main wing, pivoted at
    A, the origin), body 2 the connecting rod (the auxiliary wing), body 3 the slider. Joint B
    joins crank and rod, joint C rod and slider; both are bearings with a clearance. The crank (B)
    and the slider (C) carry the bearings, the rod carries both journals.

    Parameters
    ----------
    l_1, l_2 : float
        Lengths of crank and rod (m), Eq. (10).
    w_1, w_2 : float
        Widths of crank and rod (m), Eq. (19).
    rho_1, rho_2, rho_3 : float
        Densities of crank, rod and slider (kg/m^3), Eq. (19).
    V_3 : float
        Volume of the slider (m^3), Eq. (19).
    b : float
        Thickness of crank and rod (m), Eqs. (14) and (19): V_i = l_i w_i b.
    c : float
        Distance of the slider below the X axis (m), Eq. (10): y_3 = -c.
    k_d : float
        Peak of the driving force (N), Eq. (13).
    V_q : float
        Flight speed (m/s), Eq. (14).
    delta : float
        Pitch angle (rad), Eqs. (15) and (16).
    C_0 : float
        Drag coefficient (1), Eq. (14).
    rho_a : float
        Density of the air (kg/m^3), Eq. (14).
    g : float
        Acceleration of gravity (m/s^2), Eq. (15).
    C_r : float
        Radial clearance of both joints (m), Eq. (2).
    R_b : float
        Radius of both bearings (m), Eq. (2); the journals have R_b - C_r.
    C_e : float
        Coefficient of restitution (1), Eq. (5), in (0, 1].
    E_1, nu_1 : float
        Young's modulus (Pa) and Poisson's ratio of crank and rod (aluminium), Eq. (6).
    E_2, nu_2 : float
        Young's modulus (Pa) and Poisson's ratio of the slider (steel), Eq. (6).
    C_f : float
        Coefficient of friction in the joints (1), Eq. (7).
    friction_v_0, friction_v_1 : float
        Ends of Ambrosio's ramp (m/s): the correction c_d of Eq. (7) is 0 below the first, 1 above
        the second, and linear between them.
    onset_velocity_floor : float
        Smallest penetration velocity at onset that Eq. (5) divides by (m/s).
    tangential_velocity : {"geometric", "material"}
        Sliding velocity used by Eq. (7): that of the geometric contact point, as Eqs. (3) and (4)
        are printed, or that of the material points of journal and bearing at the contact.
    theta_1_initial : float
        Crank angle at rest, before deployment (rad); the slider starts on the side nearer to A.
    x_lock : float
        Slider position at which the wing locks (m), taken at the first upward crossing.
    t_max : float
        Simulated time (s); a wing that has not locked by then has deployment time +inf.

    Raises
    ------
    ValueError
        If a value is not a finite number or is physically impossible; the message names the field,
        the value and the remedy.

    Examples
    --------
    >>> WingParameters().replace(C_r=0.0015).R_j
    0.0085
    """

    l_1: float = 1.5
    w_1: float = 0.3
    rho_1: float = 2700.0
    l_2: float = 1.3
    w_2: float = 0.2
    rho_2: float = 2700.0
    V_3: float = 0.001
    rho_3: float = 7870.0
    b: float = 0.007
    c: float = 0.1
    k_d: float = 550.0
    V_q: float = 140.0
    delta: float = 0.0
    C_0: float = 1.0
    rho_a: float = 1.293
    g: float = 9.81
    C_r: float = 0.0025
    R_b: float = 0.010
    C_e: float = 0.9
    E_1: float = 70e9
    nu_1: float = 0.33
    E_2: float = 200e9
    nu_2: float = 0.3
    C_f: float = 0.1
    friction_v_0: float = 0.001
    friction_v_1: float = 0.010
    onset_velocity_floor: float = 1e-3
    tangential_velocity: TangentialVelocity = "geometric"
    theta_1_initial: float = 0.0
    x_lock: float = 1.0
    t_max: float = 2.0

    def __post_init__(self) -> None:
        """Refuse values with which there is no wing to simulate."""
        self._check_numbers()
        self._check_joints()
        self._check_assembly()

    @property
    def R_j(self) -> float:
        """Radius of both journals (m): R_b - C_r, from Eq. (2)."""
        return self.R_b - self.C_r

    @property
    def x_3_initial(self) -> float:
        """Slider position before deployment (m), with both journals centred."""
        rise = self.l_1 * math.sin(self.theta_1_initial) + self.c
        return self.l_1 * math.cos(self.theta_1_initial) - math.sqrt(self.l_2**2 - rise**2)

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some fields changed, validated anew.

        Raises
        ------
        ValueError
            If a new value is impossible.
        TypeError
            If a name is not a field.
        """
        return replace(self, **changes)

    def _check_numbers(self) -> None:
        if self.tangential_velocity not in get_args(TangentialVelocity):
            raise ValueError(
                f"tangential_velocity = {self.tangential_velocity!r} is unknown: "
                f"choose one of {', '.join(get_args(TangentialVelocity))}"
            )
        for field in fields(self):
            if field.name == "tangential_velocity":
                continue
            value = getattr(self, field.name)
            try:
                number = float(value)
            except (TypeError, ValueError):
                raise ValueError(
                    f"{field.name} = {value!r} is not a number: give one value in SI units"
                ) from None
            if not math.isfinite(number):
                raise ValueError(f"{field.name} = {value} is not finite: give a finite value")
            object.__setattr__(self, field.name, number)
        for name in _POSITIVE:
            if getattr(self, name) <= 0:
                raise ValueError(
                    f"{name} = {getattr(self, name)} is not positive: give a value above 0"
                )
        for name in _NOT_NEGATIVE:
            if getattr(self, name) < 0:
                raise ValueError(
                    f"{name} = {getattr(self, name)} is negative: give 0 or a positive value"
                )
        for name in _POISSON:
            if not -1 < getattr(self, name) <= 0.5:
                raise ValueError(
                    f"{name} = {getattr(self, name)} is no Poisson's ratio: "
                    "give a value above -1 and up to 0.5"
                )

    def _check_joints(self) -> None:
        if self.C_r >= self.R_b:
            raise ValueError(
                f"C_r = {self.C_r} m leaves no journal in a bearing of radius R_b = {self.R_b} m: "
                "give a clearance below R_b"
            )
        if self.C_e > 1:
            raise ValueError(
                f"C_e = {self.C_e} would create energy at every impact: give a value in (0, 1]"
            )
        if self.friction_v_1 <= self.friction_v_0:
            raise ValueError(
                f"friction_v_1 = {self.friction_v_1} m/s does not lie above friction_v_0 = "
                f"{self.friction_v_0} m/s: the friction ramp needs friction_v_0 < friction_v_1"
            )

    def _check_assembly(self) -> None:
        rise = self.l_1 * math.sin(self.theta_1_initial) + self.c
        if abs(rise) >= self.l_2:
            raise ValueError(
                f"l_2 = {self.l_2} m is too short to assemble: the rod has to span a height of "
                f"{abs(rise):.6g} m at theta_1_initial = {self.theta_1_initial} rad; lengthen "
                "l_2, or reduce l_1, c or theta_1_initial"
            )
        if self.x_lock <= self.x_3_initial:
            raise ValueError(
                f"x_lock = {self.x_lock} m is not ahead of the slider, which starts at "
                f"{self.x_3_initial:.6g} m: give a larger x_lock"
            )
        reach = math.hypot(self.x_lock, self.c)
        if not abs(self.l_1 - self.l_2) <= reach <= self.l_1 + self.l_2:
            raise ValueError(
                f"x_lock = {self.x_lock} m is unreachable: joint C would be {reach:.6g} m from A, "
                f"but the arms allow {abs(self.l_1 - self.l_2):.6g} to {self.l_1 + self.l_2:.6g} m;"
                " choose x_lock within reach"
            )
