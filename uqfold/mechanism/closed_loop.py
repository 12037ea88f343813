"""Equation of motion of the wing with ideal joints, which has one degree of freedom.

Without clearance the rod closes the loop: l_1 sin(theta_1) + c = l_2 sin(theta_2). The motion is
followed along that curve by the parameter u with d theta_1/du = l_2 cos(theta_2) and
d theta_2/du = l_1 cos(theta_1), which, unlike theta_1, passes smoothly through the pose in which
the rod stands upright and theta_1 turns round. With w = du/dt and m(u) the inertia that w meets,

    m dw/dt + 1/2 dm/du w^2 = Q(u, t),

Q being the work of drive (13), drag (14) and gravity (16) per u. The state is
(cos(theta_1), sin(theta_1), cos(theta_2), sin(theta_2), w), so that no kernel here has a branch or
calls a function, and many wings can advance in the lanes of vector instructions.
"""

from typing import NamedTuple

from uqfold.mechanism.compiled import inlined

Five = tuple[float, float, float, float, float]
"""A state, or its rates."""


class IdealWing(NamedTuple):
    """What the equation of motion needs, in SI units.

    J_A and J_2 are the moments of inertia of crank (about A) and rod, m_2 and m_3 the masses of rod
    and slider, D and G drags and weights along X as in `uqfold.mechanism.wing.WingConstants`.
    """

    l_1: float
    l_2: float
    J_A: float
    J_2: float
    m_2: float
    m_3: float
    D_1: float
    D_2: float
    G_1: float
    G_2: float
    G_3: float
    k_d: float


@inlined
def rates(wing: IdealWing, y: Five, t: float) -> Five:
    """Rates of the state `y` at time `t` (s)."""
    c_1, s_1, c_2, s_2, w = y
    p = wing.l_2 * c_2
    r = wing.l_1 * c_1
    # rates by u of x_1 (doubled), x_2, x_3 and y_2 (doubled), and how they change along u
    sink = wing.l_1 * s_1 * p
    rise = wing.l_2 * s_2 * r
    x_2 = 0.5 * rise - sink
    x_3 = rise - sink
    y_2 = p * r
    bend = wing.l_1 * wing.l_2 * s_1 * s_2
    sink_rate = y_2 * p - bend * r
    rise_rate = y_2 * r - bend * p
    inertia = (
        wing.J_A * p * p
        + wing.J_2 * r * r
        + wing.m_2 * (x_2 * x_2 + 0.25 * y_2 * y_2)
        + wing.m_3 * x_3 * x_3
    )
    growth = (
        wing.m_2 * (x_2 * (0.5 * rise_rate - sink_rate) - 0.25 * y_2 * (sink * p + rise * r))
        + wing.m_3 * x_3 * (rise_rate - sink_rate)
        - wing.J_A * p * rise
        - wing.J_2 * r * sink
    )
    # `drive_force` without a branch
    drive = wing.k_d * max(min(100.0 * t, 1.0, 62.0 - 100.0 * t), 0.0)
    load = (
        x_2 * (wing.D_2 * abs(s_2) + wing.G_2)
        - 0.5 * sink * (wing.D_1 * abs(s_1) + wing.G_1)
        + x_3 * (wing.G_3 + drive)
    )
    theta_1 = p * w
    theta_2 = r * w
    return (
        -s_1 * theta_1,
        c_1 * theta_1,
        -s_2 * theta_2,
        c_2 * theta_2,
        (load - growth * w * w) / inertia,
    )


@inlined
def _part(f: float, x: Five) -> Five:
    """Return f x."""
    return f * x[0], f * x[1], f * x[2], f * x[3], f * x[4]


@inlined
def _plus(x: Five, y: Five) -> Five:
    """Return x + y."""
    return x[0] + y[0], x[1] + y[1], x[2] + y[2], x[3] + y[3], x[4] + y[4]


@inlined
def step(
    wing: IdealWing, y: Five, k_1: Five, t: float, h: float, c: float
) -> tuple[Five, Five, float]:
    """One time step.

    By the formula of order 5(4) of J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980)
    19-26, led back to the closed loop.

    Parameters
    ----------
    wing, y, k_1 : tuples of floats
        The wing, the state and its rates at the start.
    t, h : float
        Time at the start, and length of the step (s).
    c : float
        Distance of the slider below the X axis (m).

    Returns
    -------
    tuple
        State and rates at the end, and the local error over 1 + |w|.
    """
    k_2 = rates(wing, _plus(y, _part(h / 5, k_1)), t + h / 5)
    x = _plus(_part(3 / 40, k_1), _part(9 / 40, k_2))
    k_3 = rates(wing, _plus(y, _part(h, x)), t + h * (3 / 10))
    x = _plus(_plus(_part(44 / 45, k_1), _part(-56 / 15, k_2)), _part(32 / 9, k_3))
    k_4 = rates(wing, _plus(y, _part(h, x)), t + h * (4 / 5))
    x = _plus(_part(19372 / 6561, k_1), _part(-25360 / 2187, k_2))
    x = _plus(_plus(x, _part(64448 / 6561, k_3)), _part(-212 / 729, k_4))
    k_5 = rates(wing, _plus(y, _part(h, x)), t + h * (8 / 9))
    x = _plus(_part(9017 / 3168, k_1), _part(-355 / 33, k_2))
    x = _plus(_plus(x, _part(46732 / 5247, k_3)), _part(49 / 176, k_4))
    x = _plus(x, _part(-5103 / 18656, k_5))
    k_6 = rates(wing, _plus(y, _part(h, x)), t + h)
    x = _plus(_part(35 / 384, k_1), _part(500 / 1113, k_3))
    x = _plus(_plus(x, _part(125 / 192, k_4)), _part(-2187 / 6784, k_5))
    end = _on_curve(wing, _plus(y, _part(h, _plus(x, _part(11 / 84, k_6)))), c)
    k_7 = rates(wing, end, t + h)
    x = _plus(_part(71 / 57600, k_1), _part(-71 / 16695, k_3))
    x = _plus(_plus(x, _part(71 / 1920, k_4)), _part(-17253 / 339200, k_5))
    x = _plus(_plus(x, _part(22 / 525, k_6)), _part(-1 / 40, k_7))
    error = abs(x[0]) + abs(x[1]) + abs(x[2]) + abs(x[3]) + abs(x[4])
    return end, k_7, h * error / (1.0 + abs(end[4]))


@inlined
def _on_curve(wing: IdealWing, y: Five, c: float) -> Five:
    """State moved, by the square of a small distance, back to unit circles and a closed loop."""
    l_1, l_2 = wing.l_1, wing.l_2
    c_1, s_1, c_2, s_2, w = y
    scale = 1.5 - 0.5 * (c_1 * c_1 + s_1 * s_1)
    c_1 *= scale
    s_1 *= scale
    scale = 1.5 - 0.5 * (c_2 * c_2 + s_2 * s_2)
    c_2 *= scale
    s_2 *= scale
    r = l_1 * c_1
    p = l_2 * c_2
    turn = (l_2 * s_2 - l_1 * s_1 - c) / (p * p + r * r)
    return (
        c_1 - s_1 * turn * r,
        s_1 + c_1 * turn * r,
        c_2 + s_2 * turn * p,
        s_2 - c_2 * turn * p,
        w,
    )


@inlined
def slider(wing: IdealWing, y: Five, w_rate: float) -> tuple[float, float, float]:
    """Position (m), velocity (m/s) and acceleration (m/s^2) of the slider.

    `w_rate` is the last of the `rates` of the state y.
    """
    l_1, l_2 = wing.l_1, wing.l_2
    c_1, s_1, c_2, s_2, w = y
    p = l_2 * c_2
    r = l_1 * c_1
    along = l_2 * s_2 * r - l_1 * s_1 * p
    change = p * r * (r - p) - l_1 * l_2 * s_1 * s_2 * (p - r)
    return r - p, along * w, along * w_rate + change * w * w
