"""What values a wing can have: a refusal that names the field, the value and the remedy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from uqfold.mechanism.parameters import WingParameters

_NOT_NEGATIVE = {"V_q", "C_0", "rho_a", "C_f", "friction_v_0", "friction_v_1"}
_ANY_SIGN = {"c", "k_d", "delta", "theta_1_initial", "x_lock"}


def checked(name: str, value: Any, choices: Mapping[str, tuple[str, ...]]) -> float | str:
    """Return the value as a float, or the choice, if the parameter can have it.

    Raises
    ------
    ValueError
        If it cannot.
    """
    if name in choices:
        if value not in choices[name]:
            raise ValueError(
                f"{name} = {value!r} is unknown: choose one of {', '.join(choices[name])}"
            )
        return str(value)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(
            f"{name} = {value!r} is not a number: give one value in SI units"
        ) from None
    if not math.isfinite(number):
        raise ValueError(f"{name} = {value} is not finite: give a finite value")
    if name.startswith("nu_"):
        if not -1 < number <= 0.5:
            raise ValueError(
                f"{name} = {value} is no Poisson's ratio: give a value above -1 and up to 0.5"
            )
    elif name in _NOT_NEGATIVE:
        if number < 0:
            raise ValueError(f"{name} = {value} is negative: give 0 or a positive value")
    elif name not in _ANY_SIGN and number <= 0:
        raise ValueError(f"{name} = {value} is not positive: give a value above 0")
    return number


def check_joints(wing: WingParameters) -> None:
    """Raise ValueError unless journals fit their bearings and joints lose energy."""
    for name in ("C_r_B", "C_r_C"):
        if getattr(wing, name) >= wing.R_b:
            shown = "C_r" if wing.C_r_B == wing.C_r_C else name
            raise ValueError(
                f"{shown} = {getattr(wing, name)} m leaves no journal in a bearing of radius "
                f"R_b = {wing.R_b} m: give a clearance below R_b"
            )
    if wing.C_e > 1:
        raise ValueError(
            f"C_e = {wing.C_e} would create energy at every impact: give a value in (0, 1]"
        )
    if wing.friction_v_1 <= wing.friction_v_0:
        raise ValueError(
            f"friction_v_1 = {wing.friction_v_1} m/s does not lie above friction_v_0 = "
            f"{wing.friction_v_0} m/s: the friction ramp needs friction_v_0 < friction_v_1"
        )


def check_assembly(wing: WingParameters) -> None:
    """Raise ValueError unless the wing can be put together and reach its lock from the start."""
    rise = wing.l_1 * math.sin(wing.theta_1_initial) + wing.c
    if abs(rise) >= wing.l_2:
        raise ValueError(
            f"l_2 = {wing.l_2} m is too short to assemble: the rod has to span a height of "
            f"{abs(rise):.6g} m at theta_1_initial = {wing.theta_1_initial} rad; lengthen "
            "l_2, or reduce l_1, c or theta_1_initial"
        )
    if wing.x_lock <= wing.x_3_initial:
        raise ValueError(
            f"x_lock = {wing.x_lock} m is not ahead of the slider, which starts at "
            f"{wing.x_3_initial:.6g} m: give a larger x_lock"
        )
    reach = math.hypot(wing.x_lock, wing.c)
    if not abs(wing.l_1 - wing.l_2) <= reach <= wing.l_1 + wing.l_2:
        raise ValueError(
            f"x_lock = {wing.x_lock} m is unreachable: joint C would be {reach:.6g} m from A, "
            f"but the arms allow {abs(wing.l_1 - wing.l_2):.6g} to {wing.l_1 + wing.l_2:.6g} m;"
            " choose x_lock within reach"
        )
