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
from collections.abc import Callable

import numpy as np
import openturns as ot
import pandas as pd

import uqfold
from uqfold.inputs import product_inputs
from uqfold.inputs.polynomials import own_polynomials
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.typing import FloatArray

Function = Callable[[FloatArray], FloatArray]
NEW, SEEDS = 1000, 3


def smooth(u: FloatArray) -> FloatArray:
    """Return a response that bends a little in every direction."""
    return np.exp(0.4 * u.sum(axis=1) / np.sqrt(u.shape[1])) + 0.05 * (u**2).sum(axis=1)


def rough(u: FloatArray) -> FloatArray:
    """Return a response with a kink and a small ripple."""
    return smooth(u) + 0.5 * np.abs(u[:, 0] - 0.3) + 0.02 * np.sin(9.0 * u[:, -1])


def wing() -> tuple[Function, int]:
    """Return the deployment time of the folding wing, and the number of its inputs."""
    problem = uqfold.problems.folding_wing()
    return (
        lambda u: problem.model(problem.inputs.from_standard_normal(u)),
        problem.inputs.dimension,
    )


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
    return (
        GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=2).fit(u, y).predict
    )


def of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' process with a linear trend."""
    d = u.shape[1]
    fitter = ot.GaussianProcessFitter(
        ot.Sample(u), ot.Sample(y[:, None]), ot.SquaredExponential([3.0] * d),
        ot.LinearBasisFactory(d).build(),
    )  # fmt: skip
    fitter.run()
    regression = ot.GaussianProcessRegression(fitter.getResult())
    regression.run()
    meta = regression.getResult().getMetaModel()
    return lambda new: np.array(meta(ot.Sample(new))).ravel()


def of_smt(u: FloatArray, y: FloatArray) -> Function:
    """Fit SMT's Kriging with a linear trend and learned noise."""
    from smt.surrogate_models import KRG

    model = KRG(poly="linear", eval_noise=True, print_global=False, n_start=3)
    model.set_training_values(u, y)
    model.train()
    return lambda new: model.predict_values(new).ravel()


def ours_expansion(u: FloatArray, y: FloatArray) -> Function:
    """Fit an expansion in Hermite polynomials."""
    return fit_polynomial_chaos(u, y).mean


def expansion_of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' sparse expansion by least angles."""
    d = u.shape[1]
    factory = ot.OrthogonalProductPolynomialFactory([ot.HermiteFactory()] * d)
    count = factory.getEnumerateFunction().getStrataCumulatedCardinal({2: 8, 5: 4}.get(d, 2))
    selection = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
    algorithm = ot.FunctionalChaosAlgorithm(
        ot.Sample(u), ot.Sample(y[:, None]), ot.Normal(d),
        ot.FixedStrategy(factory, count), ot.LeastSquaresStrategy(selection),
    )  # fmt: skip
    algorithm.run()
    meta = algorithm.getResult().getMetaModel()
    return lambda new: np.array(meta(ot.Sample(new))).ravel()


SURFACES: dict[str, Callable[[FloatArray, FloatArray], Function]] = {
    "process: ours": ours_process,
    "process: scikit-learn": of_sklearn,
    "process: OpenTURNS": of_openturns,
    "process: SMT": of_smt,
    "expansion: ours": ours_expansion,
    "expansion: OpenTURNS": expansion_of_openturns,
}


def measured(
    fit: Callable[[FloatArray, FloatArray], Function], function: Function, d: int, size: int
) -> tuple[float, float]:
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


def two_bases() -> list[dict[str, object]]:
    """Expansions in Hermite polynomials of the scores and in the inputs' own polynomials."""
    rows: list[dict[str, object]] = []
    for law in (ot.Uniform(-1.0, 1.0), ot.Exponential(1.0), ot.Beta(2.0, 3.0, 0.0, 1.0)):
        inputs = product_inputs(None, {f"x{i}": law for i in range(3)})
        own = own_polynomials(inputs, 11)

        def response(u: FloatArray, inputs: uqfold.inputs.JointInputs = inputs) -> FloatArray:
            x = inputs.from_standard_normal(u)
            return np.asarray(1.0 / (4.0 + x[:, 0] + 0.5 * x[:, 1] * x[:, 2]))

        for name, basis in (("Hermite", None), ("own", own)):
            error, seconds = measured(
                lambda u, y, basis=basis: fit_polynomial_chaos(u, y, own=basis).mean,
                response, 3, 100,
            )  # fmt: skip
            rows.append(
                {"function": law.getClassName(), "inputs": 3, "runs": 100,
                 "surface": f"expansion: {name}", "error": error, "seconds": seconds}
            )  # fmt: skip
    return rows


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    ot.Log.Show(ot.Log.NONE)
    ot.TBB.SetThreadsNumber(1)
    functions = [("wing", *wing(), 100)]
    functions += [
        (name, function, d, size)
        for name, function in (("smooth", smooth), ("rough", rough))
        for d, size in ((2, 60), (5, 100), (20, 200))
    ]
    rows: list[dict[str, object]] = []
    for name, function, d, size in functions:
        for surface, fit in SURFACES.items():
            try:
                error, seconds = measured(fit, function, d, size)
            except ImportError:
                continue
            row = {"function": name, "inputs": d, "runs": size, "surface": surface}
            rows.append({**row, "error": error, "seconds": seconds})
    table = pd.DataFrame(rows + two_bases())
    columns = {"error": "{:.2g}".format, "seconds": "{:.2f}".format}
    print(table.to_string(index=False, formatters=columns))


if __name__ == "__main__":
    main()
