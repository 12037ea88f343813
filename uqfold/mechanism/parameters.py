"""The record of one folding wing, checked as a whole."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

from uqfold.mechanism.parameter_checks import check_assembly, check_joints, check_scales
from uqfold.mechanism.parameter_list import (
    PARTS,
    ContactLaw,
    ParameterList,
    TangentialVelocity,
    checked,
    described,
)

__all__ = ["PARTS", "ContactLaw", "TangentialVelocity", "WingParameters", "spread"]


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
class WingParameters(ParameterList):
    """Geometry, masses, joints, loads and end of deployment of one folding wing.

    All values are in SI units, angles in radians. Crank (body 1) and rod (body 2) are joined at B,
    rod and slider (body 3) at C, by bearings with a clearance. The parameters are listed once, with
    values, units and bounds, in `uqfold.mechanism.parameter_list`.

    The record holds one value per wing and joint. The paper's common names stand for all of them:
    `C_r=0.001` sets `C_r_B` and `C_r_C`, and reads their value where they agree; `b` does so for
    `b_1` and `b_2`, and E_1, nu_1, E_2, nu_2 for the materials, see `PARTS`.

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

    def __init__(self, **values: Any) -> None:
        unknown = values.keys() - {field.name for field in fields(self)} - PARTS.keys()
        if unknown:
            raise TypeError(f"{', '.join(sorted(unknown))}: no such parameter of the wing")
        given = spread({name: checked(name, value) for name, value in values.items()})
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


if WingParameters.__doc__:
    section = f"    Parameters\n    ----------\n{described()}\n\n    Raises"
    WingParameters.__doc__ = WingParameters.__doc__.replace("    Raises", section, 1)
