"""A program that is interrupted again and again at random moments, and says what came of it.

    python ctrl_c.py METHOD KIND PLACE TRIES SEED

Another process sends SIGINT, so that it comes at any instruction, also within compiled code.
"""

import os
import random
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
from uqfold.methods import (
    ConditionalMonteCarlo,
    FFNISaddlepoint,
    MonteCarlo,
    OpenTURNSFORM,
    OpenTURNSMonteCarlo,
)

METHODS = {
    "mc": MonteCarlo(systems=10**4),
    "conditional-mc": ConditionalMonteCarlo(),
    "openturns-mc": OpenTURNSMonteCarlo(max_samples=10**4, target_cov=1e-9, block_size=200),
    "openturns-form": OpenTURNSFORM(),
    "ffni-spa": FFNISaddlepoint(),
}

SENDER = """
import os, sys, time, signal
for line in sys.stdin:
    time.sleep(float(line))
    os.kill(os.getppid(), signal.SIGINT)
"""


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
    if kind == "mixture":
        return [ot.Mixture([ot.Beta(2.3, 3.1, 0, 1), ot.Gamma(2.3, 1.0)]), ot.Normal()]
    if kind == "copula":
        return ot.JointDistribution([ot.Gamma(2.3, 1.0), ot.Normal()], ot.GumbelCopula(2.0))
    return [ot.Beta(2.3, 3.1, 0, 1), ot.Gamma(2.3, 1.0)]


def main(method: str, kind: str, place: str, tries: str, seed: str) -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    problem = uqfold.Problem(
        lambda x: x[:, 0] + 0.1 * x[:, 1], inputs=inputs_of(kind), names=["a", "b"], shared=["a"]
    )
    rules = uqfold.criteria([0.9, 1.0, 1.1])
    came: list[int] = []

    def run() -> None:
        while not came:
            METHODS[method].estimate(problem, rules, rng=1)

    sender = subprocess.Popen(
        [sys.executable, "-c", SENDER], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    )
    assert sender.stdin is not None
    rng = random.Random(int(seed))
    slowest, interrupted = 0.0, 0
    for _ in range(int(tries)):
        came.clear()
        delay = rng.uniform(0.0, 0.1)
        thread = threading.Thread(target=run)
        began = time.perf_counter()
        try:
            sender.stdin.write(f"{delay}\n")
            sender.stdin.flush()
            if place == "thread":
                thread.start()
                while True:
                    time.sleep(0.005)
            run()
        except KeyboardInterrupt:
            interrupted += 1
            slowest = max(slowest, time.perf_counter() - began - delay)
        came.append(1)
        if thread.ident is not None:
            thread.join()
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    sender.stdin.close()
    print(f"{interrupted} of {tries} interrupted, the slowest after {slowest:.2f} s", flush=True)
    os._exit(0)


if __name__ == "__main__":
    np.seterr(all="ignore")
    main(*sys.argv[1:])
