"""What tests hand on to the hundreds of processes that they start.

Byte code is kept, also where the environment asks for none: each process would compile the whole
package anew. Ctrl-C is heard: a job in the background of a shell hands on that it is ignored.
"""

import os
import signal
import sys
from collections.abc import Iterator

import pytest

sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="module")
def one_blas_thread() -> Iterator[None]:
    """Surfaces are fitted as methods fit them: threads of BLAS would only wait for each other."""
    from uqfold import algebra

    with algebra.one_blas_thread():
        yield
