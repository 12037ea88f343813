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
from uqfold.comparison.encoding import decoded, encoded, parsed_json
from uqfold.comparison.header import installed_versions
from uqfold.writing import write_text

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
        """Give the rows of a finished job, or None; what cannot be read counts as missing."""
        if self._folder is None:
            return None
        try:
            text = (self._folder / f"{key}.json").read_text(encoding="utf-8")
            rows = parsed_json(text)["rows"]
            return [
                {
                    name: decoded(value, kind, name)
                    for (name, kind), value in zip(columns.items(), row, strict=True)
                }
                for row in rows
            ]
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def put(self, key: str, columns: Mapping[str, type], rows: Sequence[Mapping[str, Any]]) -> None:
        """Keep the rows of a finished job."""
        if self._folder is None:
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        values = [[encoded(kind(row[name])) for name, kind in columns.items()] for row in rows]
        write_text(self._folder / f"{key}.json", json.dumps({"rows": values}, allow_nan=False))


def job_key(parts: Sequence[str]) -> str:
    """Give the digest under which a job is kept, from texts that together describe it."""
    content = [_source_digest(), json.dumps(installed_versions(), sort_keys=True), *parts]
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
