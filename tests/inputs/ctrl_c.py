"""A program that draws for ever, and says what Ctrl-C from outside did to it."""

import os
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import openturns as ot
from scipy import stats

import uqfold
from uqfold.methods import MonteCarlo, OpenTURNSMonteCarlo

METHODS = {
    "mc": MonteCarlo(systems=10**7),
    "openturns-mc": OpenTURNSMonteCarlo(max_samples=10**9, target_cov=1e-9, block_size=50_000),
}


class OwnUniform(ot.PythonDistribution):
    """A uniform distribution that a user wrote."""

    def __init__(self) -> None:
        super().__init__(1)

    def getRange(self) -> Any:
        return ot.Interval(0.0, 1.0)

    def computeCDF(self, x: Any) -> float:
        return min(max(x[0], 0.0), 1.0)


def inputs_of(kind: str) -> Any:
    """Inputs of one kind."""
    if kind == "own":
        return [ot.Distribution(OwnUniform()), ot.Normal()]
    if kind == "scipy":
        return [stats.gumbel_l(1, 2), stats.laplace()]
    if kind == "copula":
        return ot.JointDistribution([ot.Gamma(2.3, 1.0), ot.Normal()], ot.GumbelCopula(2.0))
    return [ot.Beta(2.3, 3.1, 0, 1), ot.Gamma(2.3, 1.0)]


def main(method: str, kind: str, seconds: str, place: str) -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    problem = uqfold.Problem(lambda x: x[:, 0], inputs=inputs_of(kind), names=["a", "b"])
    METHODS[method].estimate(problem, uqfold.criteria([0.9]), max_evals=2000, rng=1)
    press = f"sleep {seconds}; kill -INT {os.getpid()}"
    subprocess.Popen(["/bin/sh", "-c", press])

    def run() -> None:
        METHODS[method].estimate(problem, uqfold.criteria([0.9]), rng=1)

    try:
        if place == "thread":
            thread = threading.Thread(target=run, daemon=True)
            thread.start()
            while thread.is_alive():
                time.sleep(0.05)
        else:
            run()
        print("went on")
    except KeyboardInterrupt:
        print("interrupted", flush=True)
        os._exit(0)


if __name__ == "__main__":
    np.seterr(all="ignore")
    main(*sys.argv[1:])
