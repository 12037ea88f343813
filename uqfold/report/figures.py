"""Writing the figures of a comparison."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uqfold.checks import path as checked_path
from uqfold.plots.comparison_figure import comparison
from uqfold.plots.error_figure import error_against_evaluations
from uqfold.plots.saving import save
from uqfold.plots.wording import comparison_rows, drawable

if TYPE_CHECKING:
    import pandas as pd

FIGURES: dict[str, tuple[str, Callable[[pd.DataFrame], Any]]] = {
    "comparison": ("pf", comparison),
    "error-against-evaluations": ("error", error_against_evaluations),
}
"""Name of a figure -> the column without which there is none, and what draws it."""
FORMATS = ("png", "svg")


def figure_paths(folder: str | os.PathLike[str]) -> list[Path]:
    """Return the files that `write_figures` may write."""
    return [Path(folder) / f"{name}.{suffix}" for name in FIGURES for suffix in FORMATS]


def write_figures(frame: pd.DataFrame, folder: str | os.PathLike[str]) -> list[Path]:
    """Write the figures of a comparison as PNG and SVG.

    Parameters
    ----------
    frame
        What `uqfold.compare` returned, or a part of it.
    folder
        Where to; made if it is missing.

    Returns
    -------
    list[pathlib.Path]
        The files written. Without any reference there is no figure of errors, and without any
        answer at a finite threshold no figure at all.
    """
    rows = comparison_rows(frame)
    directory = checked_path("folder", folder)
    directory.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for name, (needed, draw) in FIGURES.items():
        if drawable(rows, needed):
            written += save(draw(frame), directory / name, FORMATS)
    return written
