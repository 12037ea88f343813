"""What tests hand on to the hundreds of processes that they start.

Byte code is kept, also where the environment asks for none: each process would compile the whole
package anew. Ctrl-C is heard: a job in the background of a shell hands on that it is ignored.
BLAS runs on one thread unless the environment says otherwise: tests run side by side, and threads
of small matrices only wait for each other.
"""

import os
import signal
import sys
from collections.abc import Iterator

import pytest

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# before numpy is imported
os.environ.setdefault("OPENBLAS_NUM_THREADS", os.environ.get("OMP_NUM_THREADS", "1"))
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="module")
def one_blas_thread() -> Iterator[None]:
    """Surfaces are fitted as methods fit them: threads of BLAS would only wait for each other."""
    from uqfold import algebra

    with algebra.one_blas_thread():
        yield
