"""The list of a wing's parameters: name, value of Table 1, unit, meaning, and what it may be.

Everything else takes the names from here: the checks, the docstring of `WingParameters`, the table
that the compiled code reads by field name (`uqfold.mechanism.wing`). Values are in SI units, angles
in radians. Body 1 is the crank (the main wing, pivoted at A, the origin), body 2 the connecting rod
(the auxiliary wing), body 3 the slider. Joint B joins crank and rod, joint C rod and slider; both
are bearings with a clearance. The crank (B) and the slider (C) carry the bearings, the rod carries
both journals.
"""

import math
from dataclasses import dataclass, field, fields
from typing import Any, Literal, NamedTuple, get_args

from uqfold.checks import choice, real

ContactLaw = Literal["lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier"]
TangentialVelocity = Literal["geometric", "material"]

LARGEST = 1e30
"""Largest value of any parameter in SI units, and what its inverse may be: far beyond any wing, and
products of a few neither overflow nor vanish."""

Bounds = Literal["positive", "not negative", "any sign", "Poisson's ratio"]


class Parameter(NamedTuple):
    """What is known of a parameter besides its name and its value in Table 1.

    `bounds` is None and `choices` is not empty where the value is one of a few words.
    """

    meaning: str
    unit: str
    bounds: Bounds | None
    choices: tuple[str, ...] = ()


def _number(default: float, unit: str, meaning: str, bounds: Bounds = "positive") -> Any:
    return field(default=default, metadata={"parameter": Parameter(meaning, unit, bounds)})


def _word(choices: tuple[str, ...], meaning: str) -> Any:
    parameter = Parameter(meaning, "", None, choices)
    return field(default=choices[0], metadata={"parameter": parameter})


@dataclass(frozen=True)
class ParameterList:
    """The parameters as fields, unchecked, and what follows from few of them alone."""

    l_1: float = _number(1.5, "m", "length of the crank, Eq. (10)")
    w_1: float = _number(0.3, "m", "width of the crank, Eq. (19)")
    rho_1: float = _number(2700.0, "kg/m^3", "density of the crank, Eq. (19)")
    l_2: float = _number(1.3, "m", "length of the rod, Eq. (10)")
    w_2: float = _number(0.2, "m", "width of the rod, Eq. (19)")
    rho_2: float = _number(2700.0, "kg/m^3", "density of the rod, Eq. (19)")
    V_3: float = _number(0.001, "m^3", "volume of the slider, Eq. (19)")
    rho_3: float = _number(7870.0, "kg/m^3", "density of the slider, Eq. (19)")
    b_1: float = _number(0.007, "m", "thickness of the crank, Eqs. (14) and (19)")
    b_2: float = _number(0.007, "m", "thickness of the rod, Eqs. (14) and (19)")
    c: float = _number(0.1, "m", "how far the slider lies below the X axis, Eq. (10)", "any sign")
    k_d: float = _number(550.0, "N", "peak of the driving force, Eq. (13)", "any sign")
    V_q: float = _number(140.0, "m/s", "flight speed, Eq. (14)", "not negative")
    delta: float = _number(0.0, "rad", "pitch angle, Eqs. (15) and (16)", "any sign")
    C_0: float = _number(1.0, "1", "drag coefficient, Eq. (14)", "not negative")
    rho_a: float = _number(1.293, "kg/m^3", "density of the air, Eq. (14)", "not negative")
    g: float = _number(9.81, "m/s^2", "acceleration of gravity, Eq. (15)")
    C_r_B: float = _number(0.0025, "m", "radial clearance of joint B, Eq. (2)")
    C_r_C: float = _number(0.0025, "m", "radial clearance of joint C, Eq. (2)")
    R_b: float = _number(
        0.010, "m", "radius of both bearings, Eq. (2); the journals have R_b - C_r_B, R_b - C_r_C"
    )
    C_e: float = _number(0.9, "1", "coefficient of restitution, Eq. (5), in (0, 1]")
    E_b_B: float = _number(70e9, "Pa", "Young's modulus of the bearing of B, the crank, Eq. (6)")
    nu_b_B: float = _number(0.33, "1", "Poisson's ratio of the bearing of B", "Poisson's ratio")
    E_j_B: float = _number(70e9, "Pa", "Young's modulus of the journal of B, the rod, Eq. (6)")
    nu_j_B: float = _number(0.33, "1", "Poisson's ratio of the journal of B", "Poisson's ratio")
    E_b_C: float = _number(200e9, "Pa", "Young's modulus of the bearing of C, the slider, Eq. (6)")
    nu_b_C: float = _number(0.3, "1", "Poisson's ratio of the bearing of C", "Poisson's ratio")
    E_j_C: float = _number(70e9, "Pa", "Young's modulus of the journal of C, the rod, Eq. (6)")
    nu_j_C: float = _number(0.33, "1", "Poisson's ratio of the journal of C", "Poisson's ratio")
    contact_law: ContactLaw = _word(  # noqa: RUF009
        get_args(ContactLaw),
        "hysteresis of the normal force: as printed in Eq. (5), or as another law relates it to "
        "C_e; see `uqfold.mechanism.contact.hysteresis_factor`",
    )
    C_f: float = _number(0.1, "1", "coefficient of friction in the joints, Eq. (7)", "not negative")
    friction_v_0: float = _number(
        0.001,
        "m/s",
        "start of Ambrosio's ramp: the correction c_d of Eq. (7) is 0 below, and rises from there",
        "not negative",
    )
    friction_v_1: float = _number(
        0.010, "m/s", "end of Ambrosio's ramp: c_d is 1 above, linear between", "not negative"
    )
    onset_velocity_floor: float = _number(
        1e-3, "m/s", "smallest penetration velocity at onset that Eq. (5) divides by"
    )
    tangential_velocity: TangentialVelocity = _word(  # noqa: RUF009
        get_args(TangentialVelocity),
        "sliding velocity of Eq. (7): that of the geometric contact point, as Eqs. (3) and (4) are "
        "printed, or that of the material points of journal and bearing at the contact",
    )
    theta_1_initial: float = _number(
        0.0,
        "rad",
        "crank angle at rest, before deployment; the slider starts on the side nearer to A",
        "any sign",
    )
    x_lock: float = _number(
        1.0, "m", "slider position of the lock, taken at the first upward crossing", "any sign"
    )
    t_max: float = _number(
        2.0, "s", "simulated time; a wing that has not locked by then has deployment time +inf"
    )

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


PARAMETERS: dict[str, Parameter] = {
    one.name: one.metadata["parameter"] for one in fields(ParameterList)
}
"""All parameters by name, in their order."""

PARTS = {
    "b": ("b_1", "b_2"),
    "C_r": ("C_r_B", "C_r_C"),
    "E_1": ("E_b_B", "E_j_B", "E_j_C"),
    "nu_1": ("nu_b_B", "nu_j_B", "nu_j_C"),
    "E_2": ("E_b_C",),
    "nu_2": ("nu_b_C",),
}
"""The paper's names for what several parameters have in common."""


def checked(name: str, value: Any) -> float | str:
    """Return the value as a float, or the word, if the parameter can have it.

    Parameters
    ----------
    name : str
        Name of a parameter, or a common one of `PARTS`.
    value : object
        What is given for it.

    Raises
    ------
    ValueError, TypeError
        If it cannot.
    """
    parameter = PARAMETERS[PARTS.get(name, (name,))[0]]
    what = "value in SI units"
    if parameter.bounds is None:
        return choice(name, value, parameter.choices)
    if parameter.bounds == "Poisson's ratio":
        return real(name, value, above=-1.0, at_most=0.5, what="Poisson's ratio")
    number = real(name, value, what=what)
    if parameter.bounds == "any sign":
        return real(name, number, at_least=-LARGEST, at_most=LARGEST, what=what)
    if parameter.bounds == "not negative":
        real(name, number, at_least=0.0, what=what)
    else:
        real(name, number, above=0.0, what=what)
        real(name, number, at_least=1.0 / LARGEST, what=what)
    return real(name, number, at_most=LARGEST, what=what)


def described() -> str:
    """Return all parameters as the section of a docstring."""
    entries = []
    for name, one in PARAMETERS.items():
        kind = f"{{{', '.join(map(repr, one.choices))}}}" if one.choices else "float"
        unit = f" ({one.unit})" if one.unit else ""
        entries.append(
            f"    {name} : {kind}\n        {one.meaning[0].upper()}{one.meaning[1:]}{unit}."
        )
    return "\n".join(entries)
