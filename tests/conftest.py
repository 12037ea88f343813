"""What tests hand on to the hundreds of processes that they start.

Byte code is kept, also where the environment asks for none: each process would compile the whole
package anew. Ctrl-C is heard: a job in the background of a shell hands on that it is ignored.
BLAS runs on one thread unless the environment says otherwise: tests run side by side, and threads
of small matrices only wait for each other. The wing is compiled once, while the workers collect,
rather than by each of them: it takes half a minute.
"""

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Generator, Iterator

import pytest

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# before numpy is imported
os.environ.setdefault("OPENBLAS_NUM_THREADS", os.environ.get("OMP_NUM_THREADS", "1"))
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

COMPILING = """
from uqfold.mechanism import WingParameters, deployment_times, ideal_deployment_times, trajectory
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.stiff import deploy_stiff
from uqfold.mechanism.wing import Wings

wing = WingParameters(t_max=1e-3)
deployment_times(wing)
trajectory(wing)
ideal_deployment_times(wing)
deploy_stiff(Wings(wing).table(), 1e-6, NO_RECORD)
"""
"""Calls every function of the mechanism that is kept on disk."""
COMPILER = pytest.StashKey[subprocess.Popen[bytes]]()


def pytest_configure(config: pytest.Config) -> None:
    """Compile the wing beside the workers, in the process that only hands out tests to them."""
    if config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        config.stash[COMPILER] = subprocess.Popen(
            [sys.executable, "-c", COMPILING], cwd=config.rootpath, stderr=subprocess.DEVNULL
        )


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep the garbage collector from looking through thousands of tests, which are no garbage."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What is thorough is slow too: `-m slow` is all that the default leaves out."""
    for item in items:
        if item.get_closest_marker("thorough"):
            item.add_marker(pytest.mark.slow)


def pytest_unconfigure(config: pytest.Config) -> None:
    if COMPILER in config.stash:
        config.stash[COMPILER].terminate()
        config.stash[COMPILER].wait()


@pytest.fixture(scope="module")
def one_blas_thread() -> Iterator[None]:
    """Surfaces are fitted as methods fit them: threads of BLAS would only wait for each other."""
    from uqfold import algebra

    with algebra.one_blas_thread():
        yield
