"""How the kernels of this room are compiled.

Kernels are compiled together with the entry point that calls them, and only entry points are kept
on disk: a function cached on its own would go on using the kernels it was first compiled with
after their files have changed. For the same reason an entry point takes up `fingerprint()`.

Division by zero follows IEEE 754, as in numpy, and nothing is compiled with `fastmath`: NaN stays
visible.
"""

import hashlib
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit

kernel = njit(error_model="numpy")
"""Decorator of a kernel."""

inlined = njit(error_model="numpy", forceinline=True)
"""Decorator of a small kernel that is compiled into its caller."""


def entry_point(function: Callable[..., Any]) -> Callable[..., Any]:
    """Decorator of a kernel that Python calls.

    It has to use `fingerprint()` as a closure variable. Where no folder can take the compiled code
    it is compiled anew by every process, and a warning says so.
    """
    compiled: Callable[..., Any]
    try:
        compiled = njit(error_model="numpy", nogil=True, cache=True)(function)
    except RuntimeError:
        _say_that_nothing_is_kept()
        compiled = njit(error_model="numpy", nogil=True)(function)
    return compiled


@cache
def _say_that_nothing_is_kept() -> None:
    warnings.warn(
        "the wing's compiled code cannot be kept, every process compiles it anew: "
        f"neither {Path(__file__).parent} nor the folder for caches is writable. Set "
        "NUMBA_CACHE_DIR to a folder that is",
        RuntimeWarning,
        stacklevel=3,
    )


def fingerprint() -> int:
    """Return a number that changes with any source file of this room.

    Numba keys its cache on the file of the entry point alone, but also on the variables in its
    closure.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return int.from_bytes(digest.digest()[:7], "big")
