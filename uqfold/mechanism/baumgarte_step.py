"""One step of the paper's own form, and the first event within it.

The formula is that of J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26, of
order 5(4). No interpolation enters: a step that passes an event is repeated with other lengths
until it ends just beyond.
"""

import numpy as np

from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.multibody import FloatArray, Joint, Multibody, penetration, rates

# An error of a velocity counts as one of a position over this time (s).
_VELOCITY_TIME = 1e-3
# An event is passed by less than this (m).
_PASSED = 1e-13

_A = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_C = _A.sum(axis=1)
_ERROR = np.append(_A[6], 0) - [
    5179 / 57600,
    0,
    7571 / 16695,
    393 / 640,
    -92097 / 339200,
    187 / 2100,
    1 / 40,
]


@kernel
def dormand_prince_step(
    b: Multibody,
    alpha: float,
    beta: float,
    t: float,
    y: FloatArray,
    first: FloatArray,
    h: float,
    onset: FloatArray,
) -> tuple[FloatArray, float]:
    """State after one step of length `h`, and its local error; `first` are the rates at `y`."""
    stages = np.empty((18, 7))
    end = np.empty(18)
    for k in range(18):
        stages[k, 0] = first[k]
    for i in range(1, 7):
        for k in range(18):
            total = 0.0
            for j in range(i):
                total += _A[i, j] * stages[k, j]
            end[k] = y[k] + h * total
        stage = rates(b, alpha, beta, t + _C[i] * h, end, onset)[0]
        for k in range(18):
            stages[k, i] = stage[k]
    error = 0.0
    for k in range(18):
        part = 0.0
        for i in range(7):
            part += _ERROR[i] * stages[k, i]
        part = abs(h * part) * (1.0 if k < 9 else _VELOCITY_TIME)
        # written so that NaN is kept
        error = error if error >= part else part
    return end, error


@kernel
def how_far_beyond(b: Multibody, y: FloatArray, onset: FloatArray) -> tuple[float, float, float]:
    """How far (m) each switch of B and C and the lock lie behind, negative while ahead."""
    gap_B = penetration(b.joint_B, y[:9], y[9:])[0]
    gap_C = penetration(b.joint_C, y[:9], y[9:])[0]
    return (
        -gap_B if onset[0] > 0.0 else gap_B,
        -gap_C if onset[1] > 0.0 else gap_C,
        y[6] - b.x_lock,
    )


@kernel
def turning_fraction(
    joint: Joint, start: FloatArray, end: FloatArray, onset: float, h: float
) -> float:
    """Fraction of a step at which a switch is passed that is undone at its end; 1 if none is."""
    sign = -1.0 if onset > 0.0 else 1.0
    gap, rate = penetration(joint, start[:9], start[9:])
    rate_end = penetration(joint, end[:9], end[9:])[1]
    if not sign * rate > 0.0 > sign * rate_end:
        return 1.0
    s = rate / (rate - rate_end)
    return s if sign * (gap + 0.5 * s * h * rate) > 0.0 else 1.0


@kernel
def switched_onset(b: Multibody, joint: Joint, y: FloatArray, onset: float) -> float:
    """Onset velocity after a contact has begun, 0 after it has ended."""
    if onset > 0.0:
        return 0.0
    return max(penetration(joint, y[:9], y[9:])[1], b.onset_floor)


@kernel
def step_to_event(
    b: Multibody,
    alpha: float,
    beta: float,
    t: float,
    y: FloatArray,
    first: FloatArray,
    h: float,
    end: FloatArray,
    onset: FloatArray,
) -> tuple[FloatArray, float]:
    """Shorten a step of length `h` to `end` so that it ends just beyond its first event.

    Returns the state there and the length (Illinois method).
    """
    low, high = 0.0, h
    beyond = max(how_far_beyond(b, end, onset))
    weight_low, weight_high = max(how_far_beyond(b, y, onset)), beyond
    for _ in range(200):
        if beyond <= _PASSED:
            break
        middle = (low * weight_high - high * weight_low) / (weight_high - weight_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        state, _ = dormand_prince_step(b, alpha, beta, t, y, first, middle, onset)
        at = max(how_far_beyond(b, state, onset))
        if at > 0.0:
            high, beyond, weight_high = middle, at, at
            weight_low *= 0.5
            end = state
        else:
            low, weight_low = middle, at
            weight_high *= 0.5
    return end, high
