"""Parameters of one folding wing, in SI units, with the values of Table 1 as defaults."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Literal, Self, get_args

from uqfold.mechanism.parameter_checks import check_assembly, check_joints, check_scales, checked

ContactLaw = Literal["lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier"]
TangentialVelocity = Literal["geometric", "material"]

_CHOICES = {
    "contact_law": get_args(ContactLaw),
    "tangential_velocity": get_args(TangentialVelocity),
}

PARTS = {
    "b": ("b_1", "b_2"),
    "C_r": ("C_r_B", "C_r_C"),
    "E_1": ("E_b_B", "E_j_B", "E_j_C"),
    "nu_1": ("nu_b_B", "nu_j_B", "nu_j_C"),
    "E_2": ("E_b_C",),
    "nu_2": ("nu_b_C",),
}
"""The paper's names for what several fields of the record have in common."""


def spread(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return `values` with each name in `PARTS` replaced by the fields that it stands for.

    Raises
    ------
    ValueError
        If a field is given both by its own name and by the common one.

    Examples
    --------
    >>> spread({"V_q": 120.0, "C_r": 0.001})
    {'V_q': 120.0, 'C_r_B': 0.001, 'C_r_C': 0.001}
    """
    result: dict[str, Any] = {}
    for name, value in values.items():
        for field in PARTS.get(name, (name,)):
            if field in result:
                common = next(key for key in values if field in PARTS.get(key, ()))
                raise ValueError(
                    f"{common} already sets {field}, which is given as well: leave out one of them"
                )
            result[field] = value
    return result


@dataclass(frozen=True, init=False, repr=False)
class WingParameters:
    """Geometry, masses, joints, loads and end of deployment of one folding wing.

    All values are in SI units, angles in radians. Body 1 is the crank (the main wing, pivoted at
    A, the origin), body 2 the connecting rod (the auxiliary wing), body 3 the slider. Joint B
    joins crank and rod, joint C rod and slider; both are bearings with a clearance. The crank (B)
    and the slider (C) carry the bearings, the rod carries both journals.

    The record holds one value per wing and joint. The paper's common names stand for all of them:
    `C_r=0.001` sets `C_r_B` and `C_r_C`, and reads their value where they agree; `b` does so for
    `b_1` and `b_2`, and E_1, nu_1, E_2, nu_2 for the materials, see `PARTS`.

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
    b_1, b_2 : float
        Thicknesses of crank and rod (m), Eqs. (14) and (19): V_i = l_i w_i b_i. Both: `b`.
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
    C_r_B, C_r_C : float
        Radial clearances of the joints B and C (m), Eq. (2). Both: `C_r`.
    R_b : float
        Radius of both bearings (m), Eq. (2); the journals have R_b - C_r_B and R_b - C_r_C.
    C_e : float
        Coefficient of restitution (1), Eq. (5), in (0, 1].
    E_b_B, nu_b_B, E_j_B, nu_j_B : float
        Young's modulus (Pa) and Poisson's ratio of bearing and journal of joint B, Eq. (6): crank
        and rod, both aluminium.
    E_b_C, nu_b_C, E_j_C, nu_j_C : float
        The same for joint C: the slider, of steel, and the rod. E_1 and nu_1 set all that belongs
        to crank and rod, E_2 and nu_2 what belongs to the slider.
    contact_law : {"lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier"}
        Hysteresis of the normal force: as printed in Eq. (5), or as another law relates it to the
        coefficient of restitution; see `uqfold.mechanism.contact.hysteresis_factor`.
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
        If a value is not a finite number or is physically impossible, or if the scales of the wing
        lie beyond the model or double precision (see `uqfold.mechanism.scales`); the message names
        the field, the value and the remedy. Also if a field is given by its own and by the common
        name.
    TypeError
        If a value has another type, or a name is neither a field nor one of the common names.

    Examples
    --------
    >>> wing = WingParameters(C_r=0.0015)
    >>> wing.R_j_B
    0.0085
    >>> wing.replace(C_r_C=0.002, contact_law="flores-2011")
    WingParameters(C_r_B=0.0015, C_r_C=0.002, contact_law='flores-2011')
    """

    l_1: float = 1.5
    w_1: float = 0.3
    rho_1: float = 2700.0
    l_2: float = 1.3
    w_2: float = 0.2
    rho_2: float = 2700.0
    V_3: float = 0.001
    rho_3: float = 7870.0
    b_1: float = 0.007
    b_2: float = 0.007
    c: float = 0.1
    k_d: float = 550.0
    V_q: float = 140.0
    delta: float = 0.0
    C_0: float = 1.0
    rho_a: float = 1.293
    g: float = 9.81
    C_r_B: float = 0.0025
    C_r_C: float = 0.0025
    R_b: float = 0.010
    C_e: float = 0.9
    E_b_B: float = 70e9
    nu_b_B: float = 0.33
    E_j_B: float = 70e9
    nu_j_B: float = 0.33
    E_b_C: float = 200e9
    nu_b_C: float = 0.3
    E_j_C: float = 70e9
    nu_j_C: float = 0.33
    contact_law: ContactLaw = "lankarani-nikravesh"
    C_f: float = 0.1
    friction_v_0: float = 0.001
    friction_v_1: float = 0.010
    onset_velocity_floor: float = 1e-3
    tangential_velocity: TangentialVelocity = "geometric"
    theta_1_initial: float = 0.0
    x_lock: float = 1.0
    t_max: float = 2.0

    def __init__(self, **values: Any) -> None:
        unknown = values.keys() - {field.name for field in fields(self)} - PARTS.keys()
        if unknown:
            raise TypeError(f"{', '.join(sorted(unknown))}: no such parameter of the wing")
        given = spread({name: checked(name, value, _CHOICES) for name, value in values.items()})
        for field in fields(self):
            object.__setattr__(self, field.name, given.get(field.name, field.default))
        check_joints(self)
        check_assembly(self)
        check_scales(self)

    def __repr__(self) -> str:
        """Show what differs from Table 1."""
        changed = {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if getattr(self, field.name) != field.default
        }
        for common, parts in PARTS.items():
            if all(part in changed for part in parts) and len({changed[p] for p in parts}) == 1:
                changed = {
                    common if name == parts[0] else name: value
                    for name, value in changed.items()
                    if name not in parts[1:]
                }
        shown = ", ".join(f"{name}={value!r}" for name, value in changed.items())
        return f"{type(self).__name__}({shown})"

    @property
    def b(self) -> float:
        """Thickness of crank and rod (m); ValueError where they differ."""
        return self._common("b")

    @property
    def C_r(self) -> float:
        """Clearance of both joints (m); ValueError where they differ."""
        return self._common("C_r")

    @property
    def E_1(self) -> float:
        """Young's modulus of crank and rod (Pa); ValueError where the joints' parts differ."""
        return self._common("E_1")

    @property
    def nu_1(self) -> float:
        """Poisson's ratio of crank and rod; ValueError where the joints' parts differ."""
        return self._common("nu_1")

    @property
    def E_2(self) -> float:
        """Young's modulus of the slider (Pa)."""
        return self.E_b_C

    @property
    def nu_2(self) -> float:
        """Poisson's ratio of the slider."""
        return self.nu_b_C

    @property
    def R_j_B(self) -> float:
        """Radius of the journal of joint B (m): R_b - C_r_B, from Eq. (2)."""
        return self.R_b - self.C_r_B

    @property
    def R_j_C(self) -> float:
        """Radius of the journal of joint C (m): R_b - C_r_C, from Eq. (2)."""
        return self.R_b - self.C_r_C

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
            If a name is neither a field nor a common name.
        """
        present = {field.name: getattr(self, field.name) for field in fields(self)}
        for name in changes:
            for part in PARTS.get(name, ()):
                present.pop(part)
        return type(self)(**present | changes)

    def _common(self, name: str) -> float:
        """Value of all the fields that `name` stands for."""
        values: dict[str, float] = {part: getattr(self, part) for part in PARTS[name]}
        if len(set(values.values())) > 1:
            raise ValueError(f"{name} has no one value here, {values}: ask for its parts")
        return next(iter(values.values()))
