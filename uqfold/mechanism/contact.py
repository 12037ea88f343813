"""Contact of journal and bearing in a joint with clearance, Eqs. (5) to (7).

The normal force is K Delta^1.5 (1 + h rate / onset rate) under every contact law; the laws differ
in the hysteresis factor h that stands for a coefficient of restitution.
"""

import math

from uqfold.mechanism import scales
from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.parameters import ContactLaw


def hysteresis_factor(law: ContactLaw, C_e: float) -> float:
    """Hysteresis factor h of a contact law (1).

    An impact at onset rate v returns at e v, where h (1 + e) = ln((1 + h) / (1 - h e)), with any
    mass and stiffness. No law returns C_e exactly. In their order below they give e = 0.913, 0.909,
    0.894 and 0.876 for C_e = 0.9, but 0.725, 0.663, 0.470 and 0.488 for C_e = 0.5: the first two
    are meant for impacts that lose little.

    Parameters
    ----------
    law : {"lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier"}
        As printed in Eq. (5), after H. M. Lankarani and P. E. Nikravesh, J. Mech. Des. 112 (1990)
        369-376; K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440-445; P. Flores,
        M. Machado, M. T. Silva and J. M. Martins, Multibody Syst. Dyn. 25 (2011) 357-375;
        Y. Gonthier, J. McPhee, C. Lange and J.-C. Piedboeuf, Multibody Syst. Dyn. 11 (2004)
        209-233.
    C_e : float
        Coefficient of restitution (1), in (0, 1].

    Returns
    -------
    float
        h, 0 for C_e = 1.
    """
    if law == "lankarani-nikravesh":
        return 0.75 * (1.0 - C_e * C_e)
    if law == "hunt-crossley":
        return 1.5 * (1.0 - C_e)
    if law == "flores-2011":
        return 1.6 * (1.0 - C_e) / C_e
    return (1.0 - C_e * C_e) / C_e


hertz_stiffness = kernel(scales.hertz_stiffness)


@inlined
def contact_forces(
    penetration: float,
    rate: float,
    sliding: float,
    stiffness: float,
    damping: float,
    C_f: float,
    v_0: float,
    ramp_slope: float,
) -> tuple[float, float]:
    """Normal and tangential contact force on the bearing, Eqs. (5) and (7).

    Parameters
    ----------
    penetration, rate : float
        Depth of penetration (m), at least 0, and its rate (m/s).
    sliding : float
        Tangential velocity of the journal relative to the bearing (m/s).
    stiffness : float
        K of Eq. (6) (N/m^1.5).
    damping : float
        Hysteresis factor over the penetration velocity at onset (s/m).
    C_f, v_0, ramp_slope : float
        Coefficient of friction (1), sliding velocity at which friction sets in (m/s), and growth
        of its correction c_d per sliding velocity beyond that (s/m).

    Returns
    -------
    tuple of two floats
        Force along the normal n (N), never negative, and along the tangent t (N). The journal
        drags the bearing along, so friction takes energy out: this is the sign opposite to the
        printed one, which would feed energy in. The correction c_d, which rises from 0 at v_0 to 1,
        is that of J. A. C. Ambrosio, in: Virtual Nonlinear Multibody Systems (2003) 57-81; in full
        in P. Flores, J. Ambrosio, J. C. P. Claro and H. M. Lankarani, Proc. IMechE K, J. Multi-body
        Dyn. 220 (2006) 21-34.
    """
    normal = stiffness * penetration * math.sqrt(penetration) * (1.0 + damping * rate)
    normal = max(normal, 0.0)
    ramp = min(max((abs(sliding) - v_0) * ramp_slope, 0.0), 1.0)
    return normal, math.copysign(C_f * ramp * normal, sliding)
