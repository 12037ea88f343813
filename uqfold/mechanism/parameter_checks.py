"""Which values fit together: a refusal that names the field, the value and the remedy."""

import math

from uqfold.mechanism.parameter_list import ParameterList
from uqfold.mechanism.scales import (
    LEAST_CLEARANCE,
    LONGEST_ARMS,
    LONGEST_TIME,
    MOST_VIBRATIONS,
    hertz_stiffness,
    scales_of,
)


def check_joints(wing: ParameterList) -> None:
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


def check_assembly(wing: ParameterList) -> None:
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


def check_scales(wing: ParameterList) -> None:
    """Raise ValueError where a wing is outside the model, or too extreme to be resolved.

    Every bound lies orders of magnitude beyond the wings of the paper; see `scales`.
    """
    if wing.C_e < 1e-3:
        raise ValueError(
            f"C_e = {wing.C_e}: impacts that return less than a thousandth of their speed are "
            "plastic, which none of the contact laws describes; give at least 0.001"
        )
    if wing.C_f > 10:
        raise ValueError(f"C_f = {wing.C_f} is beyond any dry joint: give at most 10")
    if wing.onset_velocity_floor < 1e-9:
        raise ValueError(
            f"onset_velocity_floor = {wing.onset_velocity_floor} m/s is below what an onset can "
            "be resolved to: give at least 1e-9 m/s"
        )
    if not wing.friction_v_1 - wing.friction_v_0 >= 1e-9:
        raise ValueError(
            f"the friction ramp from friction_v_0 = {wing.friction_v_0} to friction_v_1 = "
            f"{wing.friction_v_1} m/s is a jump: let it rise over at least 1e-9 m/s"
        )
    if abs(wing.theta_1_initial) > 2 * math.pi:
        raise ValueError(
            f"theta_1_initial = {wing.theta_1_initial} rad is more than a whole turn: give the "
            "angle within -2 pi and 2 pi"
        )
    arms = wing.l_1 + wing.l_2
    if arms > LONGEST_ARMS:
        raise ValueError(
            f"l_1 + l_2 = {arms:.6g} m is too long for events to be located to 1e-13 m: give arms "
            f"of at most {LONGEST_ARMS:g} m together"
        )
    clearance = min(wing.C_r_B, wing.C_r_C)
    if clearance < LEAST_CLEARANCE * arms:
        raise ValueError(
            f"C_r = {clearance} m cannot be resolved beside arms of {arms:.6g} m: give at least "
            f"{LEAST_CLEARANCE * arms:.3g} m, or take the model with ideal joints"
        )
    if wing.t_max > LONGEST_TIME:
        raise ValueError(
            f"t_max = {wing.t_max} s is too long for time steps to be resolved; the drive ends at "
            f"0.62 s: give at most {LONGEST_TIME:g} s"
        )
    K_B = hertz_stiffness(wing.R_b, wing.R_j_B, wing.E_b_B, wing.nu_b_B, wing.E_j_B, wing.nu_j_B)
    K_C = hertz_stiffness(wing.R_b, wing.R_j_C, wing.E_b_C, wing.nu_b_C, wing.E_j_C, wing.nu_j_C)
    scale = scales_of(wing, K_B, K_C)
    # written so that NaN, from infinity times zero, is refused
    if not scale.load <= scale.capacity:
        raise ValueError(
            f"loads of up to {scale.load:.3g} N would press a journal through its bearing, which "
            f"bears {scale.capacity:.3g} N at a depth of R_b = {wing.R_b} m: reduce k_d, V_q or "
            "the masses, or give a larger R_b, a smaller clearance or stiffer materials"
        )
    if not scale.frequency * wing.t_max <= MOST_VIBRATIONS:
        raise ValueError(
            f"contact may vibrate at {scale.frequency:.3g} rad/s, too fast to be resolved within "
            f"t_max = {wing.t_max} s: give heavier bodies, softer materials, or a t_max of at "
            f"most {MOST_VIBRATIONS / scale.frequency:.3g} s"
        )
