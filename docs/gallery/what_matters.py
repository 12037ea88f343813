"""Where the variance comes from.

Sobol' indices of Ishigami's function: the third input acts only together with the first, so that
its main index is zero and its total one is not. An expansion of 200 runs is set beside pick-freeze
sampling on the model itself.
"""

import numpy as np
import scipy.stats as st

import uqfold
from uqfold.analysis import chaos_sobol, pick_freeze


def ishigami(x):
    first, second, third = x.T
    return np.sin(first) + 7.0 * np.sin(second) ** 2 + 0.1 * third**4 * np.sin(first)


angle = st.uniform(-np.pi, 2.0 * np.pi)
problem = uqfold.Problem(ishigami, individual={"x1": angle, "x2": angle, "x3": angle})
expansion = chaos_sobol(problem, uqfold.methods.PolynomialChaos(runs=200), rng=1)
sampled = pick_freeze(problem, samples=4_096, rng=1)
figure = uqfold.plots.sobol([expansion, sampled])
