"""What stands behind OpenTURNS' interface objects: a family of its own, or Python code."""

from __future__ import annotations

import sys
import threading
from typing import Any

from uqfold.inputs.engine import openturns

_KIND = "class=PythonDistribution"


def family_of(distribution: Any) -> tuple[Any, str]:
    """Return what stands behind OpenTURNS' interface object, and its class; empty: by Python."""
    own = (
        distribution.getImplementation()
        if hasattr(distribution, "getImplementation")
        else distribution
    )
    return own, str(own.getClassName()) if hasattr(own, "getClassName") else ""


def python_object(distribution: Any) -> Any | None:
    """Return the Python object behind an OpenTURNS distribution, or None if it has none.

    OpenTURNS keeps the object to itself, but calls it: a profile hook sees the call, in a thread
    of its own, so that nobody else's hook is touched.
    """
    if not repr(distribution).startswith(_KIND):
        return None
    ot = openturns()
    seen: list[Any] = []

    def hook(frame: Any, event: str, _: Any) -> None:
        own = frame.f_locals.get("self") if event == "call" and not seen else None
        if isinstance(own, ot.PythonDistribution):
            seen.append(own)

    def call() -> None:
        sys.setprofile(hook)
        try:
            distribution.computeCDF([0.0])
        except (RuntimeError, TypeError, ValueError):
            pass  # what it cannot compute is found where it is needed
        finally:
            sys.setprofile(None)

    thread = threading.Thread(target=call)
    thread.start()
    thread.join()
    return seen[0] if seen else None
