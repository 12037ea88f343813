"""Intermediate results on disk, each under a digest of itself.

A file holds the digest in its first line and JSON in its second. The digest covers the file's name
too, so that a file put in the place of another is none of it.
"""

from __future__ import annotations

import hashlib
import json
import warnings
from pathlib import Path
from typing import Any

from uqfold.writing import write_text


def write_sealed(path: Path, content: Any) -> Any:
    """Write what JSON knows, NaN and infinities too, and return it as it will be read.

    Raises
    ------
    OSError
        If it cannot be written.
    TypeError, ValueError
        If JSON does not know it.
    """
    text = json.dumps(content)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, f"{_digest(path, text)}\n{text}\n")
    return json.loads(text)


def read_sealed(path: Path) -> Any:
    """Return what `write_sealed` wrote, or None if there is no such file.

    A file that does not have its digest counts as none, and a warning says so.
    """
    try:
        digest, text = path.read_bytes().decode("utf-8").removesuffix("\n").split("\n")
        if digest == _digest(path, text):
            return json.loads(text)
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        pass
    warnings.warn(f"{path} is damaged, and left out: what it held is computed again", stacklevel=3)
    return None


def _digest(path: Path, text: str) -> str:
    return hashlib.sha256(f"{path.name}\n{text}".encode()).hexdigest()
