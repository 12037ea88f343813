"""Ctrl-C while OpenTURNS runs is a KeyboardInterrupt, not the end of the process."""

import subprocess
import sys

import pytest

PROGRAM = """
import os, signal, threading, time
import uqfold

# a program started in the background may have inherited that Ctrl-C is ignored
signal.signal(signal.SIGINT, signal.default_int_handler)
plain = uqfold.problems.series()
running = threading.Event()

def model(x):
    running.set()
    time.sleep(0.02)
    return plain.model(x)

problem = uqfold.Problem(model, inputs=plain.inputs.distribution, shared=["X1"], units=4)

def press():
    running.wait()
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=press, daemon=True).start()
try:
    {method}.estimate(problem, uqfold.criteria([4.0, 5.0, 6.0, 7.0]), rng=1)
except KeyboardInterrupt:
    print("alive")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals to oneself need POSIX")
@pytest.mark.parametrize(
    "method",
    [
        "uqfold.methods.OpenTURNSMonteCarlo(max_samples=10**9, target_cov=1e-9)",
        "uqfold.methods.OpenTURNSFORM(tolerance=1e-12, max_iterations=10**6)",
    ],
)
def test_ctrl_c_reaches_python(method: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.replace("{method}", method)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr[-2000:]
