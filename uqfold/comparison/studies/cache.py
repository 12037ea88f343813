"""Finished jobs and model runs that outlive a program, so that a second run redraws in seconds.

A job is found by a digest of all that its answer depends on: problem, method, criteria, budget,
seed, and the source of uqfold that makes numbers. Whatever changes, the job is done again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import uqfold
from uqfold.comparison.encoding import decoded, encoded
from uqfold.comparison.sealed import read_sealed, write_sealed
from uqfold.provenance import versions

_ABOVE = {"cli", "report", "testing", "comparison"}
"""Rooms whose source changes no number; of the comparison the analyses do."""


class JobCache:
    """Tables of finished jobs, one file each.

    Parameters
    ----------
    folder
        Where they lie; made when the first is kept. None: nothing is kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = None if folder is None else folder / "jobs"

    def get(self, key: str, columns: Mapping[str, type]) -> list[dict[str, Any]] | None:
        """Return the rows of a finished job, or None; a damaged file counts as none."""
        kept = None if self._folder is None else read_sealed(self._folder / f"{key}.json")
        if kept is None:
            return None
        return [
            {
                name: decoded(value, kind, name)
                for (name, kind), value in zip(columns.items(), row, strict=True)
            }
            for row in kept["rows"]
        ]

    def put(self, key: str, columns: Mapping[str, type], rows: Sequence[Mapping[str, Any]]) -> None:
        """Keep the rows of a finished job."""
        if self._folder is None:
            return
        values = [[encoded(kind(row[name])) for name, kind in columns.items()] for row in rows]
        write_sealed(self._folder / f"{key}.json", {"rows": values})


def job_key(parts: Sequence[str]) -> str:
    """Give the digest under which a job is kept, from texts that together describe it."""
    content = [_source_digest(), json.dumps(versions(), sort_keys=True), *parts]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:40]


@cache
def _source_digest() -> str:
    root = Path(uqfold.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        room = path.relative_to(root).parts[0]
        if path.suffix in {".py", ".json"} and (room not in _ABOVE or path.parent.name == "steps"):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()
