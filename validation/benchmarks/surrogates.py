"""Our surfaces beside those of scikit-learn, OpenTURNS and SMT, on the same runs.

Every surface is fitted to the same design and predicts the same new points, spread 1.5 times as
wide as the inputs; given are the root mean square error as a share of the responses' spread, and
the processor time of the fit. Peers have the settings that their own documentation recommends:
length scales for every variable, learned noise, a few restarts. The last rows compare the two bases
of an expansion on inputs that are not normal. SMT is left out where it is not installed.

    python validation/benchmarks/surrogates.py    # some minutes
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import openturns as ot
import pandas as pd

import uqfold
from uqfold.inputs import JointInputs, product_inputs
from uqfold.inputs.polynomials import own_polynomials
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.typing import FloatArray

Function = Callable[[FloatArray], FloatArray]
Fit = Callable[[FloatArray, FloatArray], Function]
NEW, SEEDS = 1000, 3


def smooth(u: FloatArray) -> FloatArray:
    """Return a response that bends a little in every direction."""
    return np.exp(0.4 * u.sum(axis=1) / np.sqrt(u.shape[1])) + 0.05 * (u**2).sum(axis=1)


def rough(u: FloatArray) -> FloatArray:
    """Return a response with a kink and a small ripple."""
    return smooth(u) + 0.5 * np.abs(u[:, 0] - 0.3) + 0.02 * np.sin(9.0 * u[:, -1])


def ours_process(u: FloatArray, y: FloatArray) -> Function:
    """Fit both trends of `kriging`, and keep the one that predicts left-out runs better."""
    fits = [
        fit_gaussian_process(u, y, trend=trend, kernel=kernel)
        for trend in (2, fit_polynomial_chaos(u, y).indices)
        for kernel in ("gaussian", "matern52")
    ]
    return max(fits, key=lambda one: one.leave_one_out().log_density).mean


def of_sklearn(u: FloatArray, y: FloatArray) -> Function:
    """Fit scikit-learn's process."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    scales = RBF(np.full(u.shape[1], 3.0), (0.1, 1e3))
    kernel = ConstantKernel(1.0, (1e-3, 1e5)) * scales + WhiteKernel(1e-4, (1e-10, 1.0))
    process = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=2)
    return process.fit(u, y).predict


def of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' process with a linear trend."""
    d = u.shape[1]
    fitter = ot.GaussianProcessFitter(
        ot.Sample(u), ot.Sample(y[:, None]), ot.SquaredExponential([3.0] * d),
        ot.LinearBasisFactory(d).build(),
    )  # fmt: skip
    fitter.run()
    return ran(ot.GaussianProcessRegression(fitter.getResult()))


def expansion_of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' sparse expansion by least angles."""
    d = u.shape[1]
    factory = ot.OrthogonalProductPolynomialFactory([ot.HermiteFactory()] * d)
    count = factory.getEnumerateFunction().getStrataCumulatedCardinal({2: 8, 5: 4}.get(d, 2))
    selection = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
    return ran(
        ot.FunctionalChaosAlgorithm(
            ot.Sample(u), ot.Sample(y[:, None]), ot.Normal(d),
            ot.FixedStrategy(factory, count), ot.LeastSquaresStrategy(selection),
        )
    )  # fmt: skip


def ran(algorithm: Any) -> Function:
    """Return the surface that an algorithm of OpenTURNS fits."""
    algorithm.run()
    surface = algorithm.getResult().getMetaModel()
    return lambda new: np.array(surface(ot.Sample(new))).ravel()


def of_smt(u: FloatArray, y: FloatArray) -> Function:
    """Fit SMT's Kriging with a linear trend and learned noise."""
    from smt.surrogate_models import KRG

    model = KRG(poly="linear", eval_noise=True, print_global=False, n_start=3)
    model.set_training_values(u, y)
    model.train()
    return lambda new: model.predict_values(new).ravel()


SURFACES: dict[str, Fit] = {
    "process: ours": ours_process,
    "process: scikit-learn": of_sklearn,
    "process: OpenTURNS": of_openturns,
    "process: SMT": of_smt,
    "expansion: ours": lambda u, y: fit_polynomial_chaos(u, y).mean,
    "expansion: OpenTURNS": expansion_of_openturns,
}


def questions() -> Iterator[tuple[str, Function, int, int, dict[str, Fit]]]:
    """Yield name, function of standard normals, inputs, runs, and the surfaces to compare."""
    wing = uqfold.problems.folding_wing()
    mapped = wing.inputs.from_standard_normal
    yield "wing", lambda u: wing.model(mapped(u)), wing.inputs.dimension, 100, SURFACES
    for function in (smooth, rough):
        for d, size in ((2, 60), (5, 100), (20, 200)):
            yield function.__name__, function, d, size, SURFACES
    for law in (ot.Uniform(-1.0, 1.0), ot.Exponential(1.0), ot.Beta(2.0, 3.0, 0.0, 1.0)):
        inputs = product_inputs(None, {f"x{i}": law for i in range(3)})

        def response(u: FloatArray, inputs: JointInputs = inputs) -> FloatArray:
            x = inputs.from_standard_normal(u)
            return np.asarray(1.0 / (4.0 + x[:, 0] + 0.5 * x[:, 1] * x[:, 2]))

        bases: dict[str, Fit] = {
            f"expansion: {name}": lambda u, y, own=own: fit_polynomial_chaos(u, y, own=own).mean
            for name, own in (("Hermite", None), ("own", own_polynomials(inputs, 11)))
        }
        yield law.getClassName(), response, 3, 100, bases


def measured(fit: Fit, function: Function, d: int, size: int) -> tuple[float, float]:
    """Return the error as a share of the responses' spread, and seconds, medians over designs."""
    found = []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        u, new = space_filling_design(size, d, rng), 1.5 * rng.standard_normal((NEW, d))
        y, right = function(u), function(new)
        started = time.process_time()
        surface = fit(u, y)
        seconds = time.process_time() - started
        found.append((np.sqrt(np.mean((surface(new) - right) ** 2)) / right.std(), seconds))
    error, seconds = np.median(found, axis=0)
    return float(error), float(seconds)


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    ot.Log.Show(ot.Log.NONE)
    ot.TBB.SetThreadsNumber(1)
    rows = []
    for name, function, d, size, surfaces in questions():
        for surface, fit in surfaces.items():
            with suppress(ImportError):
                rows.append((name, d, size, surface, *measured(fit, function, d, size)))
    columns = ["function", "inputs", "runs", "surface", "error", "seconds"]
    formats = {"error": "{:.2g}".format, "seconds": "{:.2f}".format}
    print(pd.DataFrame(rows, columns=columns).to_string(index=False, formatters=formats))


if __name__ == "__main__":
    main()
