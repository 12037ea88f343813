"""Force in the spring of a secondary system under white noise.

g = Fs - 3 ks sqrt(E[xs^2]), where the mean square falls with the cube of a factor common to both
frequencies. So log(Fs / sqrt(S0) / ks) plus 3/2 of the logarithm of that factor decides; it is
normal given the ratios of frequencies and masses. A product rule over these ratios and the two
dampings is left.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from uqfold.problems.catalogue.distributions import lognormal, lognormal_of, lognormal_parameters
from uqfold.problems.catalogue.integrals import over_normals
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

MOMENTS = {
    "mp": (1.5, 0.15),
    "ms": (0.01, 0.001),
    "kp": (1.0, 0.2),
    "ks": (0.01, 0.002),
    "zp": (0.05, 0.02),
    "zs": (0.02, 0.01),
    "S0": (100.0, 10.0),
    "Fs": (27.5, 2.75),
}


def mean_square(
    wp: FloatArray, ws: FloatArray, gamma: FloatArray, zp: FloatArray, zs: FloatArray
) -> FloatArray:
    """Return E[xs^2] per S0 of frequencies, ratio of masses, and dampings (they broadcast)."""
    wa, za = 0.5 * (wp + ws), 0.5 * (zp + zs)
    theta = (wp - ws) / wa
    shared = za * zs / (zp * zs * (4.0 * za**2 + theta**2) + gamma * za**2)
    own = (zp * wp**3 + zs * ws**3) * wp / (4.0 * za * wa**4)
    return np.asarray(np.pi / (4.0 * zs * ws**3) * shared * own)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 8)."""
    mp, ms, kp, ks, zp, zs, s0, fs = x.T
    square = s0 * mean_square(np.sqrt(kp / mp), np.sqrt(ks / ms), ms / mp, zp, zs)
    return np.asarray(fs - 3.0 * ks * np.sqrt(square))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    parameters = {name: lognormal_parameters(*two) for name, two in MOMENTS.items()}
    mu, sigma = np.array([parameters[name] for name in ("mp", "ms", "kp", "ks", "S0", "Fs")]).T
    # logarithms of the ratio of frequencies, the ratio of masses, and what decides
    rows = np.array(
        [
            [-0.5, 0.5, 0.5, -0.5, 0.0, 0.0],
            [-1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [-0.375, -0.375, 0.375, 0.375 - 1.0, -0.5, 1.0],
        ]
    )
    mean, root = rows @ mu, np.linalg.cholesky((rows * sigma**2) @ rows.T)

    def given(u: FloatArray, v: FloatArray, p: FloatArray, s: FloatArray) -> FloatArray:
        ratio = np.exp(0.5 * (mean[0] + root[0, 0] * u))
        gamma = np.exp(mean[1] + root[1, 0] * u + root[1, 1] * v)
        zp, zs = (lognormal_of(x, *MOMENTS[name]) for x, name in ((p, "zp"), (s, "zs")))
        needed = np.log(3.0) + 0.5 * np.log(mean_square(ratio, 1.0 / ratio, gamma, zp, zs))
        z = (needed - mean[2] - root[2, 0] * u - root[2, 1] * v) / root[2, 2]
        return np.asarray(ndtr(z))

    return over_normals(given, 4, steps=(0.12, 0.1), stretch=(1.0, 8.0, 4.5, 4.5))


ENTRY = Entry(
    source="Der Kiureghian A, De Stefano M (1991), Efficient algorithm for second-order "
    "reliability analysis, J. Eng. Mech. 117, 2904-2923, as in uqtestfuns and OpenTURNS (mean of "
    "Fs 27.5)",
    kinds=("rare", "curved"),
    limit_state=limit_state,
    inputs=lambda: {name: lognormal(*two) for name, two in MOMENTS.items()},
    reference=reference,
    dear=True,
    pf=3.784396891e-07,
    error=2.8e-15,
    how="product rule over four inputs, of a normal tail",
    published={"OpenTURNS, use case": "3.78e-7"},
)
