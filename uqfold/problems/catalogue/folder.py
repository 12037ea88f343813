"""The names and titles of the limit states, told by their files without loading any."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent / "limit_states"


def titles() -> dict[str, str]:
    """Return name -> title of every limit state.

    Examples
    --------
    >>> titles()["rp22"]
    'Convex domain of failure in two standard normals (RP22)'
    """
    return {
        path.stem.replace("_", "-"): _first_line(path).strip('".\n')
        for path in sorted(_FOLDER.glob("[!_]*.py"))
    }


def _first_line(path: Path) -> str:
    with path.open(encoding="utf-8") as file:
        return file.readline()
