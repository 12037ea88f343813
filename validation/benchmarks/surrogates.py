"""Our surfaces beside those of scikit-learn, OpenTURNS and SMT, on the same runs.

Every surface is fitted to the same designs. Given are medians over the designs: the root mean
square error at new points, spread 1.5 times as wide as the inputs, as a share of the responses'
spread there; the relative error of the failure probability at a threshold that a thousandth of the
inputs exceeds, both counted on the same sample; and the processor time of the fit. Peers are set
up as their own documentation asks for; a process is fitted with a Gaussian and a Matern 5/2 kernel,
and the one with the higher likelihood is kept, where we keep the one that predicts left-out runs
better:

- scikit-learn: normalised responses, a length scale for every input, a white kernel, restarts;
- OpenTURNS: the search for length scales starts at four times the range of the inputs and stays
  above a tenth of it (example "configure the optimization solver"), with a linear trend;
- SMT: ten starts, a linear trend, learned noise; partial least squares (KPLS) from ten inputs on.

The last rows compare bases of an expansion for inputs that are not normal: the polynomials of
Hermite in their scores, and those of the inputs' own distributions.

    python validation/benchmarks/surrogates.py                # some minutes
    python validation/benchmarks/surrogates.py --designs 3    # medians of three designs
    python validation/benchmarks/surrogates.py --quick        # half a minute
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from io import StringIO
from typing import Any

import numpy as np
import openturns as ot
from threadpoolctl import threadpool_limits

import uqfold
from uqfold.inputs import JointInputs, product_inputs
from uqfold.inputs.polynomials import own_polynomials
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.typing import FloatArray

Function = Callable[[FloatArray], FloatArray]
Fit = Callable[[FloatArray, FloatArray], Function]

NEW, DRAWN = 1_000, 50_000
RARE = 1e-3
"""The failure probability whose error is given."""
MANY = 10
"""Inputs from which SMT's documentation recommends partial least squares."""


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
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Matern, WhiteKernel

    scales, bounds = np.full(u.shape[1], 3.0), (0.1, 1e3)
    fits = [
        GaussianProcessRegressor(
            ConstantKernel(1.0, (1e-3, 1e5)) * kernel + WhiteKernel(1e-4, (1e-10, 1.0)),
            normalize_y=True, n_restarts_optimizer=1, random_state=0,
        ).fit(u, y)
        for kernel in (RBF(scales, bounds), Matern(scales, bounds, nu=2.5))
    ]  # fmt: skip
    return max(fits, key=lambda one: one.log_marginal_likelihood_value_).predict


def of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' process with a linear trend."""
    d, x = u.shape[1], ot.Sample(u)
    extent = x.getMax() - x.getMin()
    trend = ot.LinearBasisFactory(d).build()
    fits = []
    for kernel in (ot.SquaredExponential([1.0] * d, [1.0]), ot.MaternModel([1.0] * d, 2.5)):
        kernel.setScale(4.0 * extent)
        fitter = ot.GaussianProcessFitter(x, ot.Sample(y[:, None]), kernel, trend)
        fitter.setOptimizationBounds(ot.Interval(0.1 * extent, 4.0 * extent))
        fitter.run()
        fits.append(fitter.getResult())
    best = max(fits, key=lambda one: one.getOptimalLogLikelihood())
    regression = ot.GaussianProcessRegression(best)
    regression.run()
    return predicted(regression.getResult())


def expansion_of_openturns(u: FloatArray, y: FloatArray) -> Function:
    """Fit OpenTURNS' expansions by least squares and by least angles; keep the better one.

    Polynomials are orthogonal over the design. All of a degree are fitted where there are 1.5 runs
    for each, and one degree more by least angles; leave-one-out predictions decide.
    """
    (n, d), x = u.shape, ot.Sample(u)
    spread = float(np.sqrt(np.mean(u**2)))
    of_the_design = ot.Normal([0.0] * d, [spread] * d, ot.CorrelationMatrix(d))
    factory = ot.OrthogonalProductPolynomialFactory([ot.HermiteFactory()] * d)
    counts = [factory.getEnumerateFunction().getStrataCumulatedCardinal(k) for k in range(12)]
    degree = sum(1.5 * count <= n for count in counts) - 1
    angles = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.KFold())
    fits = []
    for size, strategy in (
        (counts[degree], ot.LeastSquaresStrategy()),
        (counts[degree + 1], ot.LeastSquaresStrategy(angles)),
    ):
        algorithm = ot.FunctionalChaosAlgorithm(
            x, ot.Sample(y[:, None]), of_the_design, ot.FixedStrategy(factory, size), strategy
        )
        algorithm.run()
        result = algorithm.getResult()
        validated = ot.FunctionalChaosValidation(result, ot.LeaveOneOutSplitter(n))
        fits.append((validated.computeR2Score()[0], result))
    return predicted(max(fits, key=lambda pair: pair[0])[1])


def predicted(result: Any) -> Function:
    """Return the surface of a result of OpenTURNS."""
    surface = result.getMetaModel()
    return lambda new: np.array(surface(ot.Sample(new))).ravel()


def of_smt(u: FloatArray, y: FloatArray) -> Function:
    """Fit SMT's Kriging with a linear trend and learned noise."""
    from smt.surrogate_models import KPLS, KRG

    fits = []
    for kernel in ("squar_exp", "matern52"):
        settings = {"poly": "linear", "corr": kernel, "eval_noise": True, "print_global": False}
        many = u.shape[1] >= MANY
        model = KPLS(n_comp=3, **settings) if many else KRG(**settings)
        model.set_training_values(u, y)
        with redirect_stdout(StringIO()):  # of what failed on its way
            model.train()
        fits.append(model)
    best = max(fits, key=lambda one: float(np.squeeze(one.optimal_rlf_value)))
    return lambda new: best.predict_values(new).ravel()


SURFACES: dict[str, Fit] = {
    "process: ours": ours_process,
    "process: scikit-learn": of_sklearn,
    "process: OpenTURNS": of_openturns,
    "process: SMT": of_smt,
    "expansion: ours": lambda u, y: fit_polynomial_chaos(u, y).mean,
    "expansion: OpenTURNS": expansion_of_openturns,
}
LAWS = {
    "uniform": ot.Uniform(-1.0, 1.0),
    "exponential": ot.Exponential(1.0),
    "beta": ot.Beta(2.0, 3.0, 0.0, 1.0),
    "gamma": ot.Gamma(2.0, 1.0),
    "lognormal": ot.LogNormal(0.0, 0.4),
}


def questions(*, quick: bool) -> Iterator[tuple[str, Function, int, int, dict[str, Fit]]]:
    """Yield name, function of standard normals, inputs, runs, and the surfaces to compare."""
    wing = uqfold.problems.folding_wing()
    mapped = wing.inputs.from_standard_normal
    yield "wing", lambda u: wing.model(mapped(u)), wing.inputs.dimension, 100, SURFACES
    for function in (smooth, rough):
        for d, size in ((2, 60), (5, 100), (20, 200))[: 2 if quick else 3]:
            yield function.__name__, function, d, size, SURFACES
    for name, law in LAWS.items():
        inputs = product_inputs(None, {f"x{i}": law for i in range(3)})
        bases: dict[str, Fit] = {
            f"expansion: {basis}": lambda u, y, own=own: fit_polynomial_chaos(u, y, own=own).mean
            for basis, own in (("Hermite", None), ("own", own_polynomials(inputs, 11)))
        }
        for power in (1.5, -1.0):
            response = partial(of_inputs, inputs, power)
            for size in (30, 120):
                yield f"{name}, s^{power:g}", response, 3, size, bases


def of_inputs(inputs: JointInputs, power: float, u: FloatArray) -> FloatArray:
    """Return a power of a sum and a product of three inputs, whose scores are u (n, 3)."""
    x = inputs.from_standard_normal(u)
    return np.asarray((4.0 + x[:, 0] + 0.5 * x[:, 1] * x[:, 2]) ** power)


def measured(
    fits: dict[str, Fit], function: Function, d: int, size: int, *, seeds: int, drawn: int
) -> Iterator[tuple[str, float, float, float]]:
    """Yield surface, error of responses, error of pf, and seconds: medians over designs."""
    rng = np.random.default_rng(0)
    designs = [space_filling_design(size, d, np.random.default_rng(one)) for one in range(seeds)]
    new, many = 1.5 * rng.standard_normal((NEW, d)), rng.standard_normal((drawn, d))
    right, all_right = function(new), function(many)
    level = np.quantile(all_right, 1.0 - RARE)
    failures = np.count_nonzero(all_right > level)
    for name, fit in fits.items():
        found = []
        for u in designs:
            y = function(u)
            started = time.process_time()
            try:
                surface = fit(u, y)
            except ImportError:
                break
            seconds = time.process_time() - started
            rms = np.sqrt(np.mean((surface(new) - right) ** 2)) / right.std()
            rows = np.array_split(many, max(1, drawn // 10_000))
            off = sum(np.count_nonzero(surface(some) > level) for some in rows) / failures - 1.0
            found.append((rms, abs(off), seconds))
        median = np.median(found, axis=0) if found else np.full(3, np.nan)
        yield name, *median.tolist()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--quick", action="store_true", help="no 20 inputs, fewer points")
    parser.add_argument("--designs", type=int, default=1, help="medians over so many designs")
    quick, designs = vars(parser.parse_args()).values()
    warnings.simplefilter("ignore")
    ot.Log.Show(ot.Log.NONE)
    ot.TBB.SetThreadsNumber(1)
    ot.ResourceMap.SetAsBool("FunctionalChaosValidation-ModelSelection", True)
    threadpool_limits(1)
    # what is imported and compiled at the first call is no time of a fit
    for _ in measured(SURFACES, smooth, 2, 12, seeds=1, drawn=1_000):
        pass
    print(", ".join(f"{name} {installed(name)}" for name in PEERS))
    size = {"seeds": designs, "drawn": DRAWN // 5 if quick else DRAWN}
    print(f"| function | inputs | runs | surface | error | error of pf = {RARE:g} | seconds |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, function, d, runs, surfaces in questions(quick=quick):
        for surface, *numbers in measured(surfaces, function, d, runs, **size):
            shown = ["not installed"] * 3
            if np.isfinite(numbers).all():
                shown = [f"{numbers[0]:.2g}", f"{numbers[1]:.1%}", f"{numbers[2]:.2f}"]
            print("|", " | ".join([name, str(d), str(runs), surface, *shown]), "|", flush=True)


PEERS = ("scikit-learn", "openturns", "smt", "numpy", "scipy")


def installed(name: str) -> str:
    """Return the version of a package."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


if __name__ == "__main__":
    main()
