"""What a case is handed when it measures: how thoroughly, with which fault, with which seeds."""

from __future__ import annotations

import hashlib
import json
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from uqfold.validation.case import Tier
from uqfold.writing import write_text

Value = TypeVar("Value")

Progress = Callable[[int, int | None], None]
"""Called with the parts done, and how many there are (None: not known)."""


@dataclass(frozen=True)
class Work:
    """The order to measure one case.

    Attributes
    ----------
    tier
        How thoroughly.
    fault
        Name of the fault to plant, or None to measure honestly.
    seeds, settings
        What the case declares.
    kept
        Folder in which finished parts outlive an interruption, or None.
    progress
        Told of every finished part.
    saved
        Seconds that parts read instead of computed once took.
    """

    tier: Tier = "quick"
    fault: str | None = None
    seeds: tuple[int, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    kept: Path | None = None
    progress: Progress = lambda _done, _total: None
    saved: list[float] = field(default_factory=list)

    def pick(self, quick: Value, default: Value, full: Value) -> Value:
        """Return the value that belongs to the tier."""
        return {"quick": quick, "default": default, "full": full}[self.tier]

    def parts(self, computations: Mapping[str, Callable[[], Any]]) -> dict[str, Any]:
        """Compute parts one by one; those that an interrupted run has finished are read instead.

        Parameters
        ----------
        computations
            Name of each part -> what computes it; the result has to be made of what JSON knows
            (numbers, texts, lists, dictionaries with text keys), and depend on nothing but the
            case's code, its tier and the name.

        Returns
        -------
        dict
            Name -> result, in order.
        """
        results: dict[str, Any] = {}
        self.progress(0, len(computations))
        for name, compute in computations.items():
            text = self._finished(name)
            if text is None:
                start = time.perf_counter()
                result = compute()
                text = json.dumps({"result": result, "seconds": time.perf_counter() - start})
                self._keep(name, text)
            else:
                self.saved.append(json.loads(text)["seconds"])
            # what is read after an interruption is the same to the last bit
            results[name] = json.loads(text)["result"]
            self.progress(len(results), len(computations))
        return results

    def _finished(self, name: str) -> str | None:
        """Return what was kept of a part; a damaged file is none, and the part computed again."""
        path = self._path(name)
        if path is None or not path.is_file():
            return None
        digest, _, text = path.read_text("utf-8", errors="replace").partition("\n")
        if digest == _digest(name, text):
            return text
        warnings.warn(f"{path} is damaged, and left out: it is computed again", stacklevel=3)
        return None

    def _keep(self, name: str, text: str) -> None:
        path = self._path(name)
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text(path, f"{_digest(name, text)}\n{text}")

    def _path(self, name: str) -> Path | None:
        return None if self.kept is None else self.kept / f"{_digest(name, '')[:16]}.json"


def _digest(name: str, text: str) -> str:
    return hashlib.sha256(f"{name}\n{text}".encode()).hexdigest()
